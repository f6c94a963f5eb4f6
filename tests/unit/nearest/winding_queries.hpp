/// \file
/// Winding numbers in a space; instantiated by test_winding_number.cpp and test_winding_number_cuda.cpp.
#pragma once

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/all_pairs.cuh>
#include <collide/bvh.cuh>
#include <collide/sinks/winding_number.hpp>
#include <collide/spaces/upload.hpp>

#include "nearest/point_cases.hpp"

namespace tests {

template <class BroadPhase = collide::all_pairs, class S, class Space = collide::host>
std::vector<collide::winding<S>> winding_of(std::vector<collide::triangle<S>> const& mesh,
                                            std::vector<collide::vec3<S>> const& points, double beta = 3,
                                            Space const& space = Space()) {
  std::vector<S> corners, coordinates;
  for (auto const& t : mesh) {
    collide::vec3<S> const all[] = {t.a, t.b, t.c};  // nvcc 13.0 takes a list in braces for another
    for (auto const& v : all) corners.insert(corners.end(), {v.x(), v.y(), v.z()});
  }
  for (auto const& p : points) coordinates.insert(coordinates.end(), {p.x(), p.y(), p.z()});
  auto const there = collide::upload(space, collide::triangle_soup(corners.data(), mesh.size()));
  auto const at = collide::upload(space, collide::spheres_xyz(coordinates.data(), points.size(), S(0)));
  collide::detector<BroadPhase, collide::karabassi<>, Space, S> detector(space);
  detector.build(there.view());
  return detector.query(at.view().centres(), collide::winding_number<S>(beta)).to_host();
}

/// A mesh, and points on, near and far from it.
template <class S>
struct winding_scene {
  std::vector<collide::triangle<S>> mesh;
  std::vector<collide::vec3<S>> points;

  void add_points(dice& roll, oracle::point const& middle, double size, int n) {
    for (int i = 0; i < n; ++i) {
      double const far = size * std::pow(10, roll.uniform(0, 4));
      for (double const away : {size, far}) {
        auto const p = roll.in_cube(away);
        points.push_back(from_oracle<S>({middle.x + p.x, middle.y + p.y, middle.z + p.z}));
      }
      points.push_back(point_at_surface(mesh, roll, i % 3));
      points.push_back(mesh[std::size_t(roll.integer(0, int(mesh.size()) - 1))].b);
    }
    points.push_back({std::numeric_limits<S>::max(), 0, 0});
    points.push_back({std::numeric_limits<S>::quiet_NaN(), 0, 0});
    points.push_back({0, -std::numeric_limits<S>::infinity(), 0});
  }
};

/// A ball; one with holes; and a soup of triangles of all sizes and shapes: degenerate ones, needles, duplicates, and
/// some that are not finite. At the origin and far from it, and so small and so large that products leave the range.
template <class S>
std::vector<winding_scene<S>> winding_scenes(int n) {
  std::vector<winding_scene<S>> all;
  dice roll(3);
  for (double const offset : {0.0, 1e5}) {
    winding_scene<S> ball;
    ball.mesh = triangles_of(icosphere<S>(3, 1, {offset, offset, offset}));
    auto holed = ball;
    ball.add_points(roll, {offset, offset, offset}, 1.5, n);
    all.push_back(ball);
    for (std::size_t i = 0; i < holed.mesh.size(); ++i) {
      if (i % 7 < 3) holed.mesh.erase(holed.mesh.begin() + std::ptrdiff_t(i));
    }
    holed.add_points(roll, {offset, offset, offset}, 1.5, n);
    all.push_back(holed);
  }
  double const coarse = 3000 * double(std::numeric_limits<S>::epsilon());  // corners are rounded much
  winding_scene<S> rounded;
  rounded.mesh = triangles_of(icosphere<S>(3, coarse, {1, 0.75, 0}));
  rounded.add_points(roll, {1, 0.75, 0}, coarse, n);
  all.push_back(rounded);
  for (double const scale :
       {1.0, std::sqrt(double(std::numeric_limits<S>::min())), double(std::numeric_limits<S>::max()) / 16}) {
    winding_scene<S> soup;
    for (int i = 0; i < 600; ++i) {
      double const size = scale * std::pow(10, roll.uniform(-6, 0));
      auto const at = roll.in_cube(scale);
      auto corner = [&] {
        auto const p = roll.in_cube(size);
        return from_oracle<S>({at.x + p.x, at.y + p.y, at.z + p.z});
      };
      collide::triangle<S> t{corner(), corner(), corner()};
      if (i % 10 == 0) t.c = t.b;
      if (i % 25 == 0) t.b = t.a;
      if (i % 10 == 1) t.c = (t.a + t.b) * S(0.5);
      if (i % 50 == 2) t.a[i % 3] = std::numeric_limits<S>::infinity();
      if (i % 50 == 3) t.c[i % 3] = std::numeric_limits<S>::quiet_NaN();
      soup.mesh.push_back(t);
      if (i % 20 == 4) soup.mesh.push_back(t);
    }
    soup.add_points(roll, {0, 0, 0}, scale / 2, n);
    all.push_back(soup);
  }
  return all;
}

/// Within its error of the sum over all triangles; and the bits of the host.
template <class S, class Space>
void check_windings(Space const& space, int n) {
  int number = 0;
  for (auto const& scene : winding_scenes<S>(n)) {
    CAPTURE(number++);
    auto const direct = winding_of(scene.mesh, scene.points);
    std::vector<collide::winding<S>> last;
    for (double const beta : {2.0, 3.0, 7.0, std::numeric_limits<double>::infinity()}) {
      CAPTURE(beta);
      auto const found = winding_of<collide::bvh>(scene.mesh, scene.points, beta, space);
      auto const on_host = winding_of<collide::bvh>(scene.mesh, scene.points, beta);
      CHECK(std::memcmp(found.data(), on_host.data(), found.size() * sizeof found[0]) == 0);
      std::size_t wrong = 0, wider = 0, none = 0;
      for (std::size_t i = 0; i < found.size(); ++i) {
        if (std::isnan(found[i].value)) {
          wrong += !std::isnan(direct[i].value) || !std::isnan(found[i].error) || scene.points[i].allFinite();
          ++none;
          continue;
        }
        double const off = std::abs(double(found[i].value) - double(direct[i].value));
        wrong += !(off <= double(found[i].error) + double(direct[i].error));
        // what is left out at beta = 2 is at most 5 / 4 of what the moments are for
        wider += !last.empty() && double(found[i].error) > 1.01 * double(last[i].error) + 1e-6;
      }
      CHECK(wrong == 0);
      CHECK(wider == 0);
      CHECK(none >= 2);
      CHECK(none < found.size() / 4);
      last = found;
    }
  }
}

}  // namespace tests
