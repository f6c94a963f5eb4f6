/// \file
/// Parts of the mesh that move: a belt that carries a grain, and a table that turns.
#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/friction.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/simulation.cuh>

using namespace collide;

int main() {
  std::vector<float> corners;  // metres; each body lies where it is at time 0
  auto const add_plate = [&](float left, float right, float z) {
    float const plate[] = {left, -1, z, right, -1, z, right, 1, z, left, -1, z, right, 1, z, left, 1, z};
    corners.insert(corners.end(), plate, plate + 18);
  };
  add_plate(-1, 3, 0);    // two triangles of a belt
  add_plate(5, 9, -0.5);  // and two of a turntable
  simulation<detector<bucket>, gravity, bounce, friction, moving_bodies<>> scene(host(), gravity{}, bounce{0.2},
                                                                                 friction{0.5, 0.4}, moving_bodies<>{});
  body belt{0, 2, {}}, table{2, 2, {}};
  belt.motion.belt[0] = 1.5;  // metres a second: the surface moves, the belt stays where it is
  table.motion.pivot[0] = 7;
  table.motion.rate = 0.5;  // radians a second, around motion.axis through motion.pivot: z, if not set
  scene.set_mesh(triangle_soup(corners.data(), corners.size() / 9), {belt, table});
  float const grain[] = {0, 0, 0.05f};
  scene.set(spheres_xyz(grain, 1, 0.05f));
  scene.steps(1000, 1e-3f);
  std::printf("after 1 s the grain moves with %.2f m/s\n", scene.to_host<velocity>()[0]);
  scene.steps(500, 1e-3f);
  std::printf("the table has turned by %.2f rad\n", scene.time() * table.motion.rate);
}
