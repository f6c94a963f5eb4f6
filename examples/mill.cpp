/// \file
/// A mill as an input deck of LIGGGHTS describes it (docs/granular.md): mill DRUM.stl FOLDER. The drum is in
/// millimetres, its axis is y. It prints the torque of its motor, and writes a film and a checkpoint.
#include <cstdio>
#include <string>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/io/stl.hpp>
#include <collide/io/vtk_simulation.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/checkpoint.hpp>
#include <collide/simulation/energy.hpp>
#include <collide/simulation/fill.hpp>

using namespace collide;

using law = granular_contact<hertz, mindlin, epsd, none, materials<2>>;
using mill = simulation<detector<bucket, karabassi<>, host, double>, polydisperse, gravity, law, reaction,
                        moving_bodies<>, velocity_verlet>;

int main(int argc, char** argv) try {
  if (argc != 3) return 2;
  std::string const folder = std::string(argv[2]) + "/";

  materials<2> solids;               // 0: ore, softened; 1: steel
  solids.set(0, {5e6, 0.25, 2700});  // Young's modulus, Poisson's ratio, density: SI
  solids.set(1, {200e9, 0.3, 7800});
  solids.set_pair(0, 0, {0.4, 0.6, 0.1, 0});  // restitution, friction, rolling friction, cohesion
  solids.set_pair(0, 1, {0.5, 0.4, 0.05, 0});
  solids.set_pair(1, 1, {0.7, 0.2, 0.01, 0});
  solids.wall_material = 1;

  auto drum = read_stl<double>(argv[1]);
  for (double& x : drum.vertices) x *= 1e-3;  // mm to m
  body turning{0, drum.size(), {}};
  turning.motion.axis[1] = 1, turning.motion.axis[2] = 0;
  turning.motion.rate = 40 * 2 * 3.14159265358979 / 60;  // 40 revolutions a minute

  host const cpu;
  reaction_sums sums(cpu, 1, 1e-15);  // of one body, in units of 1e-15 N s
  mill scene(cpu, polydisperse{}, gravity{0, 0, -9.81}, law{solids}, sums.effect(2700), moving_bodies<>{},
             velocity_verlet{});
  scene.set_mesh(drum.view(), {turning});

  auto const sizes = size_distribution::uniform(0.004, 0.006);
  auto const grains = fill_number(cylinder_region({0, -0.024, 0}, {0, 0.024, 0}, 0.075), sizes, 500);
  scene.set(spheres_xyz(grains.centres.data(), grains.radii.size(), grains.radii.data()));

  double const dt = largest_time_step(scene);
  auto const steps_in = [&](double seconds) { return static_cast<std::size_t>(seconds / dt); };
  scene.steps(steps_in(1), dt);  // until the grains flow evenly
  sums.clear(cpu);
  double const begin = scene.time();
  std::vector<vtk_frame> frames;
  for (int i = 0; i < 10; ++i) {
    scene.steps(steps_in(0.1), dt);
    std::string const name = "grains" + std::to_string(i) + ".vtp";
    write_vtk_particles(folder + name, scene);
    frames.push_back({name, scene.time()});
  }
  write_vtk_film(folder + "mill.pvd", frames);
  save(scene, folder + "mill.checkpoint");
  contact_report(scene).require_shallow();
  double const torque = -sums.read(cpu)[0].angular[1] / (scene.time() - begin);
  std::printf("%zu grains, steps of %.1e s, torque %.3f N m\n", scene.size(), dt, torque);
} catch (error const& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
