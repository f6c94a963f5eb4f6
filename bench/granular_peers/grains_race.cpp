/// \file
/// Beds beside LAMMPS on a core: grains_race bed|drum|loose|falling|mixed STEPS [THREADS] [FILE] reads, in the folder
/// in which it runs, SCENE.xyz (radius, centre and material, 1 or 2, of each grain, a line), takes STEPS steps with the
/// law of LAMMPS, and writes FILE, which is like it. `grains_race fill` writes falling.xyz. Started by grains_race.py,
/// which writes the others. Built by hand: g++ -std=c++17 -O3 -DNDEBUG -ffp-contract=off -fopenmp -Iinclude.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/energy.hpp>

namespace {

using namespace collide;
template <class Law, class... Effect>
using scene = simulation<detector<bucket, karabassi<>, host, double>, gravity, Law, velocity_verlet, Effect...>;

struct grains {
  std::vector<double> radii, centres, corners;
  std::vector<std::uint8_t> made_of;

  void read(std::string const& path) {
    std::ifstream file(path);
    double r, x, y, z;
    int kind;
    while (file >> r >> x >> y >> z >> kind) {
      radii.push_back(r), made_of.push_back(static_cast<std::uint8_t>(kind - 1));
      centres.insert(centres.end(), {x, y, z});
    }
  }
  using point = std::array<double, 3>;
  void quad(point const& a, point const& b, point const& c, point const& d) {
    for (auto const* p : {&a, &b, &c, &a, &c, &d}) corners.insert(corners.end(), p->begin(), p->end());
  }
  void box(point const& low, point const& high) {
    for (int axis = 0; axis < 3; ++axis)
      for (double const at : {low[std::size_t(axis)], high[std::size_t(axis)]}) {
        point p[4];
        auto const u = std::size_t(axis + 1) % 3, v = std::size_t(axis + 2) % 3;
        for (auto& q : p) q[std::size_t(axis)] = at;
        p[0][u] = p[3][u] = low[u], p[1][u] = p[2][u] = high[u];
        p[0][v] = p[1][v] = low[v], p[2][v] = p[3][v] = high[v];
        quad(p[0], p[1], p[2], p[3]);
      }
  }
  void drum() {
    constexpr int sides = 314;
    double const r = 0.1, y = 0.03, turn = 2 * 3.14159265358979323846 / sides;
    for (int k = 0; k < sides; ++k) {
      double const s = turn * k, t = turn * ((k + 1) % sides);
      quad({r * std::cos(s), -y, r * std::sin(s)}, {r * std::cos(t), -y, r * std::sin(t)},
           {r * std::cos(t), y, r * std::sin(t)}, {r * std::cos(s), y, r * std::sin(s)});
    }
    for (double const at : {-y, y}) quad({-r, at, -r}, {r, at, -r}, {r, at, r}, {-r, at, r});
  }
};

template <class Law>
Law of_lammps() {
  Law by;
  by.tangential.damping = tangential_damping::of_normal;
  by.tangential.test = slip_test::spring_and_dashpot;
  by.tangential.keeps_length = true;
  by.slip_shortening = 0;
  return by;
}
/// Two soft solids and the wall's.
template <class Law>
Law of_three(double stiff, double half_as_stiff) {
  Law by = of_lammps<Law>();
  by.made_of.set(0, {stiff, 0.2, 2500});
  by.made_of.set(1, {half_as_stiff, 0.2, 2000});
  by.made_of.set(2, {210e9, 0.2, 7200});
  by.made_of.set_pair(0, 0, {0.5, 0.3, 0.1});
  by.made_of.set_pair(1, 1, {0.4, 0.4, 0.1});
  by.made_of.set_pair(0, 1, {0.45, 0.2, 0.1});
  by.made_of.set_pair(2, 2, {0.6, 0.5, 0.1});
  for (int k = 0; k < 2; ++k) by.made_of.set_pair(k, 2, {0.4, 0.2, 0.1});
  by.made_of.wall_material = 2;
  return by;
}

template <class Scene>
void play(Scene& made, grains const& of, std::size_t steps, double dt, char const* to) {
  made.steps(steps, dt);
  std::fprintf(stderr, "%zu grains, %.2f contacts a grain, %.0f bytes a grain\n", made.size(),
               contact_report(made).coordination, double(made.bytes()) / double(made.size()));
  if (to == nullptr) return;
  std::ofstream file(to);
  file.precision(17);
  auto const x = made.template to_host<position>();
  for (std::size_t i = 0; i < made.size(); ++i)
    file << of.radii[i] << ' ' << x[3 * i] << ' ' << x[3 * i + 1] << ' ' << x[3 * i + 2] << ' ' << of.made_of[i] + 1
         << '\n';
}

void one_size(grains& of, std::string const& name, std::size_t steps, int threads, char const* to) {
  using law = granular_contact<hertz, mindlin>;
  law by = of_lammps<law>();
  by.made_of = one_material({name == "bed" ? 1e9 : 1e7, 0.2, 2500}, {0.5, 0.3});
  scene<law> made(host(threads), gravity{0, 0, -9.81}, by, velocity_verlet{});
  if (name == "bed") {
    of.box({-0.05, -0.03, -0.0902431}, {0.05, 0.03, 0.107757});
  } else {
    of.box({0, 0, 0}, {0.1, 0.1, 0.1});
  }
  made.set_mesh(triangle_soup(of.corners.data(), of.corners.size() / 9));
  std::vector<double> speeds;
  std::uint64_t state = 1;
  for (std::size_t k = 0; k < of.centres.size(); ++k)
    speeds.push_back(name == "bed" ? 0.0 : 0.01 * (double(state = state * 48271 % 2147483647) / 2147483647 * 2 - 1));
  made.set(spheres_xyz(of.centres.data(), of.radii.size(), of.radii[0]), speeds.data());
  play(made, of, steps, name == "bed" ? 5e-7 : 5e-6, to);
}

template <class Law, class... Effect>
void of_sizes(grains& of, Law const& by, std::size_t steps, double dt, int threads, char const* to,
              [[maybe_unused]] body const* turning, Effect const&... effect) {
  scene<Law, polydisperse, Effect...> made(host(threads), gravity{0, 0, -9.81}, by, velocity_verlet{}, polydisperse{},
                                           effect...);
  auto const mesh = triangle_soup(of.corners.data(), of.corners.size() / 9);
  if constexpr (sizeof...(Effect) != 0) {
    made.set_mesh(mesh, {*turning});
  } else {
    made.set_mesh(mesh);
  }
  made.set(spheres_xyz(of.centres.data(), of.radii.size(), of.radii.data()));
  made.template assign<material>(of.made_of);
  play(made, of, steps, dt, to);
}

/// Grains of 1 to 4 mm, of each size as much volume and of two solids by turns, that are to fall into a box: a layer of
/// those above 2 mm, then two of others.
void fill() {
  std::uint64_t state = 1;
  auto const uniform = [&] { return double(state = state * 48271 % 2147483647) / 2147483647; };
  std::ofstream file("falling.xyz");
  file.precision(17);
  double z = 0;
  for (int layer = 0, k = 0; layer < 48; ++layer) {
    bool const is_large = layer % 3 == 0;
    int const side = is_large ? 12 : 24;
    double const cell = 0.04824 / side, from = is_large ? 1.0 / 8 : 1, to = is_large ? 1.0 / 64 : 1.0 / 8;
    for (int i = 0; i < side * side; ++i, ++k)
      file << 0.0005 * std::pow(from + (to - from) * uniform(), -1.0 / 3) << ' ' << cell * (i % side + 0.5) << ' '
           << cell * (i / side + 0.5) << ' ' << z + cell / 2 << ' ' << 1 + k % 2 << '\n';
    z += cell;
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::string const name = argc > 1 ? argv[1] : "";
  if (name == "fill") return fill(), 0;
  if (argc < 3) return std::fprintf(stderr, "grains_race bed|drum|loose|mixed STEPS [THREADS] [POSITIONS]\n"), 1;
  std::size_t const steps = std::strtoull(argv[2], nullptr, 10);
  int const threads = argc > 3 ? std::atoi(argv[3]) : 1;
  char const* const to = argc > 4 ? argv[4] : nullptr;
  grains of;
  of.read(name + ".xyz");
  if (name == "drum") {
    of.drum();
    using law = granular_contact<hertz, mindlin, none, none, materials<3>>;
    body_motion turning;
    turning.axis[1] = 1, turning.axis[2] = 0, turning.rate = 2;
    body const all{0, of.corners.size() / 9, turning};
    of_sizes(of, of_three<law>(2e6, 1e6), steps, 1e-4, threads, to, &all, moving_bodies<>{});
  } else if (name == "mixed" || name == "falling") {
    of.box({0, 0, 0}, {0.04824, 0.04824, 0.6});
    of_sizes(of, of_three<granular_contact<hertz, mindlin, epsd, none, materials<3>>>(1e7, 5e6), steps, 1e-5, threads,
             to, nullptr);
  } else {
    one_size(of, name, steps, threads, to);
  }
}
