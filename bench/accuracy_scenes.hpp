/// \file
/// The scenes on which the price of accuracy is measured, and the tests of a narrow phase that they give rise to.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include <collide/bucket.cuh>
#include <collide/narrow/detail/intersects.hpp>

#include "io/scenes.hpp"
#include "scene.hpp"

namespace bench {

using vec = collide::vec3<double>;

inline io::scene study(std::size_t spheres, std::uint64_t seed) {
  return io::study_scene(spheres, io::study_triangles, seed);
}

/// The study's scene, far from the origin.
inline io::scene far_away(std::size_t spheres, std::uint64_t seed) {
  io::scene s = study(spheres, seed);
  io::shift(s, {1e5, 1e5, 1e5});
  return s;
}

/// The study's spheres among as many needles and caps, 30 long and 1e2 to 1e6 times thinner, every way round. Rounding
/// to float makes segments of some.
inline io::scene thin(std::size_t spheres, std::uint64_t seed) {
  constexpr double length = 30;
  io::scene s;
  s.radius = 3;
  io::random_numbers random(1), of_spheres(seed);
  auto const vector = [&](double half) {
    io::point const p = random.in_cube(half);
    return vec(p[0], p[1], p[2]);
  };
  for (std::size_t i = 0; i < io::study_triangles; ++i) {
    vec const middle = vector(io::study_cube), half = vector(1).normalized() * length / 2;
    vec const aside = half.cross(vector(1)).normalized() * length * std::pow(10, random.between(-6, -2));
    vec const a = middle - half, b = middle + half;
    vec const c = aside + (i % 2 == 0 ? b : vec(middle + random.between(-0.8, 0.8) * half));
    io::add_triangle(s, {a.x(), a.y(), a.z()}, {b.x(), b.y(), b.z()}, {c.x(), c.y(), c.z()});
  }
  io::add_spheres(s, spheres, of_spheres, io::study_cube);
  return s;
}

/// Spheres on slivers of 1:2,000 and more.
inline io::scene long_slivers(std::size_t spheres, std::uint64_t seed) {
  return io::long_slivers_scene(spheres, io::study_triangles, seed);
}

/// A radius of type float that is within 2 ulp of a distance, at random below it or not.
inline float radius_near(double distance, io::random_numbers& random) {
  auto r = static_cast<float>(distance);
  if (static_cast<double>(r) > distance) r = std::nextafter(r, 0.0f);
  double const way = random.unit();
  if (way < 0.25) return std::nextafter(r, 0.0f);
  for (int steps = static_cast<int>(4 * way) - 1; steps > 0; --steps) r = std::nextafter(r, 10.0f);
  return r;
}

/// The study's scene, where every other sphere is within 2 ulp (of float) of touching a face, an edge or a corner.
inline io::scene contact(std::size_t spheres, std::uint64_t seed) {
  io::scene s = study(spheres, seed);
  for (auto* const numbers : {&s.vertices, &s.centres}) {
    for (double& x : *numbers) x = static_cast<float>(x);
  }
  auto const mesh =
      collide::indexed_mesh(s.vertices.data(), s.vertices.size() / 3, s.corners.data(), s.triangle_count());
  std::vector<vec> normals(mesh.vertices().size(), vec(0, 0, 0));
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    auto const [a, b, c] = mesh[t];
    for (std::size_t k = 0; k < 3; ++k) normals[s.corners[3 * t + k]] += (b - a).cross(c - a);
  }

  // From a random point of the mesh along its normal: the mean of those of the corners.
  io::random_numbers random(seed + 1);
  for (std::size_t i = 0; i < spheres; i += 2) {
    auto const t = static_cast<std::size_t>(random.between(0, static_cast<double>(mesh.size())));
    std::size_t const corners = 1 + i / 2 % 3, first = static_cast<std::size_t>(random.between(0, 3));
    vec point(0, 0, 0), normal(0, 0, 0);
    double sum = 0;
    for (std::size_t k = 0; k < corners; ++k) {
      std::uint32_t const v = s.corners[3 * t + (first + k) % 3];
      double const weight = random.between(0.1, 1);
      point += weight * mesh.vertices()[v];
      normal += weight * normals[v].normalized();
      sum += weight;
    }
    vec const centre = point / sum + normal.normalized() * (random.unit() < 0.5 ? -s.radius : s.radius);
    for (std::size_t k = 0; k < 3; ++k) s.centres[3 * i + k] = static_cast<float>(centre[static_cast<int>(k)]);
  }

  // What is nearest to them may be another triangle.
  collide::detector<collide::bucket, collide::karabassi<collide::double_precision>, collide::host, double> detector;
  auto const nearest =
      detector.detect(mesh, collide::spheres_xyz(s.centres.data(), spheres, 1.1 * s.radius), collide::closest<double>())
          .to_host();
  s.radii.assign(spheres, s.radius);
  for (std::size_t i = 0; i < spheres; i += 2) s.radii[i] = radius_near(nearest[i].distance, random);
  return s;
}

/// The study's scene in floats, with centres on faces, edges and corners, as far as floats are.
inline io::scene on_surface(std::size_t spheres, std::uint64_t seed) {
  io::scene s = study(spheres, seed);
  for (double& x : s.vertices) x = static_cast<float>(x);
  auto const mesh =
      collide::indexed_mesh(s.vertices.data(), s.vertices.size() / 3, s.corners.data(), s.triangle_count());
  io::random_numbers random(seed + 1);
  for (std::size_t i = 0; i < spheres; ++i) {
    auto const [a, b, c] = mesh[static_cast<std::size_t>(random.between(0, static_cast<double>(mesh.size())))];
    double const u = random.between(0.1, 1), v = i % 3 > 0 ? random.between(0.1, 1) : 0,
                 w = i % 3 > 1 ? random.between(0.1, 1) : 0;
    vec const p = (u * a + v * b + w * c) / (u + v + w);
    for (std::size_t k = 0; k < 3; ++k) s.centres[3 * i + k] = static_cast<float>(p[static_cast<int>(k)]);
  }
  return s;
}

/// A scene by its name, and how many spheres it is to have.
struct scene_kind {
  char const* name;
  std::size_t spheres;
  io::scene (*make)(std::size_t spheres, std::uint64_t seed);
};

/// A narrow phase that takes every candidate for a hit.
struct every_candidate {
  template <class S>
  static bool intersects(collide::triangle<S> const&, collide::sphere<S> const&) {
    return true;
  }
};

/// The questions to the narrow phase: the candidates that `bucket` finds in a scene, and the truth about each.
template <class S>
struct test_list {
  std::vector<S> centres, radii;  ///< of the spheres that have candidates
  std::vector<collide::pair> tests;
  std::vector<collide::detail::decision> truth;

  /// From the scene with as many sets of spheres as it takes for two tests per sphere.
  explicit test_list(scene_kind const& kind) {
    collide::detector<collide::bucket, every_candidate, collide::host, S> detector;
    for (std::uint64_t seed = 0; tests.size() < 2 * kind.spheres; ++seed) {
      scene<S> const s(kind.make(kind.spheres, seed));
      auto const balls = s.spheres();
      collide::id last = collide::no_id;
      for (auto const [number, triangle] :
           detector.detect(s.mesh(), balls, collide::pairs(collide::order::canonical)).to_host()) {
        auto const ball = balls[number];
        if (number != last) {
          centres.insert(centres.end(), ball.centre.begin(), ball.centre.end());
          radii.push_back(ball.radius);
          last = number;
        }
        tests.push_back({static_cast<collide::id>(radii.size() - 1), triangle});
        truth.push_back(collide::detail::intersects_exact(s.mesh()[triangle], ball));
      }
    }
  }

  collide::sphere_view<S> spheres() const { return collide::spheres_xyz(centres.data(), radii.size(), radii.data()); }
};

}  // namespace bench
