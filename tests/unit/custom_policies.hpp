/// \file
/// A broad phase that enumerates, in a space: what it finds is what all pairs have.
#pragma once

#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/all_pairs.cuh>
#include <collide/broad/extend.hpp>
#include <collide/bvh.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/simulation.cuh>
#include <collide/spaces/upload.hpp>

#include "custom_broad_phase.hpp"

namespace tests {

/// Triangles and particles of a cube, with some of each that are not finite.
template <class S>
struct crowd {
  std::vector<S> triangles, centres, motions, radii;

  explicit crowd(std::size_t triangles_count, std::size_t spheres) {
    std::mt19937 engine(7);
    std::uniform_real_distribution<S> place(-1, 1), small(S(-0.2), S(0.2));
    for (std::size_t i = 0; i < triangles_count; ++i) {
      S const at[] = {place(engine), place(engine), place(engine)};
      for (int k = 0; k < 9; ++k) triangles.push_back(at[k % 3] + small(engine));
    }
    for (std::size_t i = 0; i < 3 * spheres; ++i) centres.push_back(place(engine));
    for (std::size_t i = 0; i < 3 * spheres; ++i) motions.push_back(2 * small(engine));
    for (std::size_t i = 0; i < spheres; ++i) radii.push_back(S(0.05) + small(engine) / 5);
    triangles[4] = std::numeric_limits<S>::quiet_NaN();
    centres[7] = std::numeric_limits<S>::infinity();
    radii[5] = S(3);  // touches everything: more candidates than a thread has room for
  }
};

/// Arrays of a space's own memory.
template <class Space, class S>
class array_in {
 public:
  array_in(Space const& space, std::vector<S> const& values) {
    space.copy_from_host(memory_.reserve(space.resource(), values.size()), values.data(), values.size());
  }
  S const* data() const { return memory_.data(); }

 private:
  collide::buffer<S> memory_;
};

template <class BroadPhase, class NarrowPhase, class S, class Space, class Spheres>
std::vector<collide::pair> pairs_of(Space const& space, collide::mesh_view<S> mesh, Spheres const& spheres) {
  collide::detector<BroadPhase, NarrowPhase, Space, S> detector(space);
  return detector.detect(mesh, spheres, collide::pairs(collide::order::canonical)).to_host();
}

template <class S, class Detector, class Space>
std::vector<S> positions_after_steps(Space const& space, collide::mesh_view<S> mesh, collide::sphere_view<S> spheres,
                                     S const* velocities) {
  collide::simulation<Detector, collide::gravity, collide::bounce> simulation(space);
  simulation.set_mesh(mesh);
  simulation.set(spheres, velocities);
  simulation.steps(5, S(0.2));
  return simulation.template to_host<collide::position>();
}

template <class Broad, class NarrowPhase, class S, class Space>
void check_custom_simulation(Space const& space, collide::mesh_view<S> mesh, collide::sphere_view<S> spheres,
                             S const* velocities) {
  using custom = collide::detector<Broad, NarrowPhase, Space, S>;
  using expected = collide::detector<collide::all_pairs, NarrowPhase, Space, S>;
  auto const a = positions_after_steps<S, custom>(space, mesh, spheres, velocities);
  auto const b = positions_after_steps<S, expected>(space, mesh, spheres, velocities);
  CHECK(a == b);
  CHECK(b != positions_after_steps<S, expected>(space, {}, spheres, velocities));  // some touch the mesh
}

/// `Broad` is a broad phase that is made of one that only enumerates.
template <class Broad, class S, class Space>
void check_custom_broad_phase(Space const& space) {
  crowd<S> made(300, 700);
  array_in<Space, S> const triangles(space, made.triangles), centres(space, made.centres), radii(space, made.radii),
      motions(space, made.motions);
  auto const mesh = collide::triangle_soup(triangles.data(), 300);
  auto const spheres = collide::spheres_xyz(centres.data(), 700, radii.data());
  auto const expected = pairs_of<collide::all_pairs, collide::karabassi<>, S>(space, mesh, spheres);
  CHECK(expected.size() > 400);
  CHECK((pairs_of<Broad, collide::karabassi<>, S>(space, mesh, spheres) == expected));

  auto const moving = collide::with_displacements(spheres, motions.data());
  auto const swept = pairs_of<collide::all_pairs, collide::karabassi_swept<>, S>(space, mesh, moving);
  CHECK(swept.size() > expected.size());
  CHECK((pairs_of<Broad, collide::karabassi_swept<>, S>(space, mesh, moving) == swept));

  std::vector<S> finite = made.centres;
  finite[7] = 0;
  array_in<Space, S> const starts(space, finite);
  auto const particles = collide::spheres_xyz(starts.data(), 700, S(0.03));
  check_custom_simulation<Broad, collide::karabassi<>, S>(space, mesh, particles, motions.data());
  check_custom_simulation<Broad, collide::karabassi_swept<>, S>(space, mesh, particles, motions.data());
}

}  // namespace tests
