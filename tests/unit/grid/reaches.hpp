/// Spheres of many radii, which change from query to query: the grids follow, and the pairs are those of all pairs.
#pragma once

#include <cmath>
#include <cstddef>
#include <random>
#include <type_traits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/karabassi_swept.hpp>
#include <collide/sinks/pairs.hpp>
#include <collide/spaces/upload.hpp>

#include "random_triangles.hpp"

namespace tests {

/// Small triangles, and spheres of four times the radii in which the smallest is 1 / `ratio` of the largest; three in
/// four are of the smallest. So the second of several grids serves few spheres, and costs more than it saves.
struct many_radii {
  std::vector<float> corners, centres, displacements;
  std::vector<std::vector<float>> radii;

  many_radii(std::size_t triangles, std::size_t spheres, float ratio)
      : corners(random_triangles<float>(triangles, {5, 5, 5}, [](std::size_t, auto const&) { return 0.5; })) {
    std::mt19937 engine(5);
    std::uniform_real_distribution<float> place(-5, 5), share(0, 1);
    for (std::size_t i = 0; i < 3 * spheres; ++i) {
      centres.push_back(place(engine));
      displacements.push_back(share(engine));
    }
    for (float const largest : {1.f, 8.f, 0.01f, 1.01f}) {
      auto& to = radii.emplace_back();
      for (std::size_t i = 0; i < spheres; ++i)
        to.push_back(largest * std::pow(ratio, i % 4 == 0 ? -share(engine) : -1.f));
    }
  }

  collide::mesh_view<float> mesh() const { return collide::triangle_soup(corners.data(), corners.size() / 9); }
  collide::sphere_view<float> spheres(std::size_t i) const {
    return collide::spheres_xyz(centres.data(), radii[i].size(), radii[i].data());
  }
};

/// Calls f(spheres of radii `i`) for spheres at rest, or for those that move by `moves`.
template <class NarrowPhase, class F>
auto with_spheres(collide::sphere_view<float> const& spheres, float const* moves, F const& f) {
  if constexpr (std::is_same<NarrowPhase, collide::karabassi<>>::value) return f(spheres);
  if constexpr (!std::is_same<NarrowPhase, collide::karabassi<>>::value) {
    return f(collide::with_displacements(spheres, moves));
  }
}

/// One detector after the other finds the pairs of spheres whose radii grow and shrink, without and with a radius that
/// `build` is given, which is too small for some.
template <class NarrowPhase, class Space>
void check_changing_radii(Space space, many_radii const& scene) {
  auto const mesh = collide::upload(space, scene.mesh());
  collide::buffer<float> moves;
  space.copy_from_host(moves.reserve(space.resource(), scene.displacements.size()), scene.displacements.data(),
                       scene.displacements.size());
  auto const found = [](auto& detector, auto const& spheres) {
    collide::pairs pairs(collide::order::canonical);
    return detector.query(spheres, pairs).to_host();
  };
  collide::detector<collide::all_pairs, NarrowPhase> plain;
  plain.build(scene.mesh());
  std::vector<std::vector<collide::pair>> expected;
  for (std::size_t i = 0; i < scene.radii.size(); ++i) {
    expected.push_back(with_spheres<NarrowPhase>(scene.spheres(i), scene.displacements.data(),
                                                 [&](auto const& spheres) { return found(plain, spheres); }));
    CHECK((expected.back().size() > 10 || i == 2));
  }
  for (float const given : {-1.f, 1.f}) {
    collide::detector<collide::bucket, NarrowPhase, Space> detector(space);
    given < 0 ? detector.build(mesh.view()) : detector.build(mesh.view(), given);
    for (std::size_t const i : {0u, 1u, 0u, 0u, 2u, 3u, 2u, 1u}) {
      CAPTURE(given);
      CAPTURE(i);
      auto const there = collide::upload(space, scene.spheres(i));
      CHECK((with_spheres<NarrowPhase>(there.view(), moves.data(),
                                       [&](auto const& spheres) { return found(detector, spheres); }) == expected[i]));
    }
  }
}

template <class Space>
void check_changing_radii(Space space) {
  for (many_radii const& scene : {many_radii(200, 8000, 1000), many_radii(200, 1500, 2), many_radii(1000, 500, 1000)}) {
    check_changing_radii<collide::karabassi<>>(space, scene);
    check_changing_radii<collide::karabassi_swept<>>(space, scene);
  }
}

}  // namespace tests
