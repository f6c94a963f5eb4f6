/// \file
/// Tutorial 5: spheres that move many radii in a step, and a mesh that moves, without tunnelling.

#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/simulation.cuh>
#include <collide/sinks/earliest.hpp>

namespace {

/// A plate of 2 m x 2 m in the plane z = 0.
float const vertices[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
unsigned const triangles[] = {0, 1, 2, 0, 2, 3};
auto const plate = collide::indexed_mesh(vertices, 4, triangles, 2);

constexpr float radius = 0.01f;
constexpr std::size_t count = 1000;

/// Spheres above the plate, each at a height of its own.
std::vector<float> above_the_plate() {
  std::vector<float> centres;
  for (std::size_t i = 0; i < count; ++i)
    centres.insert(centres.end(),
                   {0.0018f * static_cast<float>(i) - 0.9f, 0.1f, 0.5005f + 0.001f * static_cast<float>(i)});
  return centres;
}

/// How many of the spheres hit the plate while it moves by `plate_moves` and each sphere by `sphere_moves`, along z.
std::size_t hits(std::vector<float> const& centres, float sphere_moves, float plate_moves) {
  // relative to the plate, which then rests
  std::vector<float> displacements(centres.size());
  for (std::size_t i = 0; i < count; ++i) displacements[3 * i + 2] = sphere_moves - plate_moves;

  collide::detector<collide::bucket, collide::karabassi_swept<>> detector;
  detector.build(plate, radius);
  auto const moving =
      collide::with_displacements(collide::spheres_xyz(centres.data(), count, radius), displacements.data());
  std::size_t n = 0;
  for (auto const& first : detector.query(moving, collide::earliest<float>()).to_host())
    n += first.triangle != collide::no_id;
  return n;
}

/// How many are still above the plate after a flight of 3 m at 100 m/s, in steps of 1 ms: of ten radii.
template <class NarrowPhase>
std::size_t above_after_flight(std::vector<float> const& centres) {
  std::vector<float> velocities(centres.size());
  for (std::size_t i = 0; i < count; ++i) velocities[3 * i + 2] = -100;
  collide::simulation<collide::detector<collide::bucket, NarrowPhase>, collide::bounce> simulation(collide::host(1),
                                                                                                   collide::bounce{1});
  simulation.set_mesh(plate);
  simulation.set(collide::spheres_xyz(centres.data(), count, radius), velocities.data());
  simulation.steps(30, 1e-3f);
  auto const x = simulation.template to_host<collide::position>();
  std::size_t n = 0;
  for (std::size_t i = 0; i < count; ++i) n += x[3 * i + 2] > 0;
  return n;
}

}  // namespace

int main() {
  std::vector<float> const centres = above_the_plate();
  std::printf("%zu of %zu hit a plate that rests\n", hits(centres, -1, 0), count);
  std::printf("%zu of %zu hit a plate that rises to meet them\n", hits(centres, -1, 0.25f), count);
  std::printf("discrete: %zu of %zu bounce off\n", above_after_flight<collide::karabassi<>>(centres), count);
  std::printf("swept: %zu of %zu bounce off\n", above_after_flight<collide::karabassi_swept<>>(centres), count);
}
