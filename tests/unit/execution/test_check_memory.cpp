/// Arrays in memory that a space cannot read are refused.
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <collide/core/points.hpp>
#include <collide/spaces/detail/check_memory.hpp>

namespace {

/// Reads everything but one address.
struct picky {
  static constexpr bool host_accessible = true;
  static constexpr char const* name() { return "picky"; }
  static inline void const* unreadable = nullptr;
  static bool reads(void const* p) { return p != unreadable; }
};

/// The error of a view where that array cannot be read; empty if there is none.
template <class View>
std::string refusal(View const& view, void const* unreadable) {
  picky::unreadable = unreadable;
  try {
    collide::detail::check_memory<picky>(view, "the view is", "move it");
  } catch (collide::error const& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("check memory: every array of a mesh and of spheres is looked at") {
  std::vector<float> const vertices(9), x(2), y(2), z(2), radii(2);
  std::vector<unsigned> const indices{0, 1, 2};
  std::string const sentence = "collide: the view is in device memory, which the space `picky` cannot read: move it";

  auto const mesh = collide::indexed_mesh(vertices.data(), 3, indices.data(), 1);
  CHECK(refusal(mesh, nullptr) == "");
  CHECK(refusal(mesh, vertices.data()) == sentence);
  CHECK(refusal(mesh, indices.data()) == sentence);
  CHECK(refusal(collide::triangle_soup(vertices.data(), 1), vertices.data()) == sentence);

  auto const spheres = collide::spheres_at(collide::points(x.data(), y.data(), z.data(), 2), radii.data());
  CHECK(refusal(spheres, nullptr) == "");
  for (auto const* array : {&x, &y, &z, &radii}) CHECK(refusal(spheres, array->data()) == sentence);
}

TEST_CASE("check memory: what is empty may point anywhere") {
  float const nothing[3] = {};
  CHECK(refusal(collide::triangle_soup(nothing, 0), nothing) == "");
  CHECK(refusal(collide::spheres_xyz(nothing, 0, 1.f), nothing) == "");
}
