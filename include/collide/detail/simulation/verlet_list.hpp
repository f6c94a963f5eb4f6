/// \file
/// Which particles overlap each other: lists of neighbours, which are kept while nothing has moved far.
///
/// A list has what is within reach of a particle or a little farther away: by the skin, of which each of two particles
/// may cross a half before something can be missing (L. Verlet, "Computer experiments on classical fluids I", Physical
/// Review 159(1), 1967). Until then a step only copies the particles' columns in the order of the last grid, and tries
/// what is listed. It is found out on the device whether that is so: kernels that renew the lists end at once if not.
/// The few that come, or move far, are strays: they make a list of their own, and those near them add them to theirs.
/// Where strays have become too many, all lists are made anew. What is no longer there is left out.
///
/// Lists are made from a grid of the particles. Cells are as wide as the largest particle with the skin. They lie in a
/// table of fixed size: blocks of 16 x 2 x 2 cells are spread over it by a hash function, so that any scene fits, and
/// near cells are near in memory. Particles are counted into the cells, each block takes as much of the order as it has
/// particles, and each particle looks into the 27 cells around it, and through the strays. What has too many neighbours
/// for its list does so in each step.
///
/// Distances must be such that their squares neither overflow nor vanish: with floats, radii from 1e-17 to 1e18.
///
/// Neighbours meet in the order of their numbers: so sums over them do not depend on which thread was first, nor on
/// when the lists were made.
#pragma once

#include <collide/detail/execution/atomic.hpp>
#include <collide/detail/numeric/float_bits.hpp>
#include <collide/detail/numeric/rounding.hpp>
#include <collide/detail/simulation/attribute_buffers.hpp>
#include <collide/detail/simulation/effect_list.hpp>

namespace collide::detail {

/// The cells of a table.
template <class S>
struct particle_cells {
  S inverse_width;
  std::uint32_t mask;  ///< number of blocks - 1

  static constexpr std::uint32_t per_block = 64;
  static constexpr std::uint32_t stride = per_block + 1;  ///< of blocks in the table: see `particle_order`

  struct cell {
    std::int32_t x, y, z;
  };

  COLLIDE_HD_INLINE cell of(S x, S y, S z) const { return {coordinate(x), coordinate(y), coordinate(z)}; }

  /// Place of a cell in the table.
  COLLIDE_HD_INLINE std::uint32_t number(cell c) const {
    auto const u = [](std::int32_t v) { return static_cast<std::uint32_t>(v); };
    std::uint32_t const block = u(c.x >> 4) * 73856093u ^ u(c.y >> 1) * 19349663u ^ u(c.z >> 1) * 83492791u;
    std::uint32_t const mixed = (block ^ block >> 15) * 0x2c1b3c6du;
    return ((mixed ^ mixed >> 13) & mask) * stride + ((u(c.z) & 1) << 5 | (u(c.y) & 1) << 4 | (u(c.x) & 15));
  }

 private:
  /// Rounded down; NaN and what is too far away are somewhere.
  COLLIDE_HD_INLINE std::int32_t coordinate(S x) const {
    constexpr S end = S(1 << 30);
    S const c = smaller(end, larger(-end, mul(x, inverse_width)));
    auto const i = static_cast<std::int32_t>(c);
    return static_cast<S>(i) > c ? i - 1 : i;
  }
};

/// What decides whether two particles overlap, to be read at once.
template <class S>
struct alignas(4 * sizeof(S)) near_sphere {
  S x, y, z, radius;
};

/// Where a particle was when the lists were made, and how large, if that may change.
template <class S, bool HasRadius>
struct reference {
  S x, y, z;
  COLLIDE_HD_INLINE void set(near_sphere<S> const& s) { x = s.x, y = s.y, z = s.z; }
  COLLIDE_HD_INLINE S resized(near_sphere<S> const&) const { return S(0); }
};
template <class S>
struct reference<S, true> : near_sphere<S> {
  COLLIDE_HD_INLINE void set(near_sphere<S> const& s) { static_cast<near_sphere<S>&>(*this) = s; }
  /// By how much it has grown, or shrunk: what strayed meanwhile is near it only as far as it reached then.
  COLLIDE_HD_INLINE S resized(near_sphere<S> const& s) const {
    return larger(s.radius - this->radius, this->radius - s.radius);
  }
};

/// What all particles in the order have in common.
struct order_header {
  static constexpr std::uint32_t most_strays = 128;

  std::uint32_t renew;                ///< not 0: the lists are to be made anew
  std::uint32_t crowded;              ///< not 0: some particles have more neighbours than lists have room for
  std::uint32_t before, now;          ///< how many particles were in the order after the last step, and are now
  std::uint32_t arrivals;             ///< not 0: there are strays of this step
  std::uint32_t seen, count;          ///< strays of earlier steps, and with those of this one
  std::uint32_t strays[most_strays];  ///< places of what came or moved far since the grid was made, once for each time
};

/// The particles in the order of the grid, with all that they must know of each other.
template <class S, class Scene>
struct particle_order {
  using all = typename Scene::all;
  using copied = typename Scene::meeting_copies;
  using meeting = particle<S, typename Scene::meeting>;
  using cell = typename particle_cells<S>::cell;
  static constexpr bool comes_and_goes = contains<all, present>;

  particle_cells<S> cells;
  std::uint32_t* ends;  ///< of the cell at place c: ends[c] .. ends[c + 1]; the first of a block begins where it does
  order_header* header;
  id* numbers;
  near_sphere<S>* spheres;                          ///< as they are in this step
  reference<S, contains<all, radius>>* references;  ///< as they were when they came to the order, or strayed
  column_element<present, S>* known;                ///< whether particles are in the order, by numbers
  particle_state<S, copied> copies;

  static constexpr std::uint32_t listed = 16;  ///< the most neighbours that a list has
  static constexpr std::uint32_t too_many = 0xffffffffu;
  std::uint32_t* lists;  ///< places, in the order of numbers; the particle's own behind the last; or too_many
  std::size_t capacity;  ///< of each of `listed` arrays

  /// How many strays are listed alone. Of few particles fewer: it takes longer to look at many than to make few lists.
  COLLIDE_HD_INLINE std::uint32_t stray_room() const {
    return static_cast<std::uint32_t>(smaller(capacity / 16 + 8, std::size_t{order_header::most_strays}));
  }

  COLLIDE_HD_INLINE std::uint32_t& list(std::uint32_t k, std::size_t i) const { return lists[k * capacity + i]; }

  COLLIDE_HD_INLINE near_sphere<S> store(std::size_t i, meeting const& p) const {
    vec3<S> const& c = p[position{}];
    copies.store(p, i, copied{});
    return spheres[i] = {c.x(), c.y(), c.z(), p.the_radius};
  }

  COLLIDE_HD_INLINE meeting load(std::size_t i) const {
    meeting p;
    p.number = numbers[i];
    near_sphere<S> const s = spheres[i];
    p[position{}] = vec3<S>(s.x, s.y, s.z);
    p.the_radius = s.radius;
    if constexpr (contains<typename Scene::meeting, radius>) p[radius{}] = s.radius;
    copies.load(p, i, copied{});
    return p;
  }

  /// True if the surfaces of two particles are less than `skin` apart.
  static COLLIDE_HD_INLINE bool are_near(near_sphere<S> const& a, near_sphere<S> const& b, S skin) {
    vec3<S> const between(a.x - b.x, a.y - b.y, a.z - b.z);
    S const reach = a.radius + b.radius + skin;
    return dot(between, between) < mul(reach, reach);
  }

  /// Puts a particle that is not there, or nowhere, so far away, and makes it so small, that it is near nothing, not
  /// even its like. When it is back it has moved far: lists of what came meanwhile do not have it.
  COLLIDE_HD_INLINE void leave_out(std::size_t i) const {
    constexpr S far = std::numeric_limits<S>::max();  // squares of distances overflow
    references[i].set(spheres[i] = {far, far, far, S(0)});
  }

  /// Lists a particle as one that the grid does not have where it is.
  COLLIDE_HD_INLINE void stray(std::uint32_t i, near_sphere<S> const& now) const {
    references[i].set(now);
    if (load_relaxed(&header->renew) != 0) return;  // where all have moved, they need not all ask for their turn
    std::uint32_t const n = fetch_add(&header->count, 1u);
    if (n < stray_room()) {
      header->strays[n] = i;
      store_relaxed(&header->arrivals, 1u);
    } else {
      store_relaxed(&header->renew, 1u);
    }
  }

  /// f(place, row) for those less than `skin` away from particle i, of which `is_in_row` must still be asked. That
  /// takes a while, in which threads that run together would wait for the one that has found something. Strays may come
  /// more than once.
  template <class F>
  COLLIDE_HD_INLINE void each_near(std::uint32_t i, S skin, F const& f) const {
    near_sphere<S> const self = spheres[i];
    cell const here = cell_of(i);
    COLLIDE_ROLLED
    for (int row = 0; row < 9; ++row) {
      cell const from = first_of(here, row);
      std::int32_t const together = smaller(3, 16 - (from.x & 15));  // those in the same block follow each other
      std::uint32_t const first = cells.number(from);
      std::uint32_t const begin = ends[first], size = ends[first + static_cast<std::uint32_t>(together)] - begin;
      std::uint32_t jump = 0, both = size;
      if (together < 3) {
        std::uint32_t const rest = cells.number({from.x + together, from.y, from.z});
        jump = ends[rest];
        both += ends[rest + static_cast<std::uint32_t>(3 - together)] - jump;
        jump -= size;
      }
      COLLIDE_ROLLED
      for (std::uint32_t n = 0; n < both; ++n) {
        std::uint32_t const k = n + (n < size ? begin : jump);
        if (are_near(self, spheres[k], skin) && k != i) f(k, row);
      }
    }
    each_stray_near(i, 0, skin, [&](std::uint32_t k) { f(k, no_row); });
  }

  /// f(place) for the strays from number `first` on that are less than `skin` away from particle i.
  template <class F>
  COLLIDE_HD_INLINE void each_stray_near(std::uint32_t i, std::uint32_t first, S skin, F const& f) const {
    constexpr std::uint32_t together = 4;  // are on their way at the same time
    near_sphere<S> const self = spheres[i];
    std::uint32_t const end = header->count;
    COLLIDE_ROLLED
    for (std::uint32_t n = first; n < end; n += together) {
      std::uint32_t places[together];
      near_sphere<S> others[together];
      for (std::uint32_t k = 0; k < together; ++k) places[k] = header->strays[smaller(n + k, end - 1)];
      for (std::uint32_t k = 0; k < together; ++k) others[k] = spheres[places[k]];
      for (std::uint32_t k = 0; k < together; ++k) {
        if (n + k < end && are_near(self, others[k], skin) && places[k] != i) f(places[k]);
      }
    }
  }

  /// True if particle i is one of the strays from number `first` on; all are looked at, without a branch.
  COLLIDE_HD_INLINE bool has_strayed(std::uint32_t i, std::uint32_t first) const {
    std::uint32_t const end = header->count;
    std::uint32_t found = 0;
    for (std::uint32_t n = first; n < end; ++n) found |= header->strays[n] == i ? 1u : 0u;
    return found != 0;
  }

  /// True if particle k is in a row of cells around particle i, and not in others at the same place of the table.
  COLLIDE_HD_INLINE bool is_in_row(std::uint32_t k, std::uint32_t i, int row) const {
    if (row == no_row) return true;
    cell const from = first_of(cell_of(i), row), there = cell_of(k);
    return there.y == from.y && there.z == from.z && there.x >= from.x && there.x <= from.x + 2;
  }

 private:
  static constexpr int no_row = 9;

  /// The first of three cells along x next to a cell.
  static COLLIDE_HD_INLINE cell first_of(cell here, int row) {
    return {here.x - 1, here.y + row % 3 - 1, here.z + row / 3 - 1};
  }

  COLLIDE_HD_INLINE cell cell_of(std::uint32_t i) const {
    auto const& from = references[i];
    return cells.of(from.x, from.y, from.z);
  }
};

/// The first of neighbours in the order of their numbers.
template <std::uint32_t Room>
struct first_neighbours {
  id numbers[Room];
  std::uint32_t places[Room];
  std::uint32_t size = 0;
  bool complete = true;

  /// Once each, also if it is added again.
  COLLIDE_HD_INLINE void add(id number, std::uint32_t place) {
    if (size == Room && number > numbers[Room - 1]) {
      complete = false;
      return;
    }
    std::uint32_t at = size;
    COLLIDE_ROLLED
    while (at > 0 && numbers[at - 1] > number) --at;
    if (at > 0 && numbers[at - 1] == number) return;
    if (size == Room) {
      complete = false;
      --size;
    }
    COLLIDE_ROLLED
    for (std::uint32_t k = size++; k > at; --k) {
      numbers[k] = numbers[k - 1];
      places[k] = places[k - 1];
    }
    numbers[at] = number;
    places[at] = place;
  }
};

/// Kernel body of `for_each` over particles, and places in the order: copies what particles must know of each other,
/// and finds out whether the lists still have all of them.
template <class S, class Scene>
struct refresh_order {
  particle_state<S, typename Scene::all> state;
  particle_order<S, Scene> order;
  S most;  ///< that a particle may have moved

  using ordered = particle_order<S, Scene>;

  COLLIDE_HD void operator()(std::size_t i) const {
    if constexpr (ordered::comes_and_goes) {
      if (is_there(i) && order.known[i] == 0) come(i);
    }
    if (i >= order.header->before) return;
    id const number = order.numbers[i];
    if constexpr (ordered::comes_and_goes) {
      if (!is_there(number)) return order.leave_out(i);
    }
    typename ordered::meeting p;
    state.load(p, number);
    if (!finite(p[position{}])) return order.leave_out(i);
    near_sphere<S> const now = order.store(i, p);
    auto const before = order.references[i];
    vec3<S> const way(now.x - before.x, now.y - before.y, now.z - before.z);
    S const left = most - before.resized(now);
    bool const stayed = dot(way, way) < mul(left, left) && left > 0;
    if (!stayed) order.stray(static_cast<std::uint32_t>(i), now);
  }

 private:
  COLLIDE_HD_INLINE bool is_there(std::size_t number) const { return state.at(present{})[number] != 0; }

  COLLIDE_HD_INLINE void come(std::size_t number) const {
    typename ordered::meeting p;
    state.load(p, number);
    std::uint32_t const place = fetch_add(&order.header->now, 1u);
    order.known[number] = 1;
    order.numbers[place] = p.number;
    order.stray(place, order.store(place, p));
  }
};

/// Kernel body of `for_each_if` over the table: empties it.
template <class S, class Scene>
struct empty_cells {
  particle_order<S, Scene> order;

  COLLIDE_HD void operator()(std::size_t i) const {
    order.ends[i] = 0;
    if (i != 0) return;
    auto& h = *order.header;
    h.crowded = h.now = h.arrivals = h.seen = h.count = 0;
  }
};

/// Kernel body of `for_each_if` over particles: counts them into cells, or, once blocks have their share of the order,
/// fills in their numbers.
template <class S, class Scene, bool Fill>
struct sort_into_cells {
  particle_state<S, typename Scene::all> state;
  particle_order<S, Scene> order;

  COLLIDE_HD void operator()(std::size_t i) const {
    using placing = joined_t<columns<position>, common_t<columns<present>, typename Scene::all>>;
    particle<S, placing> p;
    state.load(p, i);
    if constexpr (contains<placing, present>) {
      if constexpr (Fill) order.known[i] = p[present{}];
      if (p[present{}] == 0) return;
    }
    vec3<S> const& c = p[position{}];
    std::uint32_t const slot = fetch_add(order.ends + order.cells.number(order.cells.of(c.x(), c.y(), c.z())) + 1, 1u);
    if constexpr (Fill) order.numbers[slot] = static_cast<id>(i);
  }
};

/// Kernel body of `for_each_if` over blocks: counts become where cells begin.
template <class S, class Scene>
struct allocate_cells {
  particle_order<S, Scene> order;

  COLLIDE_HD void operator()(std::size_t b) const {
    constexpr std::uint32_t n = particle_cells<S>::per_block;
    std::uint32_t* const ends = order.ends + b * order.cells.stride;
    std::uint32_t counts[n], sum = 0;  // all are on their way at once
    for (std::uint32_t c = 0; c < n; ++c) counts[c] = ends[c + 1];
    for (std::uint32_t c = 0; c < n; ++c) sum += counts[c];
    if (sum == 0) return;
    std::uint32_t next = fetch_add(&order.header->now, sum);
    ends[0] = next;
    for (std::uint32_t c = 0; c < n; ++c) {
      ends[c + 1] = next;
      next += counts[c];
    }
  }
};

/// Kernel body of `for_each_if` over places in the order: copies particles there.
template <class S, class Scene>
struct copy_in_order {
  particle_state<S, typename Scene::all> state;
  particle_order<S, Scene> order;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (i >= order.header->now) return;
    typename particle_order<S, Scene>::meeting p;
    state.load(p, order.numbers[i]);
    order.references[i].set(order.store(i, p));
  }
};

/// Kernel body of `for_each_if` over places in the order: lists what is near.
template <class S, class Scene>
struct list_neighbours {
  particle_order<S, Scene> order;
  S skin;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (i < order.header->now) list(static_cast<std::uint32_t>(i));
  }

 protected:
  static constexpr std::uint32_t room = particle_order<S, Scene>::listed;

  COLLIDE_HD_INLINE void list(std::uint32_t i) const {
    std::uint32_t places[room], found = 0;
    std::uint8_t rows[room];
    order.each_near(i, skin, [&](std::uint32_t k, int row) {
      if (found < room) {
        places[found] = k;
        rows[found] = static_cast<std::uint8_t>(row);
      }
      ++found;
    });
    if (found > room) return crowd(i);
    first_neighbours<room> near;
    COLLIDE_ROLLED
    for (std::uint32_t n = 0; n < found; ++n) {
      if (order.is_in_row(places[n], i, rows[n])) near.add(order.numbers[places[n]], places[n]);
    }
    COLLIDE_ROLLED
    for (std::uint32_t n = 0; n < near.size; ++n) order.list(n, i) = near.places[n];
    if (near.size < room) order.list(near.size, i) = i;
  }

  COLLIDE_HD_INLINE void crowd(std::uint32_t i) const {
    order.list(0, i) = order.too_many;
    store_relaxed(&order.header->crowded, 1u);
  }
};

/// Kernel body of `for_each_if` over places in the order, where a few have come or moved far: these make a list, and
/// the others near them put them into theirs. `skin` is larger by half of the skin, which others may have moved
/// already.
template <class S, class Scene>
struct admit_strays : list_neighbours<S, Scene> {
  COLLIDE_HD void operator()(std::size_t place) const {
    auto const& order = this->order;
    std::uint32_t const first = order.header->seen;
    if (place >= order.header->now) return;
    auto const i = static_cast<std::uint32_t>(place);
    if (order.has_strayed(i, first)) return this->list(i);
    order.each_stray_near(i, first, this->skin, [&](std::uint32_t stray) { insert(i, stray); });
  }

 private:
  COLLIDE_HD_INLINE void insert(std::uint32_t i, std::uint32_t stray) const {
    auto const& order = this->order;
    std::uint32_t at = 0, size = 0;
    for (; size < this->room && order.list(size, i) != i; ++size) {
      std::uint32_t const other = order.list(size, i);
      if (other == stray || other == order.too_many) return;
      if (order.numbers[other] < order.numbers[stray]) at = size + 1;
    }
    if (size == this->room) return this->crowd(i);
    if (size + 1 < this->room) order.list(size + 1, i) = i;
    for (std::uint32_t n = size; n > at; --n) order.list(n, i) = order.list(n - 1, i);
    order.list(at, i) = stray;
  }
};

/// What happens where particles meet.
template <class S, class Scene>
struct meetings {
  particle_state<S, typename Scene::all> state;
  particle_order<S, Scene> order;
  Scene scene;
  S dt;

 protected:
  using meeting = typename particle_order<S, Scene>::meeting;

  /// A particle before and after.
  struct participant {
    meeting self, changed;
    bool met = false;
    COLLIDE_HD_INLINE explicit participant(meeting const& p) : self(p), changed(p) {}
  };

  COLLIDE_HD_INLINE void meet(participant& p, std::uint32_t place) const {
    meeting other = order.load(place);
    if (!is_skipped(p.self)) {
      scene.meet(p.changed, p.self, other, dt);
    } else if (!is_skipped(other)) {
      scene.disturb(p.changed, other);
    } else {
      return;
    }
    p.met = true;
  }

  COLLIDE_HD_INLINE void store(participant const& p) const {
    if (p.met) state.store(p.changed, p.self.number, typename Scene::meeting_writes{});
  }

 private:
  COLLIDE_HD_INLINE bool is_skipped(meeting& p) const {
    if constexpr (Scene::skips) {
      return scene.is_skipped(p);
    } else {
      return false;
    }
  }
};

/// Kernel body of `for_each` over places in the order: a particle meets those on its list that overlap it.
template <class S, class Scene>
struct meet_neighbours : meetings<S, Scene> {
  COLLIDE_HD void operator()(std::size_t i) const {
    auto const& order = this->order;
    if (i == 0) settle(*order.header);
    if (i >= order.header->now) return;
    auto const self = static_cast<std::uint32_t>(i);
    std::uint32_t ahead = order.list(0, i);
    if (ahead == order.too_many) return;
    typename meetings<S, Scene>::participant p(order.load(i));
    near_sphere<S> const own = order.spheres[i];
    // while one is met, the next and the entry behind it are on their way
    auto const entry = [&](std::uint32_t n) {
      return ahead != self && n < particle_order<S, Scene>::listed ? order.list(n, i) : self;
    };
    near_sphere<S> close = order.spheres[ahead];
    std::uint32_t behind = entry(1);
    COLLIDE_ROLLED
    for (std::uint32_t n = 2; ahead != self; ++n) {
      std::uint32_t const place = ahead;
      near_sphere<S> const other = close;
      ahead = behind;
      close = order.spheres[ahead];
      behind = entry(n);
      if (order.are_near(own, other, S(0))) this->meet(p, place);
    }
    this->store(p);
  }

 private:
  /// The header for the next step; what is written here is not read until then.
  static COLLIDE_HD_INLINE void settle(order_header& h) {
    h.renew = h.arrivals = 0;
    h.before = h.now;
    h.seen = h.count;
  }
};

/// Kernel body of `for_each_if` over places in the order: the same for particles with more neighbours than lists have
/// room for. As many as can be held at a time are found, by rising numbers.
template <class S, class Scene>
struct meet_crowds : meetings<S, Scene> {
  COLLIDE_HD void operator()(std::size_t i) const {
    auto const& order = this->order;
    if (i >= order.header->now || order.list(0, i) != order.too_many) return;
    auto const self = static_cast<std::uint32_t>(i);
    typename meetings<S, Scene>::participant p(order.load(i));
    id last = 0;
    for (bool first = true, complete = false; !complete; first = false) {
      first_neighbours<16> near;
      order.each_near(self, S(0), [&](std::uint32_t k, int row) {
        id const number = order.numbers[k];
        if ((first || number > last) && order.is_in_row(k, self, row)) near.add(number, k);
      });
      COLLIDE_ROLLED
      for (std::uint32_t k = 0; k < near.size; ++k) this->meet(p, near.places[k]);
      complete = near.complete;
      if (!complete) last = near.numbers[near.size - 1];
    }
    this->store(p);
  }
};

/// The lists, the grid and their memory.
template <class S, class Scene>
class neighbours {
 public:
  /// Takes all memory that steps need, for `n` particles of radius up to `radius`.
  template <class Space>
  void reserve(Space& space, std::size_t n, S radius) {
    std::uint32_t bits = 0;
    while (bits < 22 && (std::size_t{cells::per_block} << bits) < 2 * n) ++bits;
    blocks_ = std::size_t{1} << bits;
    skin_ = skin_of_diameter * 2 * radius;
    // a bit wider than what is listed: so rounding separates no pair by more than a cell, in floats up to 2^15 cells
    // away from the origin
    S const width = larger((2 * radius + skin_) * (1 + S(0.00390625)), std::numeric_limits<S>::min());
    cells_ = {1 / width, static_cast<std::uint32_t>(blocks_ - 1)};
    auto* const resource = space.resource();
    order_header* const header = header_.reserve(resource, 1);
    space.fill(header, 0, sizeof *header);
    space.fill(&header->renew, 1, sizeof header->renew);  // there are no lists yet
    ends_.reserve(resource, blocks_ * cells::stride);
    numbers_.reserve(resource, n);
    memory_.reserve(resource, n);
    spheres_.reserve(resource, n);
    references_.reserve(resource, n);
    if constexpr (order::comes_and_goes) space.fill(known_.reserve(resource, n), 0, n * sizeof(*known_.data()));
    lists_.reserve(resource, order::listed * n);
  }

  /// One pass of `meet` over all pairs.
  template <class Space>
  void meet(Space& space, particle_state<S, typename Scene::all> const& state, Scene const& scene, S dt) {
    order const o{cells_,          ends_.data(),
                  header_.data(),  numbers_.data(),
                  spheres_.data(), references_.data(),
                  known_.data(),   memory_.state(state.size, state.placed, state.common_radius),
                  lists_.data(),   state.size};
    std::size_t const n = state.size;
    std::uint32_t const *const renew = &o.header->renew, *const arrivals = &o.header->arrivals,
                               *const crowded = &o.header->crowded;
    // half of the skin, but for rounding
    space.for_each(n, refresh_order<S, Scene>{state, o, S(0.495) * skin_});
    space.for_each_if(renew, blocks_ * cells::stride, empty_cells<S, Scene>{o});
    space.for_each_if(renew, n, sort_into_cells<S, Scene, false>{state, o});
    space.for_each_if(renew, blocks_, allocate_cells<S, Scene>{o});
    space.for_each_if(renew, n, sort_into_cells<S, Scene, true>{state, o});
    space.for_each_if(renew, n, copy_in_order<S, Scene>{state, o});
    space.for_each_if(renew, n, list_neighbours<S, Scene>{o, skin_});
    space.for_each_if(arrivals, n, admit_strays<S, Scene>{{o, S(1.5) * skin_}});
    space.for_each(n, meet_neighbours<S, Scene>{{state, o, scene, dt}});
    space.for_each_if(crowded, n, meet_crowds<S, Scene>{{state, o, scene, dt}});
  }

 private:
  using order = particle_order<S, Scene>;
  using cells = particle_cells<S>;

  static constexpr S skin_of_diameter = S(0.1);

  cells cells_{};
  S skin_{};
  std::size_t blocks_ = 0;
  buffer<order_header> header_;
  buffer<std::uint32_t> ends_, lists_;
  buffer<id> numbers_;
  buffer<near_sphere<S>> spheres_;
  buffer<reference<S, contains<typename Scene::all, radius>>> references_;
  buffer<column_element<present, S>> known_;
  column_buffers<S, typename Scene::meeting_copies> memory_;
};

}  // namespace collide::detail
