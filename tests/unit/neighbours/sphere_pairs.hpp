/// \file
/// Pairs of spheres in a space, against the oracle on all pairs.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <collide/detectors/sphere_pairs.cuh>
#include <collide/spaces/upload.hpp>

#include "../oracle/exact.hpp"
#include "type_erased_detector.hpp"

namespace tests {

/// Spheres with a radius each.
template <class S>
struct sphere_set {
  std::string name;
  std::vector<S> xyz, radii;

  void add(S x, S y, S z, S r) {
    xyz.insert(xyz.end(), {x, y, z});
    radii.push_back(r);
  }
  std::size_t size() const { return radii.size(); }
  collide::sphere_view<S> view() const { return collide::spheres_xyz(xyz.data(), size(), radii.data()); }
};

/// Sets that are hard to find all pairs of, and easy to find too many.
template <class S>
std::vector<sphere_set<S>> hard_sphere_sets() {
  using limits = std::numeric_limits<S>;
  std::mt19937 engine(11);
  std::uniform_real_distribution<S> uniform(-1, 1);
  std::vector<sphere_set<S>> all{{"none", {}, {}}, {"one", {1, 2, 3}, {4}}};
  auto const make = [&](char const* name, std::size_t n, auto const& add) {
    all.push_back({name, {}, {}});
    for (std::size_t i = 0; i < n; ++i) add(all.back(), i);
  };
  for (S const scale : {S(1), S(1e-3), S(1e4)}) {
    make("cloud", 120, [&](auto& s, std::size_t) {
      s.add(scale * uniform(engine), scale * uniform(engine), scale * uniform(engine), scale / 8);
    });
  }
  // neighbours touch exactly, and by one unit in the last place not
  for (S const at : {S(0), S(-3), S(4096)}) {
    for (S const radius : {S(0.5), std::nextafter(S(0.5), S(0)), std::nextafter(S(0.5), S(1))}) {
      make("lattice", 125,
           [&](auto& s, std::size_t i) { s.add(at + S(i % 5), at + S(i / 5 % 5), -at + S(i / 25), radius); });
    }
  }
  // pairs that nearly touch, in any direction: the second radius is what the distance leaves, give or take an ulp
  for (S const away : {S(0), S(1e3)}) {
    make("tangent", 75, [&](auto& s, std::size_t i) {
      S const x = away + uniform(engine), y = uniform(engine), z = uniform(engine), r = S(0.1) + uniform(engine) / 16;
      S const dx = uniform(engine) / 4, dy = uniform(engine) / 4, dz = uniform(engine) / 4;
      S const px = x + dx, py = y + dy, pz = z + dz;
      S const left = std::abs(std::sqrt((px - x) * (px - x) + (py - y) * (py - y) + (pz - z) * (pz - z)) - r);
      S const other = i % 3 == 0 ? left : std::nextafter(left, i % 3 == 1 ? S(0) : S(1));
      s.add(x, y, z, r);
      s.add(px, py, pz, other);
    });
  }
  make("one place", 40, [&](auto& s, std::size_t i) { s.add(S(0.1), S(0.2), S(0.3), i % 2 == 0 ? S(0) : S(0.5)); });
  make("points", 90, [&](auto& s, std::size_t i) {
    S const x = S(i / 3);  // three of each, of which one is an ulp off
    s.add(i % 3 == 2 ? std::nextafter(x, S(-1)) : x, -x, x * x, 0);
  });
  for (S const ratio : {S(100), S(1e6)}) {
    make("sizes", 150, [&](auto& s, std::size_t i) {
      S const r = std::pow(ratio, (uniform(engine) - 1) / 2) * (i % 10 == 0 ? S(1) : S(0.3));
      S const spread = i % 10 == 0 ? S(4) : S(2);
      s.add(spread * uniform(engine), spread * uniform(engine), spread * uniform(engine), r);
    });
  }
  make("every magnitude", 150, [&](auto& s, std::size_t) {
    auto const any = [&] {
      return std::ldexp(uniform(engine),
                        int(engine() % 20) * (sizeof(S) == 4 ? 12 : 100) - (sizeof(S) == 4 ? 120 : 1000));
    };
    S const x = any(), y = any(), z = any();
    s.add(x, y, z, std::abs(any()));
  });
  make("limits", 60, [&](auto& s, std::size_t i) {
    S const small = limits::denorm_min(), large = limits::max();
    S const sizes[] = {0, small, 3 * small, limits::min(), 1, large / 4, large}, radius = sizes[i % 7];
    S const places[] = {0, small, -small, large, -large, large / 2, 4 * small}, x = places[i % 6],
            y = places[i / 7 % 7];
    s.add(x, y, 0, radius);
  });
  make("not finite", 60, [&](auto& s, std::size_t i) {
    S const nan = limits::quiet_NaN(), infinite = limits::infinity();
    S const odd[] = {nan, infinite, -infinite, 0}, radii[] = {nan, infinite, S(-1), -infinite, S(-0.0), 1};
    s.add(i % 3 == 0 ? odd[i / 3 % 4] : S(i), i % 5 == 0 ? odd[i / 5 % 4] : S(0), 0, radii[i % 6]);
  });
  make("one far away", 100, [&](auto& s, std::size_t i) {
    S const far = i == 50 ? S(1e30) : S(1);
    s.add(far * uniform(engine), uniform(engine), uniform(engine), S(0.1));
  });
  return all;
}

using pair_list = std::vector<std::vector<collide::id>>;

/// The neighbours of each sphere, by looking at all pairs.
template <class S>
pair_list neighbours_by_oracle(collide::sphere_view<S> const& spheres) {
  pair_list all(spheres.size());
  auto const sphere_of = [&](std::size_t i) {
    auto const c = spheres.centre(i);
    return oracle::sphere{{double(c.x()), double(c.y()), double(c.z())}, double(spheres.radius(i))};
  };
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (oracle::touch(sphere_of(i), sphere_of(k))) {
        all[i].push_back(static_cast<collide::id>(k));
        all[k].push_back(static_cast<collide::id>(i));
      }
  return all;
}

/// Every sink, once and both ways.
template <class Finder, class S>
void check_sphere_pairs_of(Finder& finder, collide::sphere_view<S> const& spheres, pair_list const& expected) {
  using collide::order;
  std::vector<collide::pair> once;
  std::vector<std::uint64_t> offsets{0};
  std::vector<collide::id> rows;
  std::vector<std::uint8_t> touched;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    for (auto const k : expected[i])
      if (i < k) once.push_back({static_cast<collide::id>(i), k});
    rows.insert(rows.end(), expected[i].begin(), expected[i].end());
    offsets.push_back(rows.size());
    touched.push_back(expected[i].empty() ? 0 : 1);
  }
  auto const sorted = finder.query(spheres, collide::pairs(order::canonical)).to_host();
  bool same = sorted.size() == once.size();
  for (std::size_t n = 0; same && n < once.size(); ++n)
    same = sorted[n].sphere == once[n].sphere && sorted[n].triangle == once[n].triangle;
  CHECK(same);
  CHECK(finder.query(spheres, collide::pairs()).total() == once.size());
  CHECK(finder.query(spheres, collide::count()).total() == once.size());
  CHECK(finder.neighbours(spheres, collide::count()).total() == 2 * once.size());
  auto const lists = finder.neighbours(spheres, collide::csr(order::canonical)).to_host();
  CHECK(lists.offsets == offsets);
  CHECK(lists.triangles == rows);
  CHECK(finder.query(spheres, collide::csr()).total() == once.size());
  CHECK(finder.neighbours(spheres, collide::any_hit()).to_host() == touched);
}

template <class Space, class S>
void check_sphere_pairs(Space const& space) {
  collide::sphere_pairs<Space, S> finder(space);
  std::size_t found = 0;
  for (auto const& set : hard_sphere_sets<S>()) {
    CAPTURE(set.name);
    auto const expected = neighbours_by_oracle(set.view());
    auto const there = collide::upload(space, set.view());
    check_sphere_pairs_of(finder, there.view(), expected);
    for (auto const& row : expected) found += row.size();
    // with the first radius for all
    if (set.name != "lattice" && set.name != "cloud" && set.name != "tangent") continue;
    auto const alike = collide::spheres_xyz(set.xyz.data(), set.size(), set.radii[0]);
    auto const alike_there = collide::upload(space, alike);
    check_sphere_pairs_of(finder, alike_there.view(), neighbours_by_oracle(alike));
  }
  CHECK(found > 3000);
}

/// Memory is kept, and what `reserve` takes is enough.
template <class Space>
void check_sphere_pairs_allocate_once(Space const& space, counting_resource& memory) {
  std::vector<float> xyz;
  std::mt19937 engine(3);
  for (int i = 0; i < 3000; ++i) xyz.push_back(float(engine() % 1000) / 100);
  auto const spheres = collide::upload(space, collide::spheres_xyz(xyz.data(), 1000, 0.5f));
  collide::sphere_pairs<Space> finder(space);
  collide::csr lists(collide::order::canonical);
  collide::pairs pairs;
  finder.reserve(1000, 40000, lists, pairs);
  std::size_t const before = memory.allocations;
  CHECK(finder.neighbours(spheres.view(), lists).total() == 2 * finder.query(spheres.view(), pairs).total());
  CHECK(pairs.total() > 1000);
  CHECK(pairs.total() < 20000);
  CHECK(memory.allocations == before);
}

}  // namespace tests
