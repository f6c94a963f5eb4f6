/// \file
/// Costs of a step of a simulation, for each effect, beside kernels written by hand.
///
///     simulation_bench [SPHERES] [OPTION OF GOOGLE BENCHMARK...]
///     simulation_bench many SPHERES [OPTION OF GOOGLE BENCHMARK...]
///
/// Names are simulation/SPACE/EFFECTS, on the study's scene or as many of its spheres as stated; *packed* are spheres
/// that touch each other. What is timed are always the same steps of a scene, soon after it begins; *lying*: once many
/// spheres lie on the mesh; *mixing*, *fast*: the mean of many successive steps of packed spheres. Counters: over_floor
/// (time over that of reading and writing position and velocity, measured in the same process); bytes (of columns, a
/// particle). With `many`, frictionless spheres that fill space, for the memory that each takes.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include <benchmark/benchmark.h>

#include <collide/bucket.cuh>
#include <collide/effects/absorb.hpp>
#include <collide/effects/adhesion.hpp>
#include <collide/effects/bodies.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/drag.hpp>
#include <collide/effects/emit.hpp>
#include <collide/effects/friction.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/effects/sleep.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/effects/spin.hpp>
#include <collide/effects/wind.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/simulation.cuh>
#include <collide/spaces/upload.hpp>

#include "io/counting.hpp"
#include "io/scenes.hpp"
#include "program.hpp"
#include "stopwatch.hpp"

namespace {

using collide::position;
using collide::velocity;

template <class S>
struct alignas(4 * sizeof(S)) four {
  S x, y, z, w;
};

/// Reads and writes position and velocity, four numbers at a time.
struct touch_all {
  four<float>*x, *v;
  float dt;
  COLLIDE_HD void operator()(std::size_t i) const {
    four<float> p = x[i], u = v[i];
    u.x += dt, u.y += dt, u.z += dt, u.w += dt;
    p.x += u.x * dt, p.y += u.y * dt, p.z += u.z * dt, p.w += u.w * dt;
    x[i] = p;
    v[i] = u;
  }
};

/// Reads both and writes the position: what a step without effects does.
struct move_all {
  four<float>*x, *v;
  float dt;
  COLLIDE_HD void operator()(std::size_t i) const {
    four<float> p = x[i], u = v[i];
    p.x += u.x * dt, p.y += u.y * dt, p.z += u.z * dt, p.w += u.w * dt;
    x[i] = p;
  }
};

/// How many steps are timed together, and how often.
template <class Space>
constexpr int series = Space::host_accessible ? 1 : 20;
constexpr int iterations = 21;

/// A step, and what comes before the first of those that are timed together.
template <class Begin, class Step>
struct measured {
  Begin begin;
  Step step;
};
template <class Begin, class Step>
measured(Begin, Step) -> measured<Begin, Step>;

/// Registers simulation/SPACE/NAME. `prepare()` returns what is `measured`.
template <class Space, class Prepare>
void add(std::string const& name, Space const& space, double floor, double bytes, Prepare const& prepare) {
  benchmark::RegisterBenchmark((std::string("simulation/") + Space::name() + "/" + name).c_str(),
                               [=](benchmark::State& state) {
                                 auto const now = prepare();
                                 bench::stopwatch<Space> watch(space);
                                 double seconds = 0;
                                 for (auto _ : state) {
                                   now.begin();
                                   double const t = watch([&] {
                                     for (int k = 0; k < series<Space>; ++k) now.step();
                                   });
                                   state.SetIterationTime(t / series<Space>);
                                   seconds += t / series<Space>;
                                 }
                                 state.counters["over_floor"] =
                                     seconds / static_cast<double>(state.iterations()) / floor;
                                 state.counters["bytes"] = bytes;
                               })
      ->UseManualTime()
      ->Iterations(iterations)
      ->Unit(benchmark::kMicrosecond);
}

/// The study's scene in memory of the space, and what is measured on it.
template <class Space>
class suite {
 public:
  suite(Space const& space, std::size_t n) : space_{space}, n_{n} {
    io::scene const s = io::study_scene(n);
    std::vector<float> const vertices(s.vertices.begin(), s.vertices.end());
    std::vector<float> const centres(s.centres.begin(), s.centres.end());
    radius_ = static_cast<float>(s.radius);
    mesh_ = std::make_shared<collide::uploaded_mesh<float>>(collide::upload(
        space, collide::indexed_mesh(vertices.data(), vertices.size() / 3, s.corners.data(), s.triangle_count())));
    spheres_ = upload(centres);
    sums_ = std::make_shared<collide::reaction_sums>(space, 16, 1e-6);
    auto const both = by_hand<touch_all>();
    bench::stopwatch<Space> watch(space);
    std::vector<double> seconds;
    for (int i = 0; i < 101; ++i) {
      seconds.push_back(watch([&] {
        for (int k = 0; k < series<Space>; ++k) both.step();
      }));
    }
    floor_ = bench::median(seconds) / series<Space>;
    ::add("read and write both", space_, floor_, 24, [s = *this] { return s.template by_hand<touch_all>(); });
    ::add("move, by hand", space_, floor_, 24, [s = *this] { return s.template by_hand<move_all>(); });
  }

  float radius() const { return radius_; }

  /// Sums up what particles give to up to 16 bodies.
  collide::reaction reaction() const { return sums_->effect(1); }

  /// A step of a simulation with these effects.
  template <class NarrowPhase = collide::karabassi<>, class... Effect>
  void add(std::string const& name, Effect const&... effects) const {
    add_with<NarrowPhase>(name, spheres_, 10, 0.01f, effects...);
  }

  /// The same when many spheres lie on the mesh. On the GPU: elsewhere they take long to get there.
  template <class... Effect>
  void add_lying(std::string const& name, Effect const&... effects) const {
    if (!Space::host_accessible) add_with<collide::karabassi<>>("lying: " + name, spheres_, 600, 0.01f, effects...);
  }

  /// The same where the mesh is bodies: this many ranges of it, which turn about its axis.
  template <class... Effect>
  void add_bodies(std::string const& name, int bodies, Effect const&... effects) const {
    constexpr double slowly = 1e-3;  // radians per unit of time: places hardly change
    auto const turning = bodies_that_turn(bodies, slowly);
    add_on<collide::karabassi<>>(name, spheres_, 10, 0.01f, turning, collide::moving_bodies<>{}, effects...);
    if (Space::host_accessible) return;
    add_on<collide::karabassi<>>("lying: " + name, spheres_, 600, 0.01f, turning, collide::moving_bodies<>{},
                                 effects...);
  }

  /// The same among balls that fill space, each in touch with six others. Their lists of neighbours are kept.
  template <class... Effect>
  void add_packed(std::string const& name, Effect const&... effects) const {
    add_with<collide::karabassi<>>("packed: " + name, upload(packed()), 2, 1e-4f, effects...);
  }

  /// The mean of successive steps, from that lattice on, with the steps in which the lists are made anew. Coordinates
  /// of velocities are random, up to `speed`; walls keep the balls together.
  template <class... Effect>
  void add_mixing(std::string const& name, float speed, Effect const&... effects) const {
    using simulation = collide::simulation<collide::detector<collide::bucket, collide::karabassi<>, Space>, Effect...>;
    std::vector<float> const centres = packed();
    std::vector<float> velocities(centres.size());
    std::mt19937 engine(1);
    std::uniform_real_distribution<float> coordinate(-speed, speed);
    for (float& v : velocities) v = coordinate(engine);
    uploaded const spheres = upload(centres);
    auto const moving = std::make_shared<collide::buffer<float>>();
    space_.copy_from_host(moving->reserve(space_.resource(), velocities.size()), velocities.data(), velocities.size());
    ::add(name, space_, floor_, simulation::bytes_per_particle, [=, space = space_] {
      auto const made = std::make_shared<simulation>(space, effects...);
      made->set(spheres->view(), moving->data());
      return measured{[] {}, [=] { made->step(1e-4f); }};
    });
  }

  /// A box around that lattice.
  collide::box_walls around_packed() const {
    double const near = -radius_, far = 1.98 * radius_ * static_cast<double>(side());
    return {{near, near, near}, {far, far, far}, 0.5};
  }

 private:
  using uploaded = std::shared_ptr<collide::uploaded_spheres<float>>;

  std::size_t side() const { return static_cast<std::size_t>(std::cbrt(static_cast<double>(n_))) + 1; }

  std::vector<float> packed() const {
    std::vector<float> centres;
    for (std::size_t i = 0; i < n_; ++i)
      for (std::size_t at : {i % side(), i / side() % side(), i / side() / side()})
        centres.push_back(1.98f * radius_ * static_cast<float>(at));
    return centres;
  }

  uploaded upload(std::vector<float> const& centres) const {
    return std::make_shared<collide::uploaded_spheres<float>>(
        collide::upload(space_, collide::spheres_xyz(centres.data(), n_, radius_)));
  }

  std::vector<collide::body> bodies_that_turn(int count, double rate) const {
    std::size_t const triangles = mesh_->view().size(), n = static_cast<std::size_t>(count);
    std::vector<collide::body> bodies(n);
    for (std::size_t i = 0; i < n; ++i) {
      bodies[i].first = triangles * i / n;
      bodies[i].size = triangles * (i + 1) / n - bodies[i].first;
      bodies[i].motion.rate = rate;
    }
    return bodies;
  }

  template <class NarrowPhase, class... Effect>
  void add_with(std::string const& name, uploaded const& spheres, std::size_t steps, float dt,
                Effect const&... effects) const {
    add_on<NarrowPhase>(name, spheres, steps, dt, std::vector<collide::body>(), effects...);
  }

  template <class NarrowPhase, class... Effect>
  void add_on(std::string const& name, uploaded const& spheres, std::size_t steps, float dt,
              std::vector<collide::body> const& bodies, Effect const&... effects) const {
    using simulation = collide::simulation<collide::detector<collide::bucket, NarrowPhase, Space>, Effect...>;
    ::add(name, space_, floor_, simulation::bytes_per_particle, [=, mesh = mesh_, space = space_] {
      auto const made = std::make_shared<simulation>(space, effects...);
      made->set(spheres->view());
      if constexpr ((std::is_same_v<Effect, collide::moving_bodies<>> || ...)) {
        made->set_mesh(mesh->view(), bodies);
      } else {
        made->set_mesh(mesh->view());
      }
      auto const begin = [=] {
        made->set(spheres->view());
        made->steps(steps, dt);
      };
      return measured{begin, [=] { made->step(dt); }};
    });
  }

  /// A kernel over the columns of a simulation that does nothing else.
  template <class Kernel>
  auto by_hand() const {
    auto const columns =
        std::make_shared<collide::simulation<collide::detector<collide::bucket, collide::karabassi<>, Space>>>(space_);
    columns->set(spheres_->view());
    auto* const x = reinterpret_cast<four<float>*>(columns->template data<position>());
    auto* const v = reinterpret_cast<four<float>*>(columns->template data<velocity>());
    return measured{[] {}, [=, n = n_] { columns->space().for_each(3 * n / 4, Kernel{x, v, 1e-3f}); }};
  }

  Space space_;
  std::size_t n_;
  float radius_;
  std::shared_ptr<collide::uploaded_mesh<float>> mesh_;
  uploaded spheres_;
  std::shared_ptr<collide::reaction_sums> sums_;
  double floor_;
};

/// The measurements of all spaces.
template <class Space>
void add_few(suite<Space> const& scene) {
  using namespace collide;
  scene.add("no effects");
  scene.add("gravity", gravity{});
  scene.add("gravity, bounce", gravity{}, bounce{});
}

/// Every effect. Of every scene a kernel or two has to be compiled, which takes minutes for a GPU.
template <class Space>
void add_all(suite<Space> const& scene) {
  using namespace collide;
  add_few(scene);
  scene.add_lying("gravity, bounce", gravity{}, bounce{});
  scene.add("velocity_verlet, gravity, bounce", velocity_verlet{}, gravity{}, bounce{});
  scene.template add<karabassi_swept<>>("swept: gravity, bounce", gravity{}, bounce{});
  scene.add("gravity, drag", gravity{}, drag{0.1, 0.01});
  scene.add("gravity, wind", gravity{}, wind<>{0.1, 0.01, {1, 0, 0}});
  scene.add("gravity, box_walls", gravity{}, box_walls{});
  scene.add("gravity, periodic_box", gravity{}, periodic_box{{-1e3, -1e3, -1e3}, {1e3, 1e3, 1e3}});
  scene.add("gravity, bounce, polydisperse", gravity{}, bounce{}, polydisperse{});
  scene.add("gravity, bounce, friction", gravity{}, bounce{}, friction{});
  scene.add("gravity, bounce, friction, spin", gravity{}, bounce{}, friction{}, spin{});
  scene.add("gravity, bounce, adhesion", gravity{}, bounce{}, adhesion{});
  scene.add("sleep, gravity, bounce", collide::sleep{}, gravity{}, bounce{});
  scene.add("gravity, absorb", gravity{}, absorb{});
  scene.add("emit, gravity, bounce", emit{1e5, {}}, gravity{}, bounce{});
  scene.add("gravity, bounce, reaction", gravity{}, bounce{}, scene.reaction());
  scene.add_lying("gravity, bounce, reaction", gravity{}, bounce{}, scene.reaction());
  scene.add_bodies("1 body: gravity, bounce", 1, gravity{}, bounce{});
  scene.add_bodies("16 bodies: gravity, bounce", 16, gravity{}, bounce{});
  scene.add_bodies("1 body: gravity, bounce, reaction", 1, gravity{}, bounce{}, scene.reaction());
  auto const contact = sphere_contact::from_restitution(0.5, 2e-3, double(scene.radius()), 1);
  auto const soft = sphere_contact::from_restitution(0.5, 0.2, double(scene.radius()), 1);  // as its steps are longer
  scene.add("sphere_contact, gravity, bounce", soft, gravity{}, bounce{});
  scene.add_packed("sphere_contact, gravity", contact, gravity{});
  scene.add_packed("sphere_contact, gravity, bounce", contact, gravity{}, bounce{});
  scene.add_packed("sleep, sphere_contact, gravity: all asleep", collide::sleep{1e30, 1}, contact, gravity{});
  scene.add_mixing("packed, mixing: sphere_contact, gravity, box_walls", 10, contact, gravity{}, scene.around_packed());
  scene.add_mixing("packed, fast: sphere_contact, gravity, box_walls", 2000, contact, gravity{}, scene.around_packed());
}

/// Kernel functor of `for_each` over spheres that fill space.
struct fill_space {
  float* xyz;
  std::size_t side;
  COLLIDE_HD void operator()(std::size_t i) const {
    xyz[3 * i] = 0.0198f * static_cast<float>(i % side);
    xyz[3 * i + 1] = 0.0198f * static_cast<float>(i / side % side);
    xyz[3 * i + 2] = 0.0198f * static_cast<float>(i / side / side);
  }
};

/// Very many frictionless spheres that touch each other. Counters: spheres; bytes, all that the simulation takes, a
/// sphere.
template <class Space, class MakeSpace>
void add_many(MakeSpace const& make, std::size_t n) {
  benchmark::RegisterBenchmark(
      (std::string("simulation/") + Space::name() + "/many/" + std::to_string(n)).c_str(),
      [=](benchmark::State& state) {
        using namespace collide;
        Space const plain = make(nullptr);
        io::counting_resource counted(plain.resource());
        Space const space = make(&counted);
        auto const contact = sphere_contact::from_restitution(0.5, 2e-3, 0.01, 1000);
        simulation<detector<bucket, karabassi<>, Space>, sphere_contact, gravity, box_walls> made(
            space, contact, gravity{}, box_walls{});
        {
          buffer<float> centres;
          auto const side = static_cast<std::size_t>(std::cbrt(static_cast<double>(n))) + 1;
          plain.for_each(n, fill_space{centres.reserve(plain.resource(), 3 * n), side});
          made.set(spheres_xyz(static_cast<float const*>(centres.data()), n, 0.01f));
          plain.synchronize();
        }
        made.steps(2, 1e-4f);
        bench::stopwatch<Space> watch(space);
        for (auto _ : state) state.SetIterationTime(watch([&] { made.step(1e-4f); }));
        state.counters["spheres"] = static_cast<double>(n);
        state.counters["bytes"] = static_cast<double>(counted.in_use) / static_cast<double>(n);
      })
      ->UseManualTime()
      ->Iterations(3)
      ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  bool const many = argc > 1 && std::strcmp(argv[1], "many") == 0;
  char const* const number = argc > 1 + many ? argv[1 + many] : nullptr;
  std::size_t const n = number != nullptr ? bench::count_of(number, 8) : many ? 0 : io::study_spheres;
  if (n == 0 || argc > 2 + many) {
    std::fputs("usage: simulation_bench [many] [SPHERES, at least 8] [OPTION OF GOOGLE BENCHMARK...]\n", stderr);
    return 2;
  }
#if defined(__CUDACC__)
  if (bench::has_gpu()) {
    using collide::cuda, collide::cuda_shared;
    if (many) {
      add_many<cuda_shared>([](std::pmr::memory_resource* from) { return cuda_shared(nullptr, from); }, n);
    } else {
      add_all(suite<cuda_shared>(cuda_shared(), n));
      add_few(suite<cuda>(cuda(), n));
    }
  }
#endif
  if (!bench::has_gpu()) {
    if (many) {
      add_many<collide::host>([](std::pmr::memory_resource* from) { return collide::host(0, from); }, n);
    } else {
      add_all(suite<collide::host>(collide::host(), n));
    }
  }
  return bench::run();
}
