/// Which broad phase `automatic` takes, and that the pairs are those of both.
#pragma once

#include <vector>

#include <doctest/doctest.h>

#include <collide/automatic.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/simulation.cuh>
#include <collide/sinks/pairs.hpp>
#include <collide/spaces/upload.hpp>

#include "io/scenes.hpp"

namespace tests {

/// Meshes from a tetrahedron's size to what no one would test pair by pair, with few spheres and with many.
template <class Space>
void check_automatic(Space space) {
  bool seen[2] = {};  // without and with a grid
  for (std::size_t const triangles : {8u, 600u, 20000u}) {
    for (std::size_t const spheres : {3u, 500u, 60000u}) {
      CAPTURE(triangles);
      CAPTURE(spheres);
      io::scene const s = io::study_scene(spheres, triangles);
      std::vector<float> const vertices(s.vertices.begin(), s.vertices.end()),
          centres(s.centres.begin(), s.centres.end());
      auto const mesh = collide::upload(
          space, collide::indexed_mesh(vertices.data(), vertices.size() / 3, s.corners.data(), s.triangle_count()));
      auto const balls = collide::upload(space, collide::spheres_xyz(centres.data(), spheres, 12));
      auto const found = [&](auto& detector) {
        collide::pairs pairs(collide::order::canonical);
        return detector.query(balls.view(), pairs).to_host();
      };
      collide::detector<collide::all_pairs, collide::karabassi<>, Space> plain(space);
      plain.build(mesh.view());
      auto const expected = found(plain);
      collide::detector<collide::automatic, collide::karabassi<>, Space> chooses(space);
      chooses.build(mesh.view());
      CHECK(chooses.cell_width() == 0);  // nothing is made that nobody asked for
      CHECK(found(chooses) == expected);
      seen[chooses.cell_width() > 0] = true;
      if (triangles == 20000 && spheres == 60000) CHECK(chooses.cell_width() > 0);
      if (triangles == 8 && spheres == 3) CHECK(chooses.cell_width() == 0);
      CHECK(found(chooses) == expected);  // again, by whichever way
      chooses.build(mesh.view());
      CHECK(chooses.cell_width() == 0);
      chooses.build(mesh.view(), 12);  // the next mesh, with a radius: there is a grid for the first query
      CHECK(found(chooses) == expected);
      CHECK(chooses.cell_width() > 0);
    }
  }
  CHECK(seen[0]);
  CHECK(seen[1]);
}

/// Many small queries make a grid in the end.
template <class Space>
void check_many_queries(Space space) {
  io::scene const s = io::study_scene(10, 2000);
  std::vector<float> const vertices(s.vertices.begin(), s.vertices.end()), centres(s.centres.begin(), s.centres.end());
  auto const mesh = collide::upload(
      space, collide::indexed_mesh(vertices.data(), vertices.size() / 3, s.corners.data(), s.triangle_count()));
  auto const balls = collide::upload(space, collide::spheres_xyz(centres.data(), 10, 12));
  collide::detector<collide::automatic, collide::karabassi<>, Space> detector(space);
  detector.build(mesh.view());
  collide::pairs pairs;
  int queries = 0;
  for (; queries < 100000 && detector.cell_width() == 0; ++queries) detector.query(balls.view(), pairs);
  CHECK(queries > 1);
  CHECK(queries < 1000);
}

/// With spheres that move, too.
template <class Space>
void check_automatic_swept(Space space) {
  io::scene const s = io::study_scene(20000, 2000);
  std::vector<float> const vertices(s.vertices.begin(), s.vertices.end()), centres(s.centres.begin(), s.centres.end());
  std::vector<float> const moves(centres.size(), 5.0f);
  auto const mesh = collide::indexed_mesh(vertices.data(), vertices.size() / 3, s.corners.data(), s.triangle_count());
  auto const balls = collide::with_displacements(collide::spheres_xyz(centres.data(), 20000, 12), moves.data());
  auto const found = [&](auto broad) {
    collide::detector<decltype(broad), collide::karabassi_swept<>, Space> detector(space);
    collide::pairs pairs(collide::order::canonical);
    return detector.detect(mesh, balls, pairs).to_host();
  };
  auto const expected = found(collide::all_pairs());
  CHECK(expected.size() > 0);
  CHECK(found(collide::automatic()) == expected);
}

/// The scenes that libraries are compared on, small: each has the same pairs by whichever way.
template <class Space>
void check_automatic_scenes(Space space) {
  auto const check = [&](io::scene_kind const& kind) {
    CAPTURE(kind.name);
    io::scene const s = kind.make(600, 900, 1);
    std::vector<float> const vertices(s.vertices.begin(), s.vertices.end()),
        centres(s.centres.begin(), s.centres.end()), radii(s.radii.begin(), s.radii.end());
    auto const mesh = collide::upload(
        space, collide::indexed_mesh(vertices.data(), vertices.size() / 3, s.corners.data(), s.triangle_count()));
    auto const balls =
        collide::upload(space, radii.empty() ? collide::spheres_xyz(centres.data(), 600, static_cast<float>(s.radius))
                                             : collide::spheres_xyz(centres.data(), 600, radii.data()));
    auto const found = [&](auto broad) {
      collide::detector<decltype(broad), collide::karabassi<>, Space> detector(space);
      collide::pairs pairs(collide::order::canonical);
      return detector.detect(mesh.view(), balls.view(), pairs).to_host();
    };
    auto const pairs = found(collide::automatic());
    CHECK(pairs == found(collide::bucket()));
    CHECK(pairs == found(collide::bvh()));
  };
  for (auto const& kind : io::measured_scenes) check(kind);
  for (auto const& kind : io::needle_scenes) check(kind);
}

/// A simulation among bars has the bits of one with `bucket`, whichever way it goes.
template <class NarrowPhase, class Space>
void check_automatic_steps(Space space) {
  for (auto const layout : {io::bars_in::tube, io::bars_in::cage}) {
    io::scene const s = io::bars_scene(layout, 300, 0.2, 2000, 3000, 0);
    std::vector<float> const vertices(s.vertices.begin(), s.vertices.end()),
        centres(s.centres.begin(), s.centres.end()), velocities(centres.rbegin(), centres.rend());
    auto const mesh = collide::upload(
        space, collide::indexed_mesh(vertices.data(), vertices.size() / 3, s.corners.data(), s.triangle_count()));
    auto const balls = collide::upload(space, collide::spheres_xyz(centres.data(), 2000, static_cast<float>(s.radius)));
    collide::buffer<float> moving;
    space.copy_from_host(moving.reserve(space.resource(), velocities.size()), velocities.data(), velocities.size());
    auto const run = [&](auto broad) {
      collide::simulation<collide::detector<decltype(broad), NarrowPhase, Space>, collide::bounce> simulation(space);
      simulation.set_mesh(mesh.view());
      simulation.set(balls.view(), moving.data());
      simulation.steps(20, 1e-3f);
      return std::make_pair(simulation.template to_host<collide::position>(),
                            simulation.template to_host<collide::velocity>());
    };
    auto const of_grid = run(collide::bucket());
    CHECK((of_grid.second != velocities));  // some have bounced
    CHECK((run(collide::automatic()) == of_grid));
  }
}

}  // namespace tests
