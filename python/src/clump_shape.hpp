/// \file
/// Shapes of clumps, for Python.
#pragma once

#include <vector>

#include <collide/simulation/place_clumps.hpp>

#include "calls.hpp"

namespace collide_python {

/// Of spheres, x, y, z, r each: the volume, three moments of inertia, the quaternion of the frame of the principal
/// axes, the spheres in it, and last the centre of mass.
inline std::vector<double> shape_of_clump(std::vector<double> const& numbers) {
  call_under_way const now;
  without_gil const others_run;
  std::vector<collide::sphere<double>> spheres;
  for (std::size_t i = 0; i < numbers.size(); i += 4)
    spheres.push_back({{numbers[i], numbers[i + 1], numbers[i + 2]}, numbers[i + 3]});
  auto const shape = collide::shape_of_clump(spheres);
  std::vector<double> found{shape.volume};
  found.insert(found.end(), shape.inertia, shape.inertia + 3);
  found.insert(found.end(), shape.frame.rotation, shape.frame.rotation + 4);
  for (auto const& s : shape.spheres) found.insert(found.end(), {s.centre[0], s.centre[1], s.centre[2], s.radius});
  found.insert(found.end(), shape.frame.position, shape.frame.position + 3);
  return found;
}

/// Quaternions of `count` rotations at random.
inline std::vector<double> random_rotations(std::size_t count, std::uint64_t seed) {
  std::vector<double> found;
  for (std::size_t i = 0; i < count; ++i) {
    double q[4];
    collide::turn_at_random(q, (seed << 20) + i);
    found.insert(found.end(), q, q + 4);
  }
  return found;
}

}  // namespace collide_python
