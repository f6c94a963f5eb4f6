/// \file
/// A tumbling mill: ore and steel spheres in a drum with lifters, whose walls come from an STL file in millimetres.
/// Prints torque and power in each quarter of a turn, and writes the wear of the walls for ParaView.
///
/// Usage: mill_power [STL [RPM [FILLING [VTP]]]]: a closed mesh around the y axis; turns a minute; the volume of
/// grains over that of the drum; the file with pressure and sliding work of each triangle. Without arguments it makes a
/// drum.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/effects/wear.hpp>
#include <collide/io/stl.hpp>
#include <collide/io/vtk.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/fill.hpp>

using namespace collide;

namespace {

constexpr double pi = 3.14159265358979323846;

/// Writes a drum of 150 mm radius and 80 mm length with eight lifters of 15 mm, in text.
void write_drum(std::string const& path) {
  std::vector<double> x, z;
  for (int i = 0; i < 48; ++i) {
    double const r = i % 6 == 0 ? 135 : 150, angle = 2 * pi * i / 48;
    x.push_back(r * std::sin(angle)), z.push_back(r * std::cos(angle));
  }
  std::ofstream out(path);
  out.precision(9);
  out << "solid drum\n";
  auto const triangle = [&](std::vector<double> const& corners) {
    out << "facet normal 0 0 0\nouter loop\n";
    for (std::size_t k = 0; k < 9; k += 3)
      out << "vertex " << corners[k] << " " << corners[k + 1] << " " << corners[k + 2] << "\n";
    out << "endloop\nendfacet\n";
  };
  for (std::size_t i = 0; i < x.size(); ++i) {
    std::size_t const k = (i + 1) % x.size();
    triangle({x[i], -40, z[i], x[k], -40, z[k], x[k], 40, z[k]});
    triangle({x[i], -40, z[i], x[k], 40, z[k], x[i], 40, z[i]});
    triangle({0, 40, 0, x[i], 40, z[i], x[k], 40, z[k]});
    triangle({0, -40, 0, x[k], -40, z[k], x[i], -40, z[i]});
  }
  out << "endsolid drum\n";
}

}  // namespace

int main(int argc, char** argv) {
  std::string const path = argc > 1 ? argv[1] : "mill_power_drum.stl";
  double const rpm = argc > 2 ? std::atof(argv[2]) : 60, filling = argc > 3 ? std::atof(argv[3]) : 0.15;
  if (argc < 2) write_drum(path);
  mesh_data<double> walls = read_stl<double>(path);
  for (double& x : walls.vertices) x /= 1000;  // metres
  if (argc < 2) std::remove(path.c_str());

  enum { ore, steel };
  materials<2> made_of;
  made_of.set(ore, {5e6, 0.25, 2700});  // softer than they are, so that steps are longer
  made_of.set(steel, {5e6, 0.3, 7800});
  made_of.set_pair(ore, ore, {0.4, 0.5, 0.05});
  made_of.set_pair(ore, steel, {0.5, 0.4, 0.03});
  made_of.set_pair(steel, steel, {0.6, 0.3, 0.01});
  made_of.wall_material = steel;

  auto const sizes = size_distribution::sieve({0.012, 0.016, 0.024}, {0, 0.6, 1});  // diameters; parts by mass
  auto const grains = fill(mesh_region(walls.view()), sizes, filling, 1);
  std::vector<std::uint8_t> solids;
  for (double const r : grains.radii) solids.push_back(r > 0.009 ? steel : ore);

  host const cpu;
  body_motion turning;
  turning.axis[0] = turning.axis[2] = 0;
  turning.axis[1] = 1;
  turning.rate = rpm * 2 * pi / 60;
  reaction_sums forces(cpu, 1, 1e-12);
  wear_sums worn(cpu, walls.size(), 1e-12, 1e-12);
  using law = granular_contact<hertz, mindlin, epsd, none, materials<2>>;
  simulation<detector<bucket, karabassi<>, host, double>, gravity, polydisperse, law, wear<materials<2>>,
             reaction_of<materials<2>>, moving_bodies<>, velocity_verlet>
      mill(cpu, gravity{}, polydisperse{}, law{made_of}, worn.effect(made_of), forces.effect(made_of),
           moving_bodies<>{}, velocity_verlet{});
  mill.set_mesh(walls.view(), {body{0, walls.size(), turning}});
  mill.set(spheres_xyz(grains.centres.data(), grains.radii.size(), grains.radii.data()));
  mill.assign<material>(solids);

  double const dt = largest_time_step(mill), quarter = 60 / rpm / 4;
  auto const steps = static_cast<std::size_t>(quarter / dt);
  std::printf("%zu grains, a fraction of %.3f; dt %.3g s\n", grains.radii.size(), grains.fraction, dt);
  double torque = 0;
  for (int k = 1; k <= 4; ++k) {
    forces.clear(cpu);
    worn.clear(cpu);
    mill.steps(steps, dt);
    torque = -forces.read(cpu)[0].angular[1] / (static_cast<double>(steps) * dt);  // of the motor
    std::printf("%.2f turns: torque %.3f N m, power %.2f W\n", k / 4.0, torque, torque * turning.rate);
  }
  if (argc > 4) {
    auto const loads = worn.read(cpu);
    std::vector<double> pressure, work;
    for (std::size_t t = 0; t < walls.size(); ++t) {
      auto const of = walls.view()[t];
      double const area = (of.b - of.a).cross(of.c - of.a).norm() / 2;
      pressure.push_back(loads[t].normal_impulse / (area * static_cast<double>(steps) * dt));
      work.push_back(loads[t].sliding_work / area);  // per area; times K / (friction hardness) the depth of wear
    }
    write_vtk_mesh(argv[4], walls.view(), {{"pressure", pressure}, {"sliding_work", work}});
  }
  return torque > 0 ? 0 : 1;
}
