/// The detectors of collide::compiled, against the narrow phase alone. Prints what is wrong, if anything.
#include <cstdio>
#include <vector>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/karabassi_swept.hpp>

namespace {

/// A strip of triangles, and spheres at all heights above it; those that move sink by one.
template <class S>
struct scene {
  std::vector<S> corners, centres, displacements;

  scene() {
    for (int i = 0; i < 50; ++i) {
      auto const x = static_cast<S>(i);
      corners.insert(corners.end(), {x, 0, 0, x + 1, 0, 0, x, 1, 0});
    }
    for (int i = 0; i < 500; ++i) {
      centres.insert(centres.end(), {static_cast<S>(i) / 10, S(0.25), static_cast<S>(i % 40) / 16});
      displacements.insert(displacements.end(), {0, 0, -1});
    }
  }
  collide::mesh_view<S> mesh() const { return collide::triangle_soup(corners.data(), corners.size() / 9); }
  template <class Precision>
  collide::sphere_view<S> spheres(collide::karabassi<Precision> const&) const {
    return collide::spheres_xyz(centres.data(), centres.size() / 3, S(0.5));
  }
  collide::moving_sphere_view<S> spheres(collide::karabassi_swept<> const&) const {
    return collide::with_displacements(spheres(collide::karabassi<>()), displacements.data());
  }
};

template <class Broad, class Narrow, class S>
bool right() {
  scene<S> const made;
  auto const mesh = made.mesh();
  auto const spheres = made.spheres(Narrow());
  std::vector<collide::pair> expected;
  std::vector<std::uint8_t> flags(spheres.size());
  for (collide::id s = 0; s < spheres.size(); ++s) {
    for (collide::id t = 0; t < mesh.size(); ++t) {
      if (!Narrow::intersects(mesh[t], spheres[s])) continue;
      expected.push_back({s, t});
      flags[s] = 1;
    }
  }
  collide::detector<Broad, Narrow, collide::host, S> detector;
  detector.build(mesh, S(0.5));
  return !expected.empty() && expected.size() < spheres.size() * 4 &&
         detector.query(spheres, collide::pairs(collide::order::canonical)).to_host() == expected &&
         detector.query(spheres, collide::count()).total() == expected.size() &&
         detector.query(spheres, collide::any_hit()).to_host() == flags;
}

template <class Broad, class... Narrow>
bool right(char const* name) {
  bool const all = ((right<Broad, Narrow, float>() && right<Broad, Narrow, double>()) && ...);
  if (!all) std::printf("%s: wrong\n", name);
  return all;
}

template <class Broad>
bool all_right(char const* name) {
  using namespace collide;
  return right<Broad, karabassi<exact>, karabassi<single_precision>, karabassi<double_precision>, karabassi_swept<>>(
      name);
}

}  // namespace

int main() {
  bool const grid = all_right<collide::bucket>("bucket"), brute_force = all_right<collide::all_pairs>("all_pairs");
  return grid && brute_force ? 0 : 1;
}
