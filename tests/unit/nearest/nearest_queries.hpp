/// \file
/// The sink `nearest` in a space, against a loop over all triangles.
#pragma once

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/all_pairs.cuh>
#include <collide/bvh.cuh>
#include <collide/detectors/in_passes.hpp>
#include <collide/sinks/k_nearest.hpp>
#include <collide/sinks/nearest.hpp>
#include <collide/spaces/upload.hpp>

#include "hard_meshes.hpp"
#include "type_erased_detector.hpp"

namespace tests {

/// Points on and near the corners and edges of a mesh, anywhere around it, and some that are none.
template <class S>
std::vector<S> points_around(hard_mesh<S> const& made, std::size_t n) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<S> uniform(-1, 1);
  S const extent = made.extent(), nan = std::numeric_limits<S>::quiet_NaN();
  std::vector<S> all;
  auto const mesh = made.view();
  for (std::size_t i = 0; i < n; ++i) {
    auto const t = mesh[engine() % mesh.size()];
    collide::vec3<S> p(extent * uniform(engine), extent * uniform(engine), extent * uniform(engine));
    if (i % 5 == 1) p = t.a;
    if (i % 5 == 2) p = t.a / 2 + t.b / 2;
    if (i % 5 == 3) p = t.c + p / 64;
    if (i % 50 == 49) p[1] = i % 100 == 49 ? nan : std::numeric_limits<S>::infinity();
    all.insert(all.end(), p.data(), p.data() + 3);
  }
  return all;
}

template <class S>
bool same_bytes(std::vector<collide::nearest_triangle<S>> const& a,
                std::vector<collide::nearest_triangle<S>> const& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    // NaN has more than one form
    auto const same = [](S x, S y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    bool alike = a[i].triangle == b[i].triangle && a[i].feature == b[i].feature &&
                 a[i].feature_index == b[i].feature_index && same(a[i].distance, b[i].distance);
    for (int k = 0; k < 3; ++k)
      alike = alike && same(a[i].point[k], b[i].point[k]) && same(a[i].barycentric[k], b[i].barycentric[k]);
    if (!alike) return false;
  }
  return true;
}

/// The answer of a plain loop over all triangles.
template <class Precision, class S>
std::vector<collide::nearest_triangle<S>> nearest_by_loop(collide::mesh_view<S> const& mesh,
                                                          std::vector<S> const& points, S most) {
  std::vector<collide::nearest_triangle<S>> all;
  for (std::size_t i = 0; i < points.size(); i += 3) {
    collide::detail::nearest_search<S, Precision> search({points[i], points[i + 1], points[i + 2]}, most);
    for (collide::id t = 0; t < mesh.size(); ++t) search.consider(mesh[t], t);
    all.push_back(search.result());
  }
  return all;
}

template <class Broad, class Space, class S>
void check_nearest(Space const& space) {
  using collide::nearest;
  for (auto const& made : hard_meshes<S>(300)) {
    CAPTURE(made.name);
    CAPTURE(Space::name());
    auto const points = points_around(made, 150);
    auto const mesh = collide::upload(space, made.view());
    auto const there = collide::upload(space, collide::spheres_xyz(points.data(), points.size() / 3, S(0)));
    collide::detector<Broad, collide::karabassi<>, Space, S> detector(space);
    detector.build(mesh.view());
    auto const expected = nearest_by_loop<collide::exact>(made.view(), points, std::numeric_limits<S>::infinity());
    CHECK(same_bytes(detector.query(there.view().centres(), nearest<S>()).to_host(), expected));
    S const most = made.extent() / 16;
    CHECK(same_bytes(detector.query(there.view().centres(), nearest<S>(most)).to_host(),
                     nearest_by_loop<collide::exact>(made.view(), points, most)));

    // of spheres the surface counts
    S const radius = made.extent() / 64;
    auto const balls = collide::upload(space, collide::spheres_xyz(points.data(), points.size() / 3, radius));
    auto const found = detector.query(balls.view(), nearest<S>()).to_host();
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      bool const none = expected[i].triangle == collide::no_id;
      wrong += found[i].triangle != expected[i].triangle ||
               (none ? found[i].distance != expected[i].distance : found[i].distance != expected[i].distance - radius);
    }
    CHECK(wrong == 0);
    auto const none = collide::upload(space, collide::spheres_xyz(points.data(), points.size() / 3, S(-1)));
    for (auto const& n : detector.query(none.view(), nearest<S>()).to_host()) CHECK(n.triangle == collide::no_id);

    detector.build(collide::mesh_view<S>());
    auto const nothing = detector.query(there.view().centres(), nearest<S>()).to_host();
    CHECK(nothing.size() == points.size() / 3);
    for (auto const& n : nothing) {
      CHECK(n.triangle == collide::no_id);
      CHECK(n.distance == std::numeric_limits<S>::infinity());
      CHECK(std::isnan(n.point[2]));
    }
  }
}

/// A mesh in passes has the nearest triangles that it has in one.
template <class Broad, class Precision, class Space, class S>
void check_nearest_in_passes(Space const& space) {
  for (auto const& made : hard_meshes<S>(50)) {
    CAPTURE(made.name);
    CAPTURE(Space::name());
    auto const points = points_around(made, 50);
    auto const there =
        collide::upload(space, collide::spheres_xyz(points.data(), points.size() / 3, made.extent() / 64));
    auto const mesh = collide::upload(space, made.view());
    using detector_type = collide::detector<Broad, collide::karabassi<Precision>, Space, S>;
    detector_type whole(space);
    whole.build(mesh.view());
    collide::in_passes<detector_type> passes(space);
    for (S const most : {std::numeric_limits<S>::infinity(), made.extent() / 16}) {
      for (std::size_t const part : {std::size_t{1} + made.size() / 5, std::size_t{1} + made.size() / 2, made.size()}) {
        passes.build(made.view(), part);
        collide::nearest<S> found(most);
        CHECK(same_bytes(passes.query(there.view(), found).to_host(),
                         whole.query(there.view(), collide::nearest<S>(most)).to_host()));
        passes.query(there.view().centres(), found);  // into the same memory
        CHECK(same_bytes(found.to_host(), whole.query(there.view().centres(), collide::nearest<S>(most)).to_host()));
      }
    }
    CHECK(passes.query(collide::sphere_view<S>(), collide::nearest<S>()).to_host().empty());
  }
}

/// The k nearest, one after the other: each time the nearest of those that are left.
template <class Broad, class Space, class S>
void check_k_nearest(Space const& space) {
  constexpr S far = std::numeric_limits<S>::infinity();
  for (auto const& made : hard_meshes<S>(60)) {
    if (made.size() > 100) continue;
    CAPTURE(made.name);
    auto const points = points_around(made, 50);
    auto const mesh = collide::upload(space, made.view());
    auto const there = collide::upload(space, collide::spheres_xyz(points.data(), points.size() / 3, S(0)));
    collide::detector<Broad, collide::karabassi<>, Space, S> detector(space);
    detector.build(mesh.view());
    for (int const k : {1, 3, 32}) {
      std::vector<collide::nearest_triangle<S>> expected;
      for (std::size_t i = 0; i < points.size(); i += 3) {
        std::vector<bool> taken(made.size());
        for (int j = 0; j < k; ++j) {
          collide::detail::nearest_search<S, collide::exact> search({points[i], points[i + 1], points[i + 2]}, far);
          for (collide::id t = 0; t < made.size(); ++t) {
            if (!taken[t]) search.consider(made.view()[t], t);
          }
          expected.push_back(search.result());
          if (expected.back().triangle != collide::no_id) taken[expected.back().triangle] = true;
        }
      }
      collide::k_nearest<S> sink(k);
      CHECK(same_bytes(detector.query(there.view().centres(), sink).to_host(), expected));
      CHECK(sink.rows() == points.size() / 3);
    }
    auto const few = detector.query(there.view().centres(), collide::k_nearest<S>(4, made.extent() / 8)).to_host();
    auto const first = detector.query(there.view().centres(), collide::nearest<S>(made.extent() / 8)).to_host();
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < few.size(); ++i) {
      bool const ordered = i % 4 == 0 ? few[i].triangle == first[i / 4].triangle
                                      : few[i].triangle == collide::no_id || few[i - 1].distance <= few[i].distance;
      wrong += !ordered || (few[i].triangle != collide::no_id && few[i].distance > made.extent() / 8);
    }
    CHECK(wrong == 0);
  }
}

/// Plain arithmetic finds the same with both broad phases, and a triangle about as near as the nearest.
template <class Precision, class Space, class S>
void check_plain_nearest(Space const& space) {
  auto const made = hard_meshes<S>(500)[3];
  auto const points = points_around(made, 200);
  auto const mesh = collide::upload(space, made.view());
  auto const there = collide::upload(space, collide::spheres_xyz(points.data(), points.size() / 3, S(0)));
  auto const found = [&](auto broad) {
    collide::detector<decltype(broad), collide::karabassi<Precision>, Space, S> detector(space);
    return detector.detect(mesh.view(), there.view().centres(), collide::nearest<S>()).to_host();
  };
  auto const expected = nearest_by_loop<collide::exact>(made.view(), points, std::numeric_limits<S>::infinity());
  auto const of_tree = found(collide::bvh()), of_all = found(collide::all_pairs());
  std::size_t wrong = 0, far = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    wrong += of_tree[i].triangle != of_all[i].triangle;
    far += !(std::abs(of_tree[i].distance - expected[i].distance) <= S(1e-4)) && expected[i].triangle != collide::no_id;
  }
  CHECK(wrong == 0);
  CHECK(far == 0);
}

/// Nothing is allocated from the second query on, nor by a second build of the same mesh.
template <class Broad, class Space>
void check_nearest_allocates_once(Space const& space, counting_resource& memory) {
  auto const made = hard_meshes<float>(400)[3];
  auto const points = points_around(made, 100);
  auto const mesh = collide::upload(space, made.view());
  auto const there = collide::upload(space, collide::spheres_xyz(points.data(), points.size() / 3, 0.0f));
  collide::detector<Broad, collide::karabassi<>, Space> detector(space);
  collide::nearest<float> sink;
  detector.build(mesh.view());
  detector.reserve(100, 0, sink);
  std::size_t const before = memory.allocations;
  detector.query(there.view().centres(), sink);
  detector.query(there.view().centres(), sink);
  detector.build(mesh.view());
  detector.query(there.view().centres(), sink);
  CHECK(memory.allocations == before);
  CHECK(sink.size() == 100);
}

}  // namespace tests
