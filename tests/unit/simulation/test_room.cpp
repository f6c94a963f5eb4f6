/// Room that grains take, and that grows where they need more.
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <collide/bucket.cuh>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/checkpoint.hpp>

#include "execution/lockstep.hpp"

namespace {

using namespace collide;
using law = granular_contact<hertz, mindlin>;
template <class Space>
using grains = simulation<detector<bucket, karabassi<>, Space, double>, gravity, law, velocity_verlet>;

/// Memory as a GPU's: the host must not look into it.
struct afar : host {
  using host::host;
  static constexpr bool host_accessible = false;
  std::size_t saturating_blocks() const { return 4; }
};

template <class Space>
grains<Space> made_in(Space const& space, double down) {
  law by;
  by.made_of = one_material({1e7, 0.3, 2500}, {0.5, 0.5});
  return grains<Space>(space, gravity{0, 0, -down}, by, velocity_verlet{});
}

/// Two triangles at a height, and centres of `side` x `side` x `layers` spheres of radius 1 mm above 0.
std::vector<double> plate(double width, double z) {
  return {0, 0, z, width, 0, z, width, width, z, 0, 0, z, width, width, z, 0, width, z};
}
std::vector<double> lattice(int side, int layers, double spacing) {
  std::vector<double> centres;
  for (int z = 0; z < layers; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        centres.insert(centres.end(), {spacing * (x + 0.5), spacing * (y + 0.5), spacing * (z + 0.5)});
  return centres;
}

/// Bytes a grain of a packed bed on a floor, after some steps.
template <class Space>
double bytes_of_bed(Space const& space) {
  constexpr int side = 32;
  auto const centres = lattice(side, side, 0.0019985);
  auto const floor = plate(0.07, 0);
  auto bed = made_in(space, 9.81);
  bed.set_mesh(triangle_soup(floor.data(), 2));
  bed.set(spheres_xyz(centres.data(), side * side * side, 0.001));
  bed.steps(20, 1e-6);
  return double(bed.bytes()) / (side * side * side);
}

/// Layers of grains that are thrown from a floor to a ceiling and back: all are at a wall at a time.
template <class Space>
std::string thrown(Space const& space) {
  constexpr int side = 20;
  auto const centres = lattice(side, 1, 0.00199);
  auto corners = plate(0.04, 0);
  auto const ceiling = plate(0.04, 0.0024);
  corners.insert(corners.end(), ceiling.begin(), ceiling.end());
  std::vector<double> velocities;
  for (int i = 0; i < side * side; ++i)
    velocities.insert(velocities.end(), {0, 0.01 * (i % 3), i % 2 == 0 ? 2.0 : 0.5});
  auto made = made_in(space, 9.81);
  made.set_mesh(triangle_soup(corners.data(), 4));
  made.set(spheres_xyz(centres.data(), centres.size() / 3, 0.001), velocities.data());
  std::string all;
  for (int part = 0; part < 4; ++part) {
    made.steps(60, 5e-6);
    std::stringstream file(std::ios::in | std::ios::out | std::ios::binary);
    save(made, file);
    all += file.str();
    if (part % 2 == 0) load(made, file);
  }
  return all;
}

}  // namespace

TEST_CASE("room: a packed bed takes at most 700 bytes a grain on the host") { CHECK(bytes_of_bed(host(1)) < 700); }

TEST_CASE("room: a grain takes at most 1,300 bytes on a GPU") {
  auto bed = made_in(afar(1), 9.81);
  bed.reserve(1000000);
  CHECK(bed.bytes() < 1300 * 1000000.0);
}

TEST_CASE("room: as many grains as there are may come to walls") {
  std::string const expected = thrown(tests::lockstep<64, true>());
  for (int threads : {1, 3}) CHECK(thrown(host(threads)) == expected);
}

TEST_CASE("room: arrays take turns in as much memory as the larger of two phases takes") {
  detail::room_in_turn room;
  auto* const resource = std::pmr::get_default_resource();
  std::uint8_t* bytes = nullptr;
  double *numbers = nullptr, *more = nullptr;
  room.give(resource, detail::in_room(bytes, 3), detail::in_room(numbers, 1000));
  CHECK(room.bytes() == 256 + 8192);
  CHECK(reinterpret_cast<std::byte*>(numbers) == reinterpret_cast<std::byte*>(bytes) + 256);
  room.give(resource, detail::in_room(more, 10));
  CHECK(room.bytes() == 256 + 8192);
  CHECK(reinterpret_cast<std::byte*>(more) == reinterpret_cast<std::byte*>(bytes));
  CHECK(room.all(resource, 10000) != nullptr);
  CHECK(room.bytes() == 10000);
}
