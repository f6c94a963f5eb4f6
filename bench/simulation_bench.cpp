/// \file
/// What a step of a simulation costs: on the study's scene, for each effect, beside kernels written by hand.
///
///     simulation_bench [SPHERES [REPETITIONS]]
///     simulation_bench many SPHERES
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <collide/absorb.hpp>
#include <collide/bounce.hpp>
#include <collide/bounds.hpp>
#include <collide/bucket.cuh>
#include <collide/drag.hpp>
#include <collide/emit.hpp>
#include <collide/friction.hpp>
#include <collide/gravity.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/polydisperse.hpp>
#include <collide/simulation.cuh>
#include <collide/sleep.hpp>
#include <collide/sphere_contact.hpp>
#include <collide/spin.hpp>
#include <collide/stick.hpp>
#include <collide/upload.hpp>
#include <collide/wind.hpp>

#include "io/scenes.hpp"
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

/// Seconds of a call of f, of which some follow each other: the median of such series.
template <class Space, class F>
double median(Space const& space, std::size_t times, F const& f) {
  constexpr int series = Space::host_memory ? 1 : 20;
  bench::stopwatch<Space> watch(space);
  std::vector<double> seconds;
  for (std::size_t i = 0; i < times; ++i) {
    seconds.push_back(watch([&] {
      for (int k = 0; k < series; ++k) f();
    }));
  }
  std::nth_element(seconds.begin(), seconds.begin() + static_cast<std::ptrdiff_t>(times / 2), seconds.end());
  return seconds[times / 2] / series;
}

/// The study's scene in memory of the space.
template <class Space>
struct placed {
  Space space;
  std::size_t n, times;
  float radius;
  collide::uploaded_mesh<float> mesh;
  collide::uploaded_spheres<float> spheres;
  double floor = 0;

  static placed make(Space const& space, std::size_t n, std::size_t times) {
    io::scene const s = io::study_scene(n);
    std::vector<float> const vertices(s.vertices.begin(), s.vertices.end());
    std::vector<float> const centres(s.centres.begin(), s.centres.end());
    auto const radius = static_cast<float>(s.radius);
    return {space,
            n,
            times,
            radius,
            collide::upload(space, collide::indexed_mesh(vertices.data(), vertices.size() / 3, s.corners.data(),
                                                         s.triangle_count())),
            collide::upload(space, collide::spheres_xyz(centres.data(), n, radius))};
  }

  template <class Simulation>
  void run(char const* name, Simulation&& simulation, float dt = 0.01f) {
    simulation.set(spheres.view());
    simulation.set_mesh(mesh.view());
    simulation.steps(10, dt);
    report<Simulation>(name, median(space, times, [&] { simulation.step(dt); }));
  }

  /// Balls that fill space, each in touch with six others.
  template <class Simulation>
  void run_packed(char const* name, Simulation&& simulation) {
    std::vector<float> centres;
    auto const side = static_cast<std::size_t>(std::cbrt(static_cast<double>(n))) + 1;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t at : {i % side, i / side % side, i / side / side})
        centres.push_back(1.98f * radius * static_cast<float>(at));
    auto const packed = collide::upload(space, collide::spheres_xyz(centres.data(), n, radius));
    simulation.set(packed.view());
    simulation.set_mesh(mesh.view());
    simulation.steps(2, 1e-4f);
    report<Simulation>(name, median(space, times, [&] { simulation.step(1e-4f); }));
  }

  template <class Simulation>
  void report(char const* name, double seconds) const {
    std::printf("%-12s %-42s %9.1f us  %5.2fx  %3zu bytes\n", Space::name(), name, seconds * 1e6, seconds / floor,
                std::decay_t<Simulation>::bytes_per_particle);
    std::fflush(stdout);
  }
};

/// What the effects cost. Of every scene a kernel or two has to be compiled, which takes minutes for a GPU.
template <class Space>
void measure_effects(placed<Space>& scene) {
  using namespace collide;
  using still = detector<bucket, karabassi<>, Space>;
  Space const& space = scene.space;
  scene.run("gravity, drag", simulation<still, gravity, drag>(space, gravity{}, drag{0.1, 0.01}));
  scene.run("gravity, wind", simulation<still, gravity, wind<>>(space, gravity{}, wind<>{0.1, 0.01, {1, 0, 0}}));
  scene.run("gravity, bounds", simulation<still, gravity, bounds>(space));
  scene.run("gravity, periodic",
            simulation<still, gravity, periodic>(space, gravity{}, periodic{{-1e3, -1e3, -1e3}, {1e3, 1e3, 1e3}}));
  scene.run("gravity, bounce, polydisperse", simulation<still, gravity, bounce, polydisperse>(space));
  scene.run("gravity, bounce, friction", simulation<still, gravity, bounce, friction>(space));
  scene.run("gravity, bounce, friction, spin", simulation<still, gravity, bounce, friction, spin>(space));
  scene.run("gravity, bounce, stick", simulation<still, gravity, bounce, stick>(space));
  scene.run("sleep, gravity, bounce", simulation<still, collide::sleep, gravity, bounce>(space));
  scene.run("sleep, gravity, bounce: all asleep",
            simulation<still, collide::sleep, gravity, bounce>(space, collide::sleep{1e30, 5}, gravity{}, bounce{}));
  scene.run("gravity, absorb", simulation<still, gravity, absorb>(space));
  scene.run("emit, gravity, bounce",
            simulation<still, emit, gravity, bounce>(space, emit{1e5, {}}, gravity{}, bounce{}));
  auto const contact = sphere_contact::of_collision(0.5, 2e-3, double(scene.radius), 1);
  scene.run("sphere_contact, gravity, bounce",
            simulation<still, sphere_contact, gravity, bounce>(space, contact, gravity{}, bounce{}));
  scene.run_packed("packed: sphere_contact, gravity",
                   simulation<still, sphere_contact, gravity>(space, contact, gravity{}));
  scene.run_packed("packed: sphere_contact, gravity, bounce",
                   simulation<still, sphere_contact, gravity, bounce>(space, contact, gravity{}, bounce{}));
}

/// The headline; with `all` every effect too.
template <class Space, bool All>
void measure(Space const& space, std::size_t n, std::size_t times) {
  auto scene = placed<Space>::make(space, n, times);
  collide::simulation<collide::detector<collide::bucket, collide::karabassi<>, Space>> plain(space);
  plain.set(scene.spheres.view());
  auto* const x = reinterpret_cast<four<float>*>(plain.template data<position>());
  auto* const v = reinterpret_cast<four<float>*>(plain.template data<velocity>());
  scene.floor = median(space, 101, [&] { space.for_each(3 * n / 4, touch_all{x, v, 1e-3f}); });
  double const move = median(space, 101, [&] { space.for_each(3 * n / 4, move_all{x, v, 1e-3f}); });
  std::printf("%-12s %-42s %9.1f us\n", Space::name(), "read and write both", scene.floor * 1e6);
  std::printf("%-12s %-42s %9.1f us  %5.2fx\n", Space::name(), "move, by hand", move * 1e6, move / scene.floor);

  using still = collide::detector<collide::bucket, collide::karabassi<>, Space>;
  using swept = collide::detector<collide::bucket, collide::karabassi_swept<>, Space>;
  using namespace collide;
  scene.run("no effects", simulation<still>(space));
  scene.run("gravity", simulation<still, gravity>(space));
  scene.run("gravity, bounce", simulation<still, gravity, bounce>(space));
  if constexpr (All) {
    scene.run("velocity_verlet, gravity, bounce", simulation<still, velocity_verlet, gravity, bounce>(space));
    scene.run("swept: gravity, bounce", simulation<swept, gravity, bounce>(space));
  }
  if constexpr (All) measure_effects(scene);
}

/// Kernel body of `for_each` over spheres that fill space.
struct fill_space {
  float* xyz;
  std::size_t side;
  COLLIDE_HD void operator()(std::size_t i) const {
    xyz[3 * i] = 0.0198f * static_cast<float>(i % side);
    xyz[3 * i + 1] = 0.0198f * static_cast<float>(i / side % side);
    xyz[3 * i + 2] = 0.0198f * static_cast<float>(i / side / side);
  }
};

/// Memory of a resource, counted.
class counting final : public std::pmr::memory_resource {
 public:
  explicit counting(std::pmr::memory_resource* from) : from_{from} {}
  std::size_t bytes = 0;

 private:
  void* do_allocate(std::size_t n, std::size_t alignment) override {
    bytes += n;
    return from_->allocate(n, alignment);
  }
  void do_deallocate(void* p, std::size_t n, std::size_t alignment) override {
    bytes -= n;
    from_->deallocate(p, n, alignment);
  }
  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }

  std::pmr::memory_resource* from_;
};

/// Very many frictionless spheres that touch each other: memory and time.
template <class Space, class MakeSpace>
void measure_many(MakeSpace const& make, std::size_t n) {
  using namespace collide;
  Space const plain = make(nullptr);
  counting counted(plain.resource());
  Space const space = make(&counted);
  auto const contact = sphere_contact::of_collision(0.5, 2e-3, 0.01, 1000);
  simulation<detector<bucket, karabassi<>, Space>, sphere_contact, gravity, bounds> made(space, contact, gravity{},
                                                                                         bounds{});
  {
    buffer<float> centres;
    auto const side = static_cast<std::size_t>(std::cbrt(static_cast<double>(n))) + 1;
    plain.for_each(n, fill_space{centres.reserve(plain.resource(), 3 * n), side});
    made.set(spheres_xyz(static_cast<float const*>(centres.data()), n, 0.01f));
    plain.synchronize();
  }
  made.steps(2, 1e-4f);
  double const seconds = median(space, 3, [&] { made.step(1e-4f); });
  std::printf("%-12s %zu spheres that touch: %.2f ms a step, %.1f bytes a sphere\n", Space::name(), n, seconds * 1e3,
              static_cast<double>(counted.bytes) / static_cast<double>(n));
}

}  // namespace

int main(int argc, char** argv) {
  bool const many = argc > 2 && std::strcmp(argv[1], "many") == 0;
  std::size_t const n = argc > 1 ? std::strtoull(argv[many ? 2 : 1], nullptr, 10) : io::study_spheres;
  std::size_t const times = argc > 2 && !many ? std::strtoull(argv[2], nullptr, 10) : 21;
#if defined(__CUDACC__)
  if (collide::cuda_device_count() > 0) {
    if (many) {
      measure_many<collide::cuda_shared>(
          [](std::pmr::memory_resource* from) { return collide::cuda_shared(nullptr, from); }, n);
    } else {
      measure<collide::cuda_shared, true>(collide::cuda_shared(), n, times);
      measure<collide::cuda, false>(collide::cuda(), n, times);
    }
    return 0;
  }
#endif
  if (many) {
    measure_many<collide::host>([](std::pmr::memory_resource* from) { return collide::host(0, from); }, n);
  } else {
    measure<collide::host, true>(collide::host(), n, times);
  }
}
