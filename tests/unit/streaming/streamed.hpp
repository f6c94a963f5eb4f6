/// Spheres that stream through in chunks: what is found is what one query of all of them finds.
#pragma once

#include <cstring>
#include <memory_resource>
#include <stdexcept>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/detectors/streamed.cuh>
#include <collide/karabassi_swept.hpp>
#include <collide/sinks/impacts.hpp>
#include <collide/spaces/upload.hpp>

#include "io/scenes.hpp"
#include "type_erased_detector.hpp"

namespace tests {

/// A torus among spheres of many radii, in host memory of a resource, in every layout.
template <class S>
class layouts {
  using numbers = std::pmr::vector<S>;

 public:
  explicit layouts(std::size_t n, std::pmr::memory_resource* memory)
      : vertices_(memory), xyz_(memory), soa_(memory), radii_(memory), xyzr_(memory), records_(memory), ways_(memory) {
    io::scene const s = io::study_scene(0, 400);
    io::random_numbers random(1);
    vertices_.assign(s.vertices.begin(), s.vertices.end());
    corners_ = s.corners;
    for (std::size_t i = 0; i < n; ++i) {
      io::point const p = random.in_cube(400), way = random.in_cube(i % 5 == 0 ? 300 : 30);
      for (std::size_t k = 0; k < 3; ++k) xyz_.push_back(static_cast<S>(p[k]));
      for (std::size_t k = 0; k < 3; ++k) ways_.push_back(static_cast<S>(way[k]));
      radii_.push_back(static_cast<S>(random.between(10, 60)));
    }
    S const filler = S(1e9);
    soa_.resize(3 * n);
    for (std::size_t i = 0; i < n; ++i) {
      S const x = xyz_[3 * i], y = xyz_[3 * i + 1], z = xyz_[3 * i + 2], r = radii_[i];
      soa_[i] = x, soa_[n + i] = y, soa_[2 * n + i] = z;
      xyzr_.insert(xyzr_.end(), {x, y, z, r});
      records_.insert(records_.end(), {filler, r, z, filler, x, y, filler});
    }
  }

  collide::mesh_view<S> mesh() const {
    return collide::indexed_mesh(vertices_.data(), vertices_.size() / 3, corners_.data(), corners_.size() / 3);
  }

  std::size_t size() const { return radii_.size(); }
  S largest_radius() const { return S(60); }

  collide::sphere_view<S> xyz() const { return collide::spheres_xyz(xyz_.data(), size(), radii_.data()); }

  struct layout {
    char const* name;
    collide::sphere_view<S> spheres;
  };

  std::vector<layout> all() const {
    std::size_t const n = size();
    S const *const s = soa_.data(), *const r = records_.data();
    return {{"xyz", xyz()},
            {"xyz, one radius", collide::spheres_xyz(xyz_.data(), n, 40)},
            {"soa", collide::spheres_soa(s, s + n, s + 2 * n, n, radii_.data())},
            {"soa, one radius", collide::spheres_soa(s, s + n, s + 2 * n, n, 40)},
            {"xyzr", collide::spheres_xyzr(xyzr_.data(), n)},
            {"records", collide::spheres_at(collide::points(r + 4, r + 5, r + 2, n, 7), r + 1, 7)}};
  }

  S const* ways() const { return ways_.data(); }

 private:
  numbers vertices_, xyz_, soa_, radii_, xyzr_, records_, ways_;
  std::vector<std::uint32_t> corners_;
};

template <class T>
bool same_bytes(std::vector<T> const& a, std::vector<T> const& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(static_cast<void const*>(a.data()), b.data(), a.size() * sizeof(T)) == 0);
}

inline collide::id& sphere_of(collide::pair& p) { return p.sphere; }
template <class S>
collide::id& sphere_of(collide::contact<S>& c) {
  return c.sphere;
}
template <class S>
collide::id& sphere_of(collide::impact<S>& i) {
  return i.contact.sphere;
}

/// The records of a sink that has one for each pair, chunk after chunk, with the numbers of all spheres.
template <class Found, class Streamed, class Spheres, class Sink>
std::vector<Found> records_of(Streamed& streamed, Spheres const& spheres, Sink&& sink) {
  std::vector<Found> all;
  streamed.query(spheres, sink, [&](collide::id first, auto const& found) {
    for (Found f : found.to_host()) {
      sphere_of(f) += first;
      all.push_back(f);
    }
  });
  return all;
}

/// Every layout in chunks of many sizes, with every kind of sink, compared with one query.
template <class Broad, class S, class Space>
void check_streamed(Space const& space, std::pmr::memory_resource* memory) {
  constexpr auto canonical = collide::order::canonical;
  layouts<S> const from(240, memory);
  auto const mesh = collide::upload(space, from.mesh());
  collide::detector<Broad, collide::karabassi<>, Space, S> detector(space);
  detector.build(mesh.view(), from.largest_radius());
  for (auto const& layout : from.all()) {
    auto const& spheres = layout.spheres;
    CAPTURE(layout.name);
    auto const placed = collide::upload(space, spheres);
    auto const pairs = detector.query(placed.view(), collide::pairs(canonical)).to_host();
    auto const contacts = detector.query(placed.view(), collide::contacts<S>(canonical)).to_host();
    auto const closest = detector.query(placed.view(), collide::closest_contact<S>()).to_host();
    CHECK(pairs.size() > 100);
    for (std::size_t const chunk : {64, 80, 240, 1 << 30}) {  // 64 leaves a rest, 80 none
      CAPTURE(chunk);
      collide::streamed streamed(detector, chunk);
      CHECK((records_of<collide::pair>(streamed, spheres, collide::pairs(canonical)) == pairs));
      CHECK(same_bytes(records_of<collide::contact<S>>(streamed, spheres, collide::contacts<S>(canonical)), contacts));
      std::uint64_t total = 0;
      std::size_t calls = 0;
      streamed.query(spheres, collide::count(), [&](collide::id first, collide::count const& found) {
        CHECK(first == calls++ * chunk);
        total += found.total();
      });
      CHECK(calls == (240 - 1) / chunk + 1);
      CHECK(total == pairs.size());
      std::vector<collide::contact<S>> of_chunks;
      collide::closest_contact<S> sink;
      streamed.query(spheres, sink, [&](collide::id first, auto const& found) {
        CHECK(first == of_chunks.size());
        for (auto contact : found.to_host()) {
          if (contact.triangle != collide::no_id) contact.sphere += first;
          of_chunks.push_back(contact);
        }
      });
      CHECK(same_bytes(of_chunks, closest));
    }
  }
}

/// Spheres that move.
template <class Broad, class S, class Space>
void check_streamed_swept(Space const& space, std::pmr::memory_resource* memory) {
  constexpr auto canonical = collide::order::canonical;
  layouts<S> const from(240, memory);
  auto const mesh = collide::upload(space, from.mesh());
  collide::buffer<S> buffer;
  S* const ways = buffer.reserve(space.resource(), 3 * from.size());
  space.copy_from_host(ways, from.ways(), 3 * from.size());
  collide::detector<Broad, collide::karabassi_swept<>, Space, S> detector(space);
  detector.build(mesh.view(), from.largest_radius());
  for (auto const& layout : from.all()) {
    auto const& spheres = layout.spheres;
    CAPTURE(layout.name);
    auto const placed = collide::upload(space, spheres);
    auto const moving = collide::with_displacements(placed.view(), static_cast<S const*>(ways));
    auto const pairs = detector.query(moving, collide::pairs(canonical)).to_host();
    auto const impacts = detector.query(moving, collide::impacts<S>(canonical)).to_host();
    CHECK(pairs.size() > 100);
    for (std::size_t const chunk : {64, 80, 1000}) {
      CAPTURE(chunk);
      collide::streamed streamed(detector, chunk);
      auto const here = collide::with_displacements(spheres, from.ways());
      CHECK((records_of<collide::pair>(streamed, here, collide::pairs(canonical)) == pairs));
      CHECK(same_bytes(records_of<collide::impact<S>>(streamed, here, collide::impacts<S>(canonical)), impacts));
    }
  }
}

/// A sink that has had enough after some queries.
struct reluctant {
  int left;
  template <class Space, class Query>
  void run(Space&, Query const&) {
    if (left-- == 0) throw std::runtime_error("enough");
  }
};

/// No spheres, no chunk, and exceptions on the way.
template <class Space>
void check_streamed_edges(Space const& space, std::pmr::memory_resource* memory) {
  layouts<float> const from(240, memory);
  auto const mesh = collide::upload(space, from.mesh());
  collide::detector<collide::bucket, collide::karabassi<>, Space> detector(space);

  using streamed_type = collide::streamed<decltype(detector)>;
  std::string what;
  try {
    streamed_type(detector, 0);
  } catch (collide::error const& e) {
    what = e.what();
  }
  CHECK(what.find("chunk") != std::string::npos);

  streamed_type streamed(detector, 50);
  std::uint64_t total = 0, calls = 0;
  auto const add = [&](collide::id, collide::count const& found) {
    total += found.total();
    ++calls;
  };
  CHECK_THROWS_AS(streamed.query(from.xyz(), collide::count(), add), collide::error);  // nothing is built yet
  detector.build({});
  streamed.query(from.xyz(), collide::count(), add);
  CHECK(calls == 5);
  CHECK(total == 0);
  streamed.query({}, collide::count(), add);
  CHECK(calls == 5);

  detector.build(mesh.view(), from.largest_radius());
  auto const expected =
      detector.query(collide::upload(space, from.xyz()).view(), collide::pairs(collide::order::canonical)).to_host();
  collide::pairs kept(collide::order::canonical);
  for (collide::id const last : {0u, 100u, 200u}) {
    auto const refuse = [&](collide::id first, auto const&) {
      if (first == last) throw std::runtime_error("enough");
    };
    CHECK_THROWS_WITH(streamed.query(from.xyz(), collide::count(), refuse), "enough");
    CHECK_THROWS_WITH(streamed.query(from.xyz(), reluctant{static_cast<int>(last / 50)}, [](auto, auto&) {}), "enough");
    CHECK((records_of<collide::pair>(streamed, from.xyz(), kept) == expected));
  }
  streamed_type one_by_one(detector, 1);
  CHECK((records_of<collide::pair>(one_by_one, from.xyz(), kept) == expected));
  CHECK(kept.size() < expected.size());  // it holds those of the last sphere
}

/// A stream takes memory of the space for three chunks, and for no more spheres than there are.
template <class Space>
void check_streamed_memory(Space const& plain, counting_resource& counting) {
  layouts<float> const from(240, std::pmr::new_delete_resource());
  auto const mesh = collide::upload(plain, from.mesh());
  collide::detector<collide::bucket, collide::karabassi<>, Space> detector(plain);
  detector.build(mesh.view(), from.largest_radius());
  collide::count sink;
  detector.query(collide::upload(plain, from.xyz()).view(), sink);
  std::size_t const before = counting.in_use;
  for (std::size_t const chunk : {1 << 22, 240, 120, 60}) {
    std::size_t const places = std::min<std::size_t>(3, 240 / std::min<std::size_t>(240, chunk));
    collide::streamed streamed(detector, chunk);
    std::size_t allocations = 0;
    for (int run = 0; run < 2; ++run) {
      streamed.query(from.xyz(), sink, [](auto, auto&) {});
      if (run == 0) allocations = counting.allocations;
    }
    CHECK(counting.allocations == allocations);
    std::size_t const spheres = places * std::min<std::size_t>(240, chunk) * 4 * sizeof(float);
    CHECK(counting.in_use - before >= spheres);
    CHECK(counting.in_use - before <= spheres + places * 2 * 256);
  }
  CHECK(counting.in_use == before);
}

}  // namespace tests
