/// The ways that scripts/walk counts, through the algorithms of a CUDA block on the host: a centre in a query, a
/// particle in a step, a mesh in `build`. Compiled with -finstrument-functions: writes the address of each function
/// that runs between `begin` and `end` when it is called first.
///
///     walks centre|particle|mesh
#include <array>
#include <cstdio>
#include <cstring>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/simulation.cuh>

#include "unit/execution/lockstep.hpp"

#define NOT_INSTRUMENTED __attribute__((no_instrument_function))

namespace {

constexpr std::size_t room = 1 << 14;
void const* seen[room];
std::size_t seen_count = 0;
bool is_recording = false;

}  // namespace

extern "C" {

NOT_INSTRUMENTED void __cyg_profile_func_enter(void* function, void*) {
  if (!is_recording || seen_count == room) return;
  for (std::size_t i = 0; i < seen_count; ++i) {
    if (seen[i] == function) return;
  }
  seen[seen_count++] = function;
}
NOT_INSTRUMENTED void __cyg_profile_func_exit(void*, void*) {}

}  // extern "C"

namespace {

using space = tests::lockstep<32, false>;
using detector = collide::detector<collide::bucket, collide::karabassi<>, space>;

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

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::vector<float> const floor = make_floor(), centres = make_centres();
  auto const mesh = collide::triangle_soup(floor.data(), floor.size() / 9);
  constexpr float radius = 0.4f;
  auto const spheres = collide::spheres_xyz(centres.data(), centres.size() / 3, radius);
  if (std::strcmp(argv[1], "centre") == 0) {
    detector d;
    d.build(mesh, radius);
    collide::pairs found;
    d.query(spheres, found);
    is_recording = true;
    d.query(spheres, found);
    is_recording = false;
    if (found.size() == 0) return 1;
  } else if (std::strcmp(argv[1], "particle") == 0) {
    collide::simulation<detector, collide::gravity, collide::bounce> scene(space(), collide::gravity{0, 0, -9.81},
                                                                           collide::bounce{0.5});
    scene.set_mesh(mesh);
    scene.set(spheres);
    scene.step(1e-3f);
    is_recording = true;
    scene.step(1e-3f);
    is_recording = false;
  } else if (std::strcmp(argv[1], "mesh") == 0) {
    space there;  // the first query after a build makes what it needs of the mesh
    collide::bucket const options;
    collide::bucket::index<float> index;
    is_recording = true;
    index.build(there, options, mesh);
    index.prepare(there, options, spheres);
    is_recording = false;
  } else {
    return 2;
  }
  for (std::size_t i = 0; i < seen_count; ++i) std::printf("%p\n", seen[i]);
  return 0;
}
