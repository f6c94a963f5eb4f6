/// Memory of a simulation, and the time it has run; instantiated by test_simulation.cpp and
/// test_simulation_cuda.cpp.
#pragma once

#include <initializer_list>

#include <collide/effects/emit.hpp>
#include <collide/effects/sleep.hpp>
#include <collide/effects/sphere_contact.hpp>

#include "simulation/simulation.hpp"

namespace tests {

/// `bytes` is what a simulation without a mesh has taken, also once there is room for more; `make(resource)` is a
/// space. Then particles are set that there is room for, and nothing is allocated.
template <class Simulation, class MakeSpace>
void check_room(MakeSpace make, std::pmr::memory_resource* upstream) {
  io::counting_resource counting(upstream);
  auto const space = make(&counting);
  world<float> w;
  w.radius = 0.5f;
  for (int i = 0; i < 5000; ++i) w.particle(i, 0, 0);
  placed<float> const centres(space, w.centres);
  std::size_t const others = counting.in_use;
  Simulation simulation(space);
  simulation.set_mesh({});
  CHECK(simulation.bytes() == 0);
  auto const set = [&](std::size_t n) {
    simulation.set(collide::spheres_xyz(centres.data(), n, 0.5f));
    CHECK(simulation.bytes() == counting.in_use - others);
    simulation.step(1e-3f);
  };
  set(100);
  simulation.reserve(5000);
  CHECK(simulation.size() == 0);
  CHECK_THROWS_AS(simulation.step(1e-3f), collide::error);  // before set
  std::size_t const bytes = counting.in_use - others, calls = counting.allocations;
  CHECK(simulation.bytes() == bytes);
  CHECK(bytes >= 5000 * Simulation::bytes_per_particle);
  for (auto const n : std::initializer_list<std::size_t>{10, 5000, 0, 3000, 5000}) set(n);
  CHECK(counting.allocations == calls);
  CHECK(simulation.bytes() == bytes);
  CHECK_THROWS_AS(simulation.reserve(0xffffffff), collide::error);
}

/// Columns take what docs/simulation.md says, and so do lists of neighbours.
template <class MakeSpace>
void check_bytes(MakeSpace make, std::pmr::memory_resource* upstream) {
  using detector = meets_mesh<std::decay_t<decltype(make(upstream))>>;
  using collide::gravity, collide::bounce, collide::sphere_contact;
  check_room<collide::simulation<detector>>(make, upstream);
  check_room<collide::simulation<detector, gravity, bounce>>(make, upstream);
  check_room<collide::simulation<detector, gravity, bounce, sphere_contact, collide::sleep>>(make, upstream);
  check_room<collide::simulation<detector, collide::emit, sphere_contact, collide::polydisperse>>(make, upstream);

  constexpr std::size_t n = 1 << 20;
  auto const space = make(upstream);
  collide::simulation<detector, sphere_contact> spheres(space);
  spheres.reserve(n);
  CHECK(spheres.bytes_per_particle == 24);
  double const lists = double(spheres.bytes()) / n - 24;
  CHECK(lists >= 108 + 8);
  CHECK(lists <= 108 + 17);
}

/// Time is the sum of the steps since particles were set.
template <class Space>
void check_time(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space>, collide::gravity>;
  world<float> w;
  w.particle(0, 0, 0);
  running<simulation> made(space, w, collide::gravity{});
  CHECK(made.simulation.time() == 0);
  made.simulation.steps(3, 0.25f);
  made.simulation.step(0.5f);
  CHECK(made.simulation.time() == 1.25);
  made.place(w);
  CHECK(made.simulation.time() == 0);
}

}  // namespace tests
