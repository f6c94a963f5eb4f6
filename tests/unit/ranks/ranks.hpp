/// \file
/// Checks of every model of ranks, and that detectors on ranks find the same as one detector of everything.
/// Each rank checks its own part, and says what is wrong; used with threads by the unit tests, and with MPI by
/// tests/mpi.
#pragma once

#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory_resource>
#include <new>
#include <numeric>
#include <string>
#include <type_traits>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/karabassi_swept.hpp>
#include <collide/ranks/distributed.hpp>
#include <collide/sinks/csr.hpp>
#include <collide/sinks/earliest.hpp>
#include <collide/sinks/impacts.hpp>

#include "swept_queries.hpp"

namespace tests {

/// Sentences about what is wrong; none if all is well.
class complaints {
 public:
  void expect(bool is_well, std::string const& otherwise) {
    if (!is_well) text_ += (where_.empty() ? "" : where_ + ": ") + otherwise + "\n";
  }
  void in(std::string const& where) { where_ = where; }
  std::string const& text() const { return text_; }

 private:
  std::string where_, text_;
};

/// The members of a model of ranks, with messages of all sizes, empty ones too.
template <class Ranks>
void check_members(Ranks const& ranks, complaints& wrong) {
  auto const size = static_cast<std::size_t>(ranks.size()), me = static_cast<std::size_t>(ranks.rank());
  wrong.expect(me < size, "the number of a rank is below their number");

  std::vector<std::uint64_t> const mine{me, 100 + me, 5};
  std::vector<std::uint64_t> all(3 * size), sum(3), most(3);
  ranks.all_gather(mine.data(), 24, all.data());
  for (std::size_t r = 0; r < size; ++r) wrong.expect(all[3 * r + 1] == 100 + r, "all_gather is in the order of ranks");
  ranks.reduce(mine.data(), sum.data(), 3, collide::reduction::sum);
  ranks.reduce(mine.data(), most.data(), 3, collide::reduction::max);
  wrong.expect(sum[0] == size * (size - 1) / 2 && sum[2] == 5 * size, "sums are of all ranks");
  wrong.expect(most[0] == size - 1 && most[1] == 99 + size && most[2] == 5, "maxima are of all ranks");

  for (std::size_t const length : {0, 1, 1000}) {  // rank q sends (q + r) % 3 * length items of 3 bytes to rank r
    std::vector<std::uint64_t> to_each(size), of_each(size);
    std::vector<unsigned char> from;
    for (std::size_t r = 0; r < size; ++r) {
      to_each[r] = (me + r) % 3 * length;
      for (std::size_t i = 0; i < 3 * to_each[r]; ++i) from.push_back(static_cast<unsigned char>(me + 7 * r + i));
    }
    ranks.exchange_counts(to_each.data(), of_each.data());
    wrong.expect(of_each == to_each, "counts are exchanged");  // the rule is symmetric
    std::vector<unsigned char> to(3 * std::accumulate(of_each.begin(), of_each.end(), std::size_t{0}), 255);
    ranks.exchange(from.data(), to_each.data(), to.data(), of_each.data(), 3);
    std::size_t at = 0, different = 0;
    for (std::size_t q = 0; q < size; ++q) {
      for (std::size_t i = 0; i < 3 * of_each[q]; ++i) {
        different += to[at++] != static_cast<unsigned char>(q + 7 * me + i);
      }
    }
    wrong.expect(different == 0, "items arrive in the order of ranks");
  }
  wrong.expect(collide::count_before(ranks, 10) == 10 * me, "count_before counts those of lower ranks");
}

/// One rank throws, or its process is killed, while the others wait for it.
template <class Ranks>
[[noreturn]] void fail_on_one_rank(Ranks const& ranks, bool dies) {
  if (ranks.rank() == 1) {
    if (dies) std::raise(SIGKILL);
    throw collide::error("on purpose");
  }
  for (;;) collide::agree(ranks);
}

/// One rank throws: all do, and say which.
template <class Ranks>
void check_agreement(Ranks const& ranks, complaints& wrong) {
  collide::agree(ranks);
  for (int failing = 0; failing < ranks.size(); ++failing) {
    std::string said;
    try {
      collide::together(ranks, [&] {
        if (ranks.rank() >= failing) throw std::bad_alloc();
      });
    } catch (std::bad_alloc const&) {
      said = "mine";
    } catch (collide::rank_error const& e) {
      said = e.what();
    }
    std::string const others = "collide: rank " + std::to_string(failing) + " of " + std::to_string(ranks.size()) +
                               " failed: " + std::bad_alloc().what();
    wrong.expect(said == (ranks.rank() >= failing ? "mine" : others), "agree: " + said);
  }
}

/// How a set is divided among ranks.
enum class split { evenly, first, last, odd };

struct range {
  std::size_t first, size;
};

/// The part of a rank.
inline range part_of(std::size_t n, split how, int rank, int ranks) {
  auto const r = static_cast<std::size_t>(rank), all = static_cast<std::size_t>(ranks);
  switch (how) {
    case split::evenly:
      return {n * r / all, n * (r + 1) / all - n * r / all};
    case split::first:
      return r == 0 ? range{0, n} : range{n, 0};
    case split::last:
      return r + 1 == all ? range{0, n} : range{0, 0};
    case split::odd:
      break;
  }
  std::size_t const odd = all / 2;  // without any, the first has all
  if (odd == 0) return {0, n};
  std::size_t const begin = n * (r / 2) / odd;
  return r % 2 == 0 ? range{begin, 0} : range{begin, n * (r / 2 + 1) / odd - begin};
}

/// A scene as it lies on the ranks.
struct layout {
  split mesh = split::evenly, spheres = split::evenly;
  bool is_divided = true;
  std::size_t chunk = 1 << 20;
};

template <class T>
bool equal_bytes(std::vector<T> const& a, std::vector<T> const& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Those entries whose sphere is in the range, with the numbers that it has there.
template <class T, class Sphere>
std::vector<T> of_spheres(std::vector<T> const& all, range part, Sphere const& sphere_of) {
  std::vector<T> mine;
  for (T entry : all) {
    collide::id& sphere = sphere_of(entry);
    if (sphere < part.first || sphere >= part.first + part.size) continue;
    sphere -= static_cast<collide::id>(part.first);
    mine.push_back(entry);
  }
  return mine;
}

/// Checks what all sinks hold on this rank against what they hold where one detector has everything.
template <class Detector, class Ranks, class S, class Spheres>
void check_sinks(Ranks const& ranks, moving_scene<S> const& made, Spheres const& spheres, layout const& lies,
                 complaints& wrong) {
  using collide::order;
  constexpr bool moves = !std::is_same<Spheres, collide::sphere_view<S>>::value;
  collide::host const space(1);
  Detector whole(space);
  whole.build(made.mesh());
  collide::distributed<Detector, Ranks> parts(ranks, space, {}, lies.chunk);
  range const triangles = part_of(made.mesh().size(), lies.mesh, ranks.rank(), ranks.size());
  range const own = part_of(spheres.size(), lies.spheres, ranks.rank(), ranks.size());
  if (lies.is_divided) {
    parts.build(collide::triangle_soup(made.corners.data() + 9 * triangles.first, triangles.size), collide::divided);
  } else {
    parts.build(made.mesh(), collide::on_every_rank);
  }
  auto const mine = spheres.subview(own.first, own.size);

  auto const all = whole.query(spheres, collide::pairs(order::canonical)).to_host();
  auto const expected = of_spheres(all, own, [](collide::pair& p) -> collide::id& { return p.sphere; });
  auto const found = parts.query(mine, collide::pairs(order::canonical));
  wrong.expect(found.to_host() == expected,
               "pairs, " + std::to_string(found.size()) + " for " + std::to_string(expected.size()));
  wrong.expect(parts.total(found) == all.size(), "the total of pairs is of all ranks");
  auto const counted = parts.query(mine, collide::count());
  wrong.expect(counted.total() == expected.size() && parts.total(counted) == all.size(), "count");
  std::vector<std::uint8_t> flags(own.size, 0);
  for (auto const& p : expected) flags[p.sphere] = 1;
  wrong.expect(parts.query(mine, collide::any_hit()).to_host() == flags, "flags");
  auto const rows = parts.query(mine, collide::csr(order::canonical)).to_host();
  wrong.expect(rows.offsets.size() == own.size + 1 && rows.triangles.size() == expected.size(), "rows");
  std::size_t misplaced = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) misplaced += rows.triangles[i] != expected[i].triangle;
  wrong.expect(misplaced == 0, "triangles of rows");

  std::vector<collide::pair> few(3, collide::pair{7, 7});
  auto const stored = parts.query(mine, collide::pairs(few.data(), few.size(), order::canonical)).size();
  wrong.expect(stored == std::min(expected.size(), few.size()) &&
                   std::equal(few.begin(), few.begin() + static_cast<std::ptrdiff_t>(stored), expected.begin()),
               "the first pairs, where memory ends");

  std::atomic<std::uint64_t> seen{0}, ids{0};
  parts.query(mine, collide::visit([&](collide::hit<typename Detector::narrow_phase, S> const& h) {
                seen += h.contact().triangle == h.triangle && h.contact().sphere == h.sphere;
                ids += h.triangle;
              }));
  std::uint64_t sum = 0;
  for (auto const& p : expected) sum += p.triangle;
  wrong.expect(seen == expected.size() && ids == sum, "visits");

  auto const contacts = of_spheres(whole.query(spheres, collide::contacts<S>(order::canonical)).to_host(), own,
                                   [](collide::contact<S>& c) -> collide::id& { return c.sphere; });
  wrong.expect(equal_bytes(parts.query(mine, collide::contacts<S>(order::canonical)).to_host(), contacts), "contacts");
  auto const check_each = [&](auto sink, auto const& numbers, char const* what) {
    auto const everywhere = whole.query(spheres, sink).to_host();
    auto const here = parts.query(mine, sink).to_host();
    std::size_t different = here.size() != own.size;
    for (std::size_t i = 0; i < here.size(); ++i) {
      auto const& other = everywhere[own.first + i];
      different += here[i].triangle != other.triangle || numbers(here[i]) != numbers(other);
    }
    wrong.expect(different == 0, what);
  };
  auto const check_rows = [&](auto const& here, auto const& everywhere, auto const& sphere_of, char const* what) {
    std::remove_const_t<std::remove_reference_t<decltype(here)>> expected(
        everywhere.begin() + static_cast<std::ptrdiff_t>(own.first),
        everywhere.begin() + static_cast<std::ptrdiff_t>(own.first + own.size));
    for (auto& entry : expected)
      if (sphere_of(entry) != collide::no_id) sphere_of(entry) -= static_cast<collide::id>(own.first);
    wrong.expect(equal_bytes(here, expected), what);
  };
  if constexpr (moves) {
    auto const impacts = of_spheres(whole.query(spheres, collide::impacts<S>(order::canonical)).to_host(), own,
                                    [](collide::impact<S>& i) -> collide::id& { return i.contact.sphere; });
    wrong.expect(equal_bytes(parts.query(mine, collide::impacts<S>(order::canonical)).to_host(), impacts), "impacts");
    check_each(
        collide::earliest<S>(), [](auto const& e) { return e.time; }, "first impacts");
    auto const first = whole.query(spheres, collide::earliest_impact<S>()).to_host();
    auto const here = parts.query(mine, collide::earliest_impact<S>()).to_host();
    check_rows(
        here, first, [](collide::impact<S>& i) -> collide::id& { return i.contact.sphere; }, "earliest_impact");
  } else {
    check_each(
        collide::closest<S>(), [](auto const& e) { return e.distance; }, "closest");
    auto const first = whole.query(spheres, collide::closest_contact<S>()).to_host();
    auto const here = parts.query(mine, collide::closest_contact<S>()).to_host();
    check_rows(
        here, first, [](collide::contact<S>& c) -> collide::id& { return c.sphere; }, "closest_contact");
  }
}

/// Spheres at rest and spheres that move.
template <class S, class Ranks>
void check_both(Ranks const& ranks, moving_scene<S> const& made, layout const& lies, complaints& wrong) {
  using rest = collide::detector<collide::bucket, collide::karabassi<>, collide::host, S>;
  using swept = collide::detector<collide::bucket, collide::karabassi_swept<>, collide::host, S>;
  check_sinks<rest>(ranks, made, made.spheres(), lies, wrong);
  check_sinks<swept>(ranks, made, made.moving(), lies, wrong);
}

template <class S>
void append_triangle(moving_scene<S>& to, std::initializer_list<S> corners) {
  to.corners.insert(to.corners.end(), corners);
}
template <class S>
void append_sphere(moving_scene<S>& to, S x, S y, S z, S radius, S dx = 0, S dy = 0, S dz = 0) {
  to.centres.insert(to.centres.end(), {x, y, z});
  to.radii.push_back(radius);
  to.displacements.insert(to.displacements.end(), {dx, dy, dz});
}

/// A scene with everything that is awkward.
template <class S>
moving_scene<S> hard_scene() {
  constexpr S nan = std::numeric_limits<S>::quiet_NaN(), far = std::numeric_limits<S>::infinity(),
              huge = std::numeric_limits<S>::max();
  motion m;
  m.triangles = 90;
  m.spheres = 40;
  moving_scene<S> made = random_motion<S>(5, m);
  append_triangle<S>(made, {-12, -12, 0, 12, -12, 0, 0, 12, 0});  // in very many cells
  append_triangle<S>(made, {nan, 0, 0, 1, 0, 0, 0, 1, 0});
  append_triangle<S>(made, {far, 0, 0, 1, 0, 0, 0, 1, 0});
  append_triangle<S>(made, {3, 3, 3, 3, 3, 3, 3, 3, 3});  // a point
  for (int i = 0; i < 30; ++i) append_triangle<S>(made, {5, 5, 5, S(5.01), 5, 5, 5, S(5.01), 5});
  append_sphere<S>(made, 0, 0, 0, far);  // touches all that is finite
  append_sphere<S>(made, nan, 0, 0, 1);
  append_sphere<S>(made, 0, far, 0, 1);
  append_sphere<S>(made, 0, 0, 0, nan);
  append_sphere<S>(made, 0, 0, 0, -1);
  append_sphere<S>(made, 0, 0, 0, 0);
  append_sphere<S>(made, 0, 0, 4, 4);                // touches the plane in one point
  append_sphere<S>(made, 0, 0, 5, 4, 0, 0, -1);      // and at the end of the step
  append_sphere<S>(made, -100, 0, 0, 1, 200, 0, 0);  // through all ranks
  append_sphere<S>(made, 0, 0, 50, 1, 0, 0, far);
  append_sphere<S>(made, huge, 0, 0, 1);
  append_sphere<S>(made, 0, 0, 0, 1e6f);
  append_sphere<S>(made, 5, 5, 5, 0.25f);
  return made;
}

/// A scene far apart: two clusters, and a frame that overflows.
template <class S>
moving_scene<S> scene_of_huge_numbers() {
  constexpr S huge = std::numeric_limits<S>::max() / 2;
  moving_scene<S> made;
  append_triangle<S>(made, {-huge, 0, 0, -huge, 1, 0, -huge, 0, 1});
  append_triangle<S>(made, {huge, 0, 0, huge, 1, 0, huge, 0, 1});
  append_triangle<S>(made, {0, 0, 0, 1, 0, 0, 0, 1, 0});
  append_sphere<S>(made, 0, 0, 0, 1);
  append_sphere<S>(made, huge, 0, 0, 1);
  append_sphere<S>(made, -huge, 0, 0, 1, 1, 0, 0);
  return made;
}

/// Everything about queries that is checked on each number of ranks.
template <class Ranks>
void check_queries(Ranks const& ranks, complaints& wrong) {
  motion m;
  m.triangles = 200;
  m.spheres = 150;
  m.spread = 8;
  auto const random = random_motion<float>(3, m);
  std::string const n = std::to_string(ranks.size()) + " ranks, ";
  layout const layouts[] = {{split::evenly, split::evenly}, {split::first, split::last}, {split::odd, split::odd}};
  for (auto const& lies : layouts) {
    wrong.in(n + "split " + std::to_string(int(lies.mesh)));
    check_both(ranks, random, lies, wrong);
  }
  wrong.in(n + "seven spheres at a time");
  check_both(ranks, random, {split::evenly, split::odd, true, 7}, wrong);
  wrong.in(n + "the mesh on every rank");
  check_both(ranks, random, {split::evenly, split::odd, false}, wrong);
  wrong.in(n + "hard cases, floats");
  check_both(ranks, hard_scene<float>(), {}, wrong);
  wrong.in(n + "hard cases, doubles");
  check_both(ranks, hard_scene<double>(), {split::last, split::evenly, true, 10}, wrong);
  wrong.in(n + "huge numbers");
  check_both(ranks, scene_of_huge_numbers<float>(), {}, wrong);
  check_both(ranks, scene_of_huge_numbers<double>(), {}, wrong);
  wrong.in(n + "one radius, far from the origin");
  m.one_radius = true;
  m.offset = 1e4;
  check_both(ranks, random_motion<float>(4, m), {}, wrong);
  wrong.in(n + "no triangles");
  m.triangles = 0;
  check_both(ranks, random_motion<float>(4, m), {}, wrong);
  wrong.in(n + "nothing at all");
  check_both(ranks, moving_scene<float>(), {}, wrong);
}

/// Memory of which there is some for `left` allocations.
class short_memory final : public std::pmr::memory_resource {
 public:
  std::size_t left = std::numeric_limits<std::size_t>::max();

 private:
  void* do_allocate(std::size_t n, std::size_t alignment) override {
    if (left == 0) throw std::bad_alloc();
    --left;
    return std::pmr::new_delete_resource()->allocate(n, alignment);
  }
  void do_deallocate(void* p, std::size_t n, std::size_t alignment) override {
    std::pmr::new_delete_resource()->deallocate(p, n, alignment);
  }
  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }
};

/// Memory ends on the last rank, wherever it may: all ranks throw, and afterwards everything can be used again.
template <class Ranks>
void check_short_memory(Ranks const& ranks, complaints& wrong) {
  using detector = collide::detector<collide::bucket>;
  motion m;
  m.size = 3;
  m.triangles = 60;
  m.spheres = 50;
  auto const made = random_motion<float>(6, m);
  range const triangles = part_of(made.mesh().size(), split::evenly, ranks.rank(), ranks.size());
  range const own = part_of(made.radii.size(), split::evenly, ranks.rank(), ranks.size());
  int const failing = ranks.size() - 1;
  std::uint64_t failures = 0, all = 0;
  for (std::size_t most = 0;; ++most) {
    short_memory memory;
    if (ranks.rank() == failing) memory.left = most;
    collide::distributed<detector, Ranks> parts(ranks, collide::host(1, &memory));
    std::uint64_t total = 0;
    auto const work = [&] {
      parts.build(collide::triangle_soup(made.corners.data() + 9 * triangles.first, triangles.size), collide::divided);
      total = parts.total(parts.query(made.spheres().subview(own.first, own.size), collide::contacts<float>()));
    };
    std::string said = "nothing";
    try {
      work();
    } catch (std::bad_alloc const&) {
      said = "mine";
    } catch (collide::rank_error const& e) {
      said = e.what();
    }
    bool const failed = said != "nothing";
    std::string const others = "collide: rank " + std::to_string(failing) + " of ";
    wrong.expect(!failed || (ranks.rank() == failing ? said == "mine" : said.rfind(others, 0) == 0), "it said " + said);
    memory.left = std::numeric_limits<std::size_t>::max();
    if (failed) {
      ++failures;
      work();
    }
    if (most == 0) all = total;
    wrong.expect(total == all && total > 0, "after a failure everything works again");
    if (!failed) break;
  }
  wrong.expect(failures > 5, "memory can end in several places");
}

}  // namespace tests
