/// \file
/// A bed of 3,000 clumps of three spheres, and one of 9,000 free spheres: clump_bed [STEPS]. Both settle; prints the
/// time of a processor for a step, the least of three times STEPS (200), and writes the first bed to bed.data for
/// lammps_clumps.in, which goes on from there. Built by hand: g++ -std=c++17 -O3 -DNDEBUG -ffp-contract=off -fopenmp
/// -Iinclude.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/clumps.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/energy.hpp>
#include <collide/simulation/fill.hpp>
#include <collide/simulation/place_clumps.hpp>

using namespace collide;
using law = granular_contact<hertz, mindlin>;
template <class... Effect>
using scene = simulation<detector<bucket, karabassi<>, host, double>, gravity, law, velocity_verlet, Effect...>;

constexpr double r = 0.001, wide = 0.03, high = 0.2;

template <class Scene>
void measure(Scene& bed, char const* of, std::size_t steps, double dt) {
  auto const now = [] { return double(std::clock()) / CLOCKS_PER_SEC; };
  double least = 1e9;
  for (int k = 0; k < 3; ++k) {
    double const begin = now();
    bed.steps(steps, dt);
    least = std::min(least, (now() - begin) / double(steps));
  }
  std::printf("%s: %.2f ms a step, %.1f million sphere-steps a second, %.2f contacts a sphere\n", of, 1e3 * least,
              1e-6 * double(bed.size()) / least, contact_report(bed).coordination);
}

template <class Scene>
void settle(Scene& bed, double dt) {
  bed.template effect<gravity>().z = -50;
  bed.steps(8000, dt);
  bed.template effect<gravity>().z = -9.81;
  bed.steps(2000, dt);
}

void write(std::vector<double> const& x) {
  std::FILE* const f = std::fopen("bed.data", "w");
  std::size_t const n = x.size() / 3;
  std::fprintf(f, "bed\n\n%zu atoms\n1 atom types\n0 %g xlo xhi\n0 %g ylo yhi\n-0.001 %g zlo zhi\n\n", n, wide, wide,
               high);
  std::fprintf(f, "Atoms # sphere\n\n");
  for (std::size_t i = 0; i < n; ++i)
    std::fprintf(f, "%zu 1 %g 2500 %.12g %.12g %.12g\n", i + 1, 2 * r, x[3 * i], x[3 * i + 1], x[3 * i + 2]);
  std::fprintf(f, "\nMolecules\n\n");
  for (std::size_t i = 0; i < n; ++i) std::fprintf(f, "%zu %zu\n", i + 1, i / 3 + 1);
  std::fclose(f);
}

int main(int argc, char** argv) {
  std::size_t const steps = argc > 1 ? std::size_t(std::atoi(argv[1])) : 200;
  double const w = wide, h = high;
  double const corners[] = {0, 0, 0, w, 0, 0, w, w, 0, 0, w, 0, 0, 0, h, w, 0, h, w, w, h, 0, w, h};
  unsigned const triangles[] = {0, 1, 2, 0, 2, 3, 0, 1, 5, 0, 5, 4, 1, 2, 6,
                                1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
  auto const walls = indexed_mesh(corners, 8, triangles, 10);
  box_region const box{{0, 0, 0}, {wide, wide, high}};
  law const by{one_material({1e7, 0.3, 2500}, {0.5, 0.5})};
  host const cpu(1);

  auto const shape = shape_of_clump({{{0, 0, 0}, r}, {{1.2 * r, 0, 0}, r}, {{0.6 * r, 1.04 * r, 0}, r}});
  auto const places = fill_number(box, size_distribution::one(shape.reach()), 3000, 1);
  scene<clumps> bed(cpu, gravity{}, by, velocity_verlet{}, clumps{});
  bed.set_mesh(walls);
  set_clumps(bed, {shape}, clumps_within(places.centres, places.radii, shape));
  double const dt = largest_time_step(bed);
  settle(bed, dt);
  write(bed.to_host<position>());
  measure(bed, "clumps", steps, dt);

  auto const spheres = fill_number(box, size_distribution::one(r), 9000, 1);
  scene<> free(cpu, gravity{}, by, velocity_verlet{});
  free.set_mesh(walls);
  free.set(spheres_xyz(spheres.centres.data(), spheres.radii.size(), r));
  settle(free, dt);
  measure(free, "spheres", steps, dt);
}
