/// \file
/// Kernel bodies in which particles that overlap each other meet.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/detail/simulation/first_neighbours.hpp>
#include <collide/detail/simulation/particle_order.hpp>

namespace collide::detail {

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
    if (i == 0) order.header->renew = 0;  // not read again in this step
    if (i >= order.header->count) return;
    auto const self = static_cast<std::uint32_t>(i);
    if (order.list(0, i) == order.too_many) return;
    typename meetings<S, Scene>::participant p(order.load(i));
    COLLIDE_ROLLED
    for (std::uint32_t n = 0; n < particle_order<S, Scene>::listed; ++n) {
      std::uint32_t const place = order.list(n, i);
      if (place == self) break;
      if (order.are_near(order.spheres[i], order.spheres[place], S(0))) this->meet(p, place);
    }
    this->store(p);
  }
};

/// Kernel body of `for_each_if` over places in the order: particles with more neighbours than lists have room for meet
/// those that overlap them. As many as can be held at a time are found, by rising numbers.
template <class S, class Scene>
struct meet_crowds : meetings<S, Scene> {
  COLLIDE_HD void operator()(std::size_t i) const {
    auto const& order = this->order;
    if (i >= order.header->count || order.list(0, i) != order.too_many) return;
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

}  // namespace collide::detail
