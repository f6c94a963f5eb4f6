/// The ways that scripts/walk counts: of a centre in a query, of a particle in a step and of a mesh in `build`, through
/// the algorithms of a CUDA block on the host, and through the host's own. Compiled with -finstrument-functions: writes
/// the address of each function that runs between `begin` and `end` when it is called first.
///
///     walks WALK
#include <array>
#include <cstdio>
#include <cstring>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/host.hpp>
#include <collide/simulation.cuh>

#include "unit/execution/lockstep.hpp"

#define NOT_INSTRUMENTED __attribute__((no_instrument_function))

namespace {

constexpr std::size_t capacity = 1 << 14;
void const* seen[capacity];
std::size_t seen_count = 0;
bool is_recording = false;

}  // namespace

extern "C" {

NOT_INSTRUMENTED void __cyg_profile_func_enter(void* function, void*) {
  if (!is_recording || seen_count == capacity) return;
  for (std::size_t i = 0; i < seen_count; ++i) {
    if (seen[i] == function) return;
  }
  seen[seen_count++] = function;
}
NOT_INSTRUMENTED void __cyg_profile_func_exit(void*, void*) {}

}  // extern "C"

namespace {

template <class Space>
using detector_in = collide::detector<collide::bucket, collide::karabassi<>, Space>;
using blocks = tests::lockstep<32, false>;

constexpr float radius = 0.4f;

/// A floor of 2 x 16 x 16 triangles at z = 0.
std::vector<float> make_floor() {
  std::vector<float> corners;
  for (int i = 0; i < 16; ++i) {
    for (int j = 0; j < 16; ++j) {
      auto const x = static_cast<float>(i), y = static_cast<float>(j);
      corners.insert(corners.end(), {x, y, 0, x + 1, y, 0, x + 1, y + 1, 0, x, y, 0, x + 1, y + 1, 0, x, y + 1, 0});
    }
  }
  return corners;
}

/// Spheres of radius 0.4 above the floor, of which the first touches it.
std::vector<float> make_centres() {
  std::vector<float> centres;
  for (int i = 0; i < 300; ++i) {
    centres.insert(centres.end(),
                   {0.3f + static_cast<float>(i % 15), 0.2f + static_cast<float>(i / 20), i == 0 ? 0.25f : 5.0f});
  }
  return centres;
}

/// Layers of spheres that touch each other, and the floor.
std::vector<float> make_grains() {
  std::vector<float> centres;
  for (int i = 0; i < 128; ++i) {
    centres.insert(centres.end(),
                   {1.1f + 0.79f * static_cast<float>(i % 8), 1.2f + 0.79f * static_cast<float>(i / 8 % 8),
                    0.39f + 0.79f * static_cast<float>(i / 64)});
  }
  return centres;
}

/// Runs `f` and takes down its functions.
template <class F>
void record(F const& f) {
  is_recording = true;
  f();
  is_recording = false;
}

collide::mesh_view<float> floor_mesh() {
  static std::vector<float> const corners = make_floor();
  return collide::triangle_soup(corners.data(), corners.size() / 9);
}

/// Query number `number` after a build; without a radius unless it is `told`.
template <class Space>
void walk_centre(std::vector<float> const& centres, Space const& space, bool told, int number) {
  auto const spheres = collide::spheres_xyz(centres.data(), centres.size() / 3, radius);
  detector_in<Space> d(space);
  told ? d.build(floor_mesh(), radius) : d.build(floor_mesh());
  collide::pairs found;
  for (int i = 1; i < number; ++i) d.query(spheres, found);
  record([&] { d.query(spheres, found); });
  if (found.size() == 0) throw collide::error("nothing touches");
}

/// The step after `steps` of them; with `set_mesh` and `set` if there are none.
template <class Scene>
void walk_particle(Scene&& scene, std::vector<float> const& centres, float dt, int steps) {
  auto const spheres = collide::spheres_xyz(centres.data(), centres.size() / 3, radius);
  auto const mesh = floor_mesh();
  auto const begin = [&] {
    scene.set_mesh(mesh);
    scene.set(spheres);
  };
  if (steps > 0) begin();
  for (int i = 0; i < steps; ++i) scene.step(dt);
  record([&] {
    if (steps == 0) begin();
    scene.step(dt);
  });
}

auto falling() {
  using scene = collide::simulation<detector_in<blocks>, collide::gravity, collide::bounce>;
  return scene(blocks(), collide::gravity{0, 0, -9.81}, collide::bounce{0.5});
}

auto granular() {
  using law = collide::granular_contact<collide::hertz, collide::mindlin>;
  using scene = collide::simulation<detector_in<collide::host>, collide::gravity, law, collide::velocity_verlet>;
  law const contacts{collide::one_material({1e7, 0.2, 2500}, {0.5, 0.5, 0.1, 0})};
  return scene(collide::host(1), collide::gravity{0, 0, -9.81}, contacts, collide::velocity_verlet{});
}

/// `build`, and what the first query after it makes of the mesh.
void walk_mesh() {
  auto const mesh = floor_mesh();
  std::vector<float> const centres = make_centres();
  blocks there;
  collide::bucket const options;
  collide::bucket::index<float> index;
  record([&] {
    index.build(there, options, mesh);
    index.prepare(there, options, collide::spheres_xyz(centres.data(), centres.size() / 3, radius));
  });
}

struct walk {
  char const* name;
  void (*run)();
};
walk const walks[] = {
    {"centre", [] { walk_centre(make_centres(), blocks(), true, 2); }},
    {"particle", [] { walk_particle(falling(), make_centres(), 1e-3f, 1); }},
    {"mesh", walk_mesh},
    {"host-centre-first", [] { walk_centre(make_centres(), collide::host(1), false, 1); }},
    {"host-centre-second", [] { walk_centre(make_centres(), collide::host(1), false, 2); }},
    {"host-tangent",
     [] {
       walk_centre({3.3f, 2.2f, radius}, collide::host(1), true, 1);
     }},
    {"host-grain", [] { walk_particle(granular(), make_grains(), 1e-5f, 1); }},
    {"host-set-mesh", [] { walk_particle(granular(), make_grains(), 1e-5f, 0); }},
};

}  // namespace

int main(int argc, char** argv) {
  for (walk const& one : walks) {
    if (argc == 2 && std::strcmp(argv[1], one.name) == 0) {
      one.run();
      for (std::size_t i = 0; i < seen_count; ++i) std::printf("%p\n", seen[i]);
      return 0;
    }
  }
  return 2;
}
