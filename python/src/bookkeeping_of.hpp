/// \file
/// Energy, contact report and files of a list of effects, as Python asks for them.
#pragma once

#include <string>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/simulation.cuh>
#include <collide/simulation/checkpoint.hpp>
#include <collide/simulation/energy.hpp>

#include "simulation_base.hpp"

namespace collide_python {

template <class Space, class S, class NarrowPhase, class... Effect>
class bookkeeping_of final : public bookkeeping {
  using type = collide::simulation<collide::detector<collide::bucket, NarrowPhase, Space, S>, Effect...>;
  static type const& whole(void const* of) { return *static_cast<type const*>(of); }

 public:
  std::vector<double> energy(void const* of, double density) const override {
    collide::energy_sums const e = collide::energy(whole(of), density);
    return {e.kinetic, e.rotational, e.elastic, e.potential, e.tangential, e.damping, e.sliding, e.rolling, e.given};
  }
  std::vector<double> contact_report(void const* of) const override {
    collide::contact_counts const n = collide::contact_report(whole(of));
    return {static_cast<double>(n.contacts), n.coordination, static_cast<double>(n.deep), n.largest_overlap};
  }
  void save(void const* of, std::string const& path) const override { collide::save(whole(of), path); }
  void load(void* of, std::string const& path) const override { collide::load(*static_cast<type*>(of), path); }
};

}  // namespace collide_python

/// Exports it: the space, the scalar, the narrow phase, and the effects.
#define COLLIDE_PYTHON_BOOKKEEPING(...)                                                                  \
  extern "C" __attribute__((visibility("default"))) collide_python::bookkeeping* collide_bookkeeping() { \
    return new collide_python::bookkeeping_of<__VA_ARGS__>();                                            \
  }
