/// \file
/// Uniaxial compression: grains of many sizes in a box with smooth walls, under a lid that a servo holds at rising
/// stresses. Prints strain, solid fraction, coordination number, and the stress of the walls over that of the lid, from
/// the fields inside of the bed; and last the distribution of normal forces.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/fill.hpp>
#include <collide/simulation/stress.hpp>

using namespace collide;

/// Holds the lid at a force: its speed is proportional to how much the force is off.
struct servo {
  double damping;     ///< force per speed: above the stiffness of the bed times dt
  double most_speed;  ///< the lid is never faster
  double at = 0;      ///< height above where it began
  double speed = 0;

  void step(double force, double wanted, double dt) {
    speed = std::clamp((force - wanted) / damping, -most_speed, most_speed);
    at += speed * dt;
  }
};

int main() {
  constexpr double side = 0.06, lid = 0.07, high = 0.09;
  double const area = side * side;
  double const corners[] = {0, 0, lid,  side, 0, lid,  side, side, lid,  0, side, lid,  // the lid, then the box
                            0, 0, 0,    side, 0, 0,    side, side, 0,    0, side, 0,
                            0, 0, high, side, 0, high, side, side, high, 0, side, high};
  unsigned const triangles[] = {0, 1, 2,  0, 2,  3, 4, 5, 6,  4, 6,  7,  4, 5, 9, 4, 9, 8,
                                5, 6, 10, 5, 10, 9, 6, 7, 11, 6, 11, 10, 7, 4, 8, 7, 8, 11};
  materials<2> made_of;
  made_of.set(0, {5e6, 0.25, 2500});
  made_of.set(1, {5e6, 0.25, 2500});
  made_of.set_pair(0, 0, {0.3, 0.4, 0.05});
  made_of.set_pair(0, 1, {0.3, 0});  // smooth walls
  made_of.set_pair(1, 1, {});
  made_of.wall_material = 1;
  auto const grains = fill(box_region{{0, 0, 0}, {side, side, lid}}, size_distribution::uniform(0.004, 0.006), 0.46, 1);

  host const cpu;
  reaction_sums sums(cpu, 1, 1e-15);
  using law = granular_contact<hertz, mindlin, epsd, none, materials<2>>;
  simulation<detector<bucket, karabassi<>, host, double>, gravity, polydisperse, law, reaction, moving_bodies<driven>,
             velocity_verlet>
      bed(cpu, gravity{}, polydisperse{}, law{made_of}, sums.effect(2500), moving_bodies<driven>{}, velocity_verlet{});
  bed.set_mesh(indexed_mesh(corners, 12, triangles, 12), {body{0, 2, {}}});
  bed.set(spheres_xyz(grains.centres.data(), grains.radii.size(), grains.radii.data()));

  double const dt = largest_time_step(bed) / 4;  // grains under load shake with longer steps
  servo hand{60, 0.1};
  double first = 0;
  bool holds = true;
  for (double const wanted : {2e3, 5e3, 1e4}) {  // Pa
    double sum = 0;
    int const steps = static_cast<int>(0.2 / dt), last = steps / 5;
    for (int k = 0; k < steps; ++k) {
      sums.clear(cpu);
      bed.step(dt);
      double const force = sums.read(cpu)[0].linear[2] / dt;
      hand.step(force, wanted * area, dt);
      body_state& state = bed.bodies().states()[0];
      state.at.position[2] = hand.at;
      state.moving.linear[2] = hand.speed;
      if (k >= steps - last) sum += force / last;
    }
    double const height = lid + hand.at;
    if (first == 0) first = height;
    auto const f = stress(bed, {0, 0, 0.2 * height}, {side, side, 0.8 * height});
    double const vertical = f.contact_stress[2][2];
    std::printf("lid %6.0f Pa: strain %.4f, fraction %.3f, coordination %.2f, stress inside %6.0f Pa, K0 %.3f\n",
                sum / area, 1 - height / first, f.solid_fraction, f.coordination, vertical,
                (f.contact_stress[0][0] + f.contact_stress[1][1]) / (2 * vertical));
    holds = holds && std::abs(sum / area / wanted - 1) < 0.02 && vertical > wanted && vertical < 1.2 * wanted + 1000;
  }

  auto const forces = normal_forces(bed);
  double mean = 0;
  for (double const f : forces) mean += f / static_cast<double>(forces.size());
  double density[8] = {};  // of probability, in bins of half the mean
  for (double const f : forces)
    density[std::clamp(static_cast<int>(2 * f / mean), 0, 7)] += 2.0 / double(forces.size());
  std::printf("%zu normal forces of %.3f N in the mean, in bins of half of it:", forces.size(), mean);
  for (double const p : density) std::printf(" %.3f", p);
  std::printf("\n");
  return holds ? 0 : 1;
}
