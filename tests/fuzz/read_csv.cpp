/// Any text as a CSV file of spheres: it is read or refused, what is read makes sense, and reads the same once written.
#include "examples/io/csv.hpp"
#include "text.hpp"

namespace {

using fuzz::require;

template <class S>
void check(io::sphere_data<S> const& spheres) {
  require(spheres.xyz.size() % 3 == 0, "three coordinates a sphere");
  require(spheres.radii.size() == (spheres.has_radii ? spheres.size() : 0), "a radius for each, or none at all");
  require(spheres.tally.numbers == spheres.xyz.size() + spheres.radii.size(), "the tally is of all numbers");
  require(fuzz::all_finite(spheres.xyz) && fuzz::all_finite(spheres.radii), "numbers are finite");
  for (S const r : spheres.radii) require(r >= 0, "no radius is below 0");

  std::string again = spheres.has_radii ? "r,x,y,z\n" : "x,y,z\n";
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    if (spheres.has_radii) again += fuzz::in_decimals(spheres.radii[i]) + ',';
    for (std::size_t k = 0; k < 3; ++k) again += fuzz::in_decimals(spheres.xyz[3 * i + k]) + (k < 2 ? ',' : '\n');
  }
  auto const same = io::read_csv<S>("again", again);
  require(same.xyz == spheres.xyz && same.radii == spheres.radii, "what is written reads the same");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  auto const text = fuzz::text(data, size);
  auto const floats = fuzz::read_or_refuse([&] { return io::read_csv<float>("input", text); });
  // (the radius -1e-46 is 0 as a float, and refused as a double)
  auto const doubles = fuzz::read_or_refuse([&] { return io::read_csv<double>("input", text); });
  if (floats) check(*floats);
  if (doubles) check(*doubles);
  if (!floats || !doubles) return 0;
  fuzz::check_rounding(floats->xyz, doubles->xyz, floats->tally);
  fuzz::check_rounding(floats->radii, doubles->radii, floats->tally);
  return 0;
}
