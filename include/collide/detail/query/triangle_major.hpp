/// \file
/// Buckets the other way round, for a CPU and many spheres: the spheres are sorted into the cells, and the triangles
/// look for them there.
///
/// The cells are those of detail/grid/grid.hpp, and a triangle looks into those that it would be entered into, so the
/// same pairs meet, each once. But nothing is entered: a bit per cell is all that is prepared. Most spheres are in
/// cells that no triangle touches, and are sorted out at the pace of the memory; the few others are copied in the order
/// of the cells. Neighbouring triangles, which most meshes have one after the other, then read the same spheres from
/// the nearest cache.
///
/// Spheres that move go the same way as the balls around their ways, which are spheres at rest; the narrow phase then
/// judges the spheres themselves. That is for short ways: the ball around a long one touches much that the sphere does
/// not.
#pragma once

#include <algorithm>
#include <cstring>

#include <collide/detail/execution/atomic.hpp>
#include <collide/detail/execution/launch.hpp>
#include <collide/detail/execution/multiversion.hpp>
#include <collide/detail/geometry/sphere_pack.hpp>
#include <collide/detail/grid/grid.hpp>
#include <collide/detail/query/candidate_batch.hpp>
#include <collide/detail/query/candidate_pipeline.hpp>
#include <collide/memory.hpp>

namespace collide::detail {

/// Bit k is flags[k], for k < n <= 64; flags are 0 or 1.
template <std::size_t n>
inline std::uint64_t bits_of_flags(unsigned char const* flags) {
  std::uint64_t mask = 0;
  for (std::size_t k = 0; k < n; k += 8) {
    std::uint64_t bytes;
    std::memcpy(&bytes, flags + k, sizeof bytes);
    mask |= (bytes * 0x0102040810204080u >> 56) << k;
  }
  return mask;
}

/// Kernel body of `for_each` over triangles: sets a bit for every cell that a triangle looks into.
template <class S>
struct mark_cells {
  triangle_box<S> const* boxes;
  grid<S> const* grids;
  int grid_count;
  std::uint32_t* occupied;

  void operator()(std::size_t i) const {
    for (int g = 0; g < grid_count; ++g) {
      grids[g].each_row(boxes[i], [&](std::uint32_t first, std::uint32_t n) {
        for (std::uint32_t const end = first + n; first < end;) {
          std::uint32_t const next = smaller((first / 32 + 1) * 32, end);
          std::uint32_t const bits = 0xffffffffu >> (32 - (next - first)) << first % 32;
          if ((load_relaxed(occupied + first / 32) & bits) != bits) fetch_or(occupied + first / 32, bits);
          first = next;
        }
      });
    }
  }
};

/// Kernel body of a block of one lane: the longest displacement, squared, and the farthest coordinate, as bits, of
/// which the larger are those of the larger number. What is NaN does not count, also where the compiler takes it that
/// there is none.
template <class S>
struct measure_ways {
  static constexpr int items = 4;
  static constexpr std::size_t batches = 64;  ///< of `Block::items` spheres

  moving_sphere_view<S> spheres;
  bits_of<S>* squared_length;  ///< 0 at first
  bits_of<S>* farthest;        ///< the same

  struct nothing {};
  template <class>
  using scratch = nothing;

  template <class Block>
  void operator()(Block& block, nothing&) const {
    constexpr std::size_t share = batches * Block::items;
    std::size_t const begin = block.index() * share, end = smaller(begin + share, spheres.size());
    bits_of<S> lengths[Block::items] = {}, fars[Block::items] = {};  // one would be compared one after the other
    vectorised([&] { measure(begin, end, lengths, fars); });
    for (int k = 1; k < Block::items; ++k) {
      lengths[0] = larger(lengths[0], lengths[k]);
      fars[0] = larger(fars[0], fars[k]);
    }
    fetch_max(squared_length, lengths[0]);
    fetch_max(farthest, fars[0]);
  }

 private:
  template <std::size_t n>
  void measure(std::size_t begin, std::size_t end, bits_of<S> (&lengths)[n], bits_of<S> (&fars)[n]) const {
    for (std::size_t first = begin; first < end; first += n) {
      moving_batch<S, n> batch;
      batch.load(spheres, first);
      for (std::size_t k = 0; k < n; ++k) {
        S const dx = batch.dx[k], dy = batch.dy[k], dz = batch.dz[k];
        lengths[k] = larger(lengths[k], magnitude_bits(dx * dx + (dy * dy + dz * dz)));
        bits_of<S> const xy = larger(magnitude_bits(batch.x[k]), magnitude_bits(batch.y[k]));
        fars[k] = larger(fars[k], larger(xy, magnitude_bits(batch.z[k])));
      }
    }
  }

  /// Bits of |x|; 0 if that is NaN.
  static bits_of<S> magnitude_bits(S x) {
    bits_of<S> const b = bits(x) & ~bits(-S(0));
    return b > bits(std::numeric_limits<S>::infinity()) ? 0 : b;
  }
};

/// Spheres that move as spheres at rest, all of one radius, that contain their ways: as far as placing them goes.
template <class S>
struct balls_around {
  moving_sphere_view<S> spheres;
  S reach;

  std::size_t size() const { return spheres.size(); }
  bool one_radius() const { return true; }
  S common_radius() const { return reach; }
};

/// The centres and radii of consecutive spheres.
template <class S, int Items>
void load(sphere_batch<S, Items>& batch, sphere_view<S> const& spheres, std::size_t first) {
  batch.load(spheres, first);
}

/// The same. A centre that is not finite is in no cell.
template <class S, int Items>
void load(sphere_batch<S, Items>& batch, balls_around<S> const& balls, std::size_t first) {
  moving_batch<S, Items> ways;
  ways.load(balls.spheres, first);
  for (int k = 0; k < Items; ++k) {
    batch.x[k] = ways.x[k] + S(0.5) * ways.dx[k];
    batch.y[k] = ways.y[k] + S(0.5) * ways.dy[k];
    batch.z[k] = ways.z[k] + S(0.5) * ways.dz[k];
    batch.radius[k] = balls.reach;
  }
}

/// A sphere in a cell with triangles.
template <class S>
struct placed_sphere {
  sphere<S> ball;  ///< a copy: in the order of the cells the caller's memory would be read all over the place
  id number;
  std::uint32_t cell;
};

/// Kernel body of a block of one lane: lists the spheres that are in cells with triangles. A sphere that no grid serves
/// counts as in the cell behind the last, into which all triangles look.
template <class S, class Spheres>
struct place_spheres {
  static constexpr int items = 4;
  static constexpr std::size_t batches = 16;  ///< of `Block::items` spheres

  Spheres spheres;
  grid<S> const* grids;
  int grid_count;
  std::uint32_t const* occupied;
  std::uint32_t everywhere;  ///< number of the cell behind the last
  placed_sphere<S>* to;
  std::uint64_t* total;  ///< counts also those that find no room
  std::uint64_t capacity;

  template <class Block>
  struct scratch {
    static constexpr std::size_t room = 16 * Block::items;
    placed_sphere<S> found[room];
    std::size_t count;
  };

  template <class Block>
  void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::lanes == 1 && Block::items == 64,
                  "collide: spheres are sorted by blocks of one lane with 64 items");
    vectorised([&] { place(block, s); });
  }

 private:
  template <class Block>
  void place(Block& block, scratch<Block>& s) const {
    constexpr int n = Block::items;
    std::size_t const begin = block.index() * batches * n;
    bool const one_radius = spheres.one_radius();
    s.count = 0;
    for (std::size_t first = begin; first < begin + batches * n && first < spheres.size(); first += n) {
      sphere_batch<S, n> batch;
      load(batch, spheres, first);
      auto const list = [&](int k, std::uint32_t cell, bool wanted) {
        s.found[s.count] = {
            {{batch.x[k], batch.y[k], batch.z[k]}, batch.radius[k]}, static_cast<id>(first) + static_cast<id>(k), cell};
        s.count += wanted;
      };
      // where all radii are equal, one comparison stands for all
      auto const of_radii = [&](auto const& holds) {
        if (!one_radius) return mask_of<n>([&](int k) { return holds(batch.radius[k]); });
        return holds(spheres.common_radius()) ? first_bits(spheres.size() - first) : 0;
      };
      std::uint64_t open = of_radii([](S r) { return valid_radius(r); });
      for (int g = grid_count - 1; g >= 0 && open != 0; --g) {  // by rising reach: a sphere ends up in the tightest
        grid<S> const& box = grids[g];
        std::uint64_t const served = open & of_radii([&](S r) { return r <= box.reach; });
        std::uint64_t const inside = served & mask_of<n>([&](int k) {
                                       return (batch.x[k] >= box.lower[0]) & (batch.x[k] <= box.upper[0]) &
                                              (batch.y[k] >= box.lower[1]) & (batch.y[k] <= box.upper[1]) &
                                              (batch.z[k] >= box.lower[2]) & (batch.z[k] <= box.upper[2]);
                                     });
        open &= ~served;
        for (int l = 0; l < box.levels && inside != 0; ++l) {
          make_room(s);
          for (std::uint64_t rest = inside; rest != 0; rest &= rest - 1) {
            int const k = __builtin_ctzll(rest);
            std::uint32_t const cell = box.cell_of(box.level[l], {batch.x[k], batch.y[k], batch.z[k]});
            list(k, cell, (occupied[cell / 32] >> cell % 32 & 1) != 0);
          }
        }
      }
      make_room(s);
      for (; open != 0; open &= open - 1) list(__builtin_ctzll(open), everywhere, true);
    }
    flush(s);
  }

  static std::uint64_t first_bits(std::size_t n) { return n < 64 ? (std::uint64_t{1} << n) - 1 : ~std::uint64_t{0}; }

  template <int n, class Holds>
  static std::uint64_t mask_of(Holds const& holds) {
    unsigned char flags[n];
    for (int k = 0; k < n; ++k) flags[k] = static_cast<unsigned char>(holds(k));
    return bits_of_flags<n>(flags);
  }

  template <class Scratch>
  void make_room(Scratch& s) const {
    if (s.count + 64 >= Scratch::room) flush(s);
  }

  template <class Scratch>
  void flush(Scratch& s) const {
    if (s.count == 0) return;
    std::uint64_t const slot = fetch_add(total, std::uint64_t{s.count});
    if (slot + s.count <= capacity) std::copy(s.found, s.found + s.count, to + slot);
    s.count = 0;
  }
};

/// Kernel body of `for_each` over placed spheres: counts those of each cell.
template <class S>
struct count_placed {
  placed_sphere<S> const* from;
  std::uint32_t* counts;
  void operator()(std::size_t i) const { fetch_add(counts + from[i].cell, 1u); }
};

/// Spheres in the order of the cells, number by number in arrays of their own.
template <class S>
struct sphere_columns {
  static constexpr std::size_t lanes = 8;  ///< how many are compared with a box at a time, also beyond the end

  S *x, *y, *z, *radius;
  S* reach;  ///< as `triangle_box` has it
  id* number;
  moving_sphere<S>* moving = nullptr;  ///< null if they rest; else the others are of the balls around their ways

  sphere<S> operator[](std::uint32_t i) const { return {{x[i], y[i], z[i]}, radius[i]}; }

  void set(std::size_t i, sphere<S> const& s, id n) const {
    x[i] = s.centre.x();
    y[i] = s.centre.y();
    z[i] = s.centre.z();
    radius[i] = s.radius;
    reach[i] = triangle_box<S>::reach(s.radius);
    number[i] = n;
  }

  /// Bit k is whether sphere first + k can reach what is in the box, for k < lanes. Without branches, for the
  /// processor's vector unit.
  std::uint32_t reaching(triangle_box<S> const& b, std::uint32_t first) const {
    bits_of<S> constexpr bit[lanes] = {1, 2, 4, 8, 16, 32, 64, 128};  // SSE cannot shift lanes by different amounts
    bits_of<S> mask = 0;
    for (std::size_t k = 0; k < lanes; ++k) {
      S const px = x[first + k], py = y[first + k], pz = z[first + k];
      S const gx = b.gap(0, px), gy = b.gap(1, py), gz = b.gap(2, pz), most = reach[first + k] + b.slack;
      mask |= gx * gx + (gy * gy + gz * gz) <= most * most ? bit[k] : bits_of<S>(0);
    }
    return static_cast<std::uint32_t>(mask);
  }
};

/// Kernel body of `for_each` over placed spheres: gives each its place in the order of the cells.
template <class S>
struct number_placed {
  placed_sphere<S> const* from;
  std::uint32_t* order;
  std::uint32_t* begins;
  void operator()(std::size_t i) const { order[fetch_add(begins + from[i].cell, 1u)] = static_cast<std::uint32_t>(i); }
};

/// Kernel body of `for_each` over places: brings the spheres there. Threads write next to themselves only.
template <class S, class Spheres>
struct sort_placed {
  placed_sphere<S> const* from;
  std::uint32_t const* order;
  sphere_columns<S> to;
  Spheres spheres;
  void operator()(std::size_t i) const {
    placed_sphere<S> const& p = from[order[i]];
    if constexpr (std::is_same<Spheres, balls_around<S>>::value) {
      moving_sphere<S> const s = spheres.spheres[p.number];
      to.moving[i] = s;
      to.set(i, enclosing(s), p.number);
    } else {
      to.set(i, p.ball, p.number);
    }
  }
};

/// Kernel body of a block of one lane: triangles look for spheres in the cells that they touch.
template <class S, class NarrowPhase, class Sink>
struct look_for_spheres {
  static constexpr int items = 4;

  tester<S, NarrowPhase, Sink> tests;
  triangle_box<S> const* boxes;
  grid<S> const* grids;
  int grid_count;
  sphere_columns<S> spheres;
  std::uint32_t const* ends;  ///< the spheres of cell c: ends[c] .. ends[c + 1]
  std::uint32_t everywhere;   ///< number of the cell behind the last

  /// Spheres `first` + k whose bit k is set, and a triangle whose box they reach.
  struct reached {
    std::uint32_t first, mask;
    id triangle;
  };

  template <class Block>
  struct scratch {
    static constexpr std::uint32_t room = 256;
    reached found[room];
    std::uint32_t count;
    candidate_batch<S> batch;
    hit_buffer<Block> hits;
  };

  template <class Block>
  void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::lanes == 1, "collide: triangles look for spheres in blocks of one lane");
    tests.begin(s.hits, 0);
    s.count = 0;
    s.batch.size = 0;
    vectorised([&] { look(block, s); });
    test(block, s);
    if constexpr (in_batches<NarrowPhase, S>) s.batch.decide(tests, block, s.hits);
    tests.flush(block, s.hits);
  }

 private:
  /// Finds the spheres near the triangles of a block.
  template <class Block>
  void look(Block& block, scratch<Block>& s) const {
    std::size_t const begin = block.index() * Block::items, end = smaller(begin + Block::items, tests.mesh.size());
    for (std::size_t t = begin; t < end; ++t) {
      triangle_box<S> const around = boxes[t];
      if (around.is_empty()) continue;  // not finite
      auto const look_into = [&](std::uint32_t cell, std::uint32_t n) {
        std::uint32_t const last = ends[cell + n];
        for (std::uint32_t i = ends[cell]; i < last; i += spheres.lanes) {
          std::uint32_t const here = spheres.reaching(around, i) & (0xffu >> (8 - smaller(last - i, 8u)));
          s.found[s.count] = {i, here, static_cast<id>(t)};
          s.count += here != 0;  // no branch: it would often be mispredicted
          if (s.count == s.room) test(block, s);
        }
      };
      for (int g = 0; g < grid_count; ++g) grids[g].each_row(around, look_into);
      look_into(everywhere, 1);
    }
  }

  /// Tests what was found.
  template <class Block>
  void test(Block& block, scratch<Block>& s) const {
    for (std::uint32_t i = 0; i < s.count; ++i) {
      reached const r = s.found[i];
      [[maybe_unused]] triangle<S> const t = tests.mesh[r.triangle];
      for (std::uint32_t rest = r.mask; rest != 0; rest &= rest - 1) {
        std::uint32_t const place = r.first + static_cast<std::uint32_t>(__builtin_ctz(rest));
        pair const p{spheres.number[place], r.triangle};
        if constexpr (in_batches<NarrowPhase, S>) {
          if (s.batch.size == s.batch.room) s.batch.decide(tests, block, s.hits);
          s.batch.add(p, t, sphere_of(place));
        } else {
          tests.test(block, s.hits, p, sphere_of(place));
          tests.make_room(block, s.hits);
        }
      }
    }
    s.count = 0;
  }

  /// What the narrow phase judges.
  decltype(auto) sphere_of(std::uint32_t place) const {
    if constexpr (at_rest<NarrowPhase, S>) {
      return spheres[place];
    } else {
      return static_cast<moving_sphere<S> const&>(spheres.moving[place]);
    }
  }
};

/// The spheres of a query in the order of the cells, and what triangles look for them with.
template <class S>
class sorted_spheres {
 public:
  /// The most spheres that can be sorted: places have 32 bits, and a sphere may be in a cell of each level.
  static constexpr std::size_t most = std::size_t{0xffffffffu} / max_levels - sphere_columns<S>::lanes;

  /// Marks the cells that triangles touch. To be called for new grids, the cells of each of which begin at a multiple
  /// of 2^table_bits.
  template <class Space>
  void mark(Space& space, triangle_box<S> const* boxes, std::size_t triangles, grid<S> const* grids, int grid_count,
            std::uint32_t table_bits) {
    boxes_ = boxes;
    grids_ = grids;
    grid_count_ = grid_count;
    auto const last = static_cast<std::size_t>(grid_count - 1);
    cells_ = (last << table_bits) + space.read(grids + last).cells;  // of many grids some cells are not in use
    std::size_t const words = cells_ / 32 + 1;
    std::uint32_t* const occupied = occupied_.reserve(space.resource(), words);
    space.fill(occupied, 0, words * sizeof *occupied);
    space.for_each(triangles, mark_cells<S>{boxes, grids, grid_count, occupied});
  }

  /// How far the grid must reach for spheres of one radius that move: the radius of a ball around the way of each.
  template <class Space>
  S reach_of(Space& space, moving_sphere_view<S> const& spheres) {
    auto* const found = measures_.reserve(space.resource(), 2);
    space.fill(found, 0, 2 * sizeof *found);
    measure_ways<S> const body{spheres, found, found + 1};
    constexpr std::size_t share = measure_ways<S>::batches * 64;
    space.launch((spheres.size() + share - 1) / share, body);
    S const length = root(from_bits<S>(space.read(found))), far = from_bits<S>(space.read(found + 1));
    // of none is it larger, but for some rounding
    return enclosing(moving_sphere<S>{{{far, far, far}, spheres.common_radius()}, {length, S(0), S(0)}}).radius *
           (1 + 32 * S(format<float>::unit));
  }

  /// Sorts the spheres into the cells: of type sphere_view, or balls_around. O(spheres + cells).
  template <class Space, class Spheres>
  void sort(Space& space, Spheres const& spheres) {
    using place = place_spheres<S, Spheres>;
    auto* const total = total_.reserve(space.resource(), 1);
    std::size_t room = larger(placed_.capacity(), spheres.size() / 16 + 1024);
    for (;; room = static_cast<std::size_t>(*total + *total / 4)) {
      auto* const placed = placed_.reserve(space.resource(), room);
      space.fill(total, 0, sizeof *total);
      place const body{spheres, grids_, grid_count_, occupied_.data(), everywhere(), placed, total, room};
      constexpr std::size_t share = place::batches * 64;
      space.launch((spheres.size() + share - 1) / share, body);
      if (*total <= room) break;
    }
    auto const n = static_cast<std::size_t>(*total);
    columns_ = columns(space, placed_.capacity());
    if constexpr (std::is_same<Spheres, balls_around<S>>::value) {
      columns_.moving = moving_.reserve(space.resource(), placed_.capacity());
    }
    // counts[c + 1] becomes the begin of cell c, and once it is filled its end, which is the begin of the next
    std::size_t const table = cells_ + 2;
    auto* const counts = ends_.reserve(space.resource(), table);
    space.fill(counts, 0, table * sizeof *counts);
    // counters all over a table: few are counted sooner than threads have passed them to each other
    auto const each_placed = [&](auto const& f) {
      if (n > (std::size_t{1} << 17)) return space.for_each(n, f);
      work_alone const alone(true);
      for (std::size_t i = 0; i < n; ++i) f(i);
    };
    each_placed(count_placed<S>{placed_.data(), counts + 1});
    space.exclusive_scan(counts + 1, table - 1, scratch_);
    auto* const order = order_.reserve(space.resource(), placed_.capacity());
    each_placed(number_placed<S>{placed_.data(), order, counts + 1});
    space.for_each(n, sort_placed<S, Spheres>{placed_.data(), order, columns_, spheres});
  }

  /// One pass: the triangles look for the spheres.
  template <class NarrowPhase, class Space, class Sink>
  void query(Space& space, tester<S, NarrowPhase, Sink> const& tests) const {
    look_for_spheres<S, NarrowPhase, Sink> const body{tests,    boxes_,       grids_,      grid_count_,
                                                      columns_, ends_.data(), everywhere()};
    space.launch(blocks_for<Space>(tests.mesh.size(), body), body);
  }

 private:
  template <class Space>
  sphere_columns<S> columns(Space& space, std::size_t n) {
    std::size_t const room = n + sphere_columns<S>::lanes;
    bool const same = numbers_.capacity() == 5 * room;
    S* const to = numbers_.reserve(space.resource(), 5 * room);
    id* const ids = ids_.reserve(space.resource(), room);
    if (!same) space.fill(to, 0, 5 * room * sizeof *to);  // also what is behind the end is read
    return {to, to + room, to + 2 * room, to + 3 * room, to + 4 * room, ids};
  }

  std::uint32_t everywhere() const { return static_cast<std::uint32_t>(cells_); }

  triangle_box<S> const* boxes_ = nullptr;
  grid<S> const* grids_ = nullptr;
  int grid_count_ = 0;
  std::size_t cells_ = 0;
  buffer<std::uint32_t> occupied_, ends_, order_;
  buffer<std::uint64_t> total_;
  buffer<bits_of<S>> measures_;
  buffer<moving_sphere<S>> moving_;
  buffer<placed_sphere<S>> placed_;
  buffer<S> numbers_;
  buffer<id> ids_;
  sphere_columns<S> columns_ = {};
  buffer<unsigned char> scratch_;
};

}  // namespace collide::detail
