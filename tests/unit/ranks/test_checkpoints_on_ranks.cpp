/// Simulations on ranks that are saved and loaded, on the host.
#include <sstream>

#include <collide/ranks/distributed_checkpoint.hpp>
#include <collide/ranks/thread_ranks.hpp>

#include "ranks/simulations.hpp"

namespace {

/// What ranks save is what one saves; one, and any number of ranks, go on from it.
template <class Scene>
void check_checkpoints(Scene const& scene) {
  using simulation = typename Scene::simulation;
  std::apply(
      [&](auto const&... effects) {
        tests::world_in<collide::host, typename Scene::S> const there(collide::host(1), scene.w);
        auto const half = static_cast<std::size_t>(scene.steps / 2);
        std::ostringstream saved, end;
        simulation one(collide::host(1), effects...);
        there.set_mesh(one, scene.bodies);
        there.set(one, {0, scene.w.size()}, scene.capacity);
        one.steps(half, scene.dt);
        collide::save(one, saved);
        one.steps(half, scene.dt);
        collide::save(one, end);
        for (int const n : {1, 2, 5}) {
          CAPTURE(n);
          std::ostringstream from_start, at_end;
          collide::thread_ranks::run(n, [&](collide::thread_ranks const& ranks) {
            auto const own = tests::part_of(scene.w.size(), tests::split::odd, ranks.rank(), n);
            collide::distributed<simulation, collide::thread_ranks> parts(ranks, collide::host(1), effects...);
            there.set_mesh(parts, scene.bodies);
            there.set(parts, own, scene.capacity);
            parts.steps(half, scene.dt);
            collide::save(parts, from_start);
            collide::distributed<simulation, collide::thread_ranks> later(ranks, collide::host(1));
            there.set_mesh(later, scene.bodies);
            std::istringstream before(saved.str());
            collide::load(later, before);
            later.steps(half, scene.dt);
            collide::save(later, at_end);
          });
          CHECK((from_start.str() == saved.str()));
          CHECK((at_end.str() == end.str()));
          simulation alone(collide::host(1));
          there.set_mesh(alone, scene.bodies);
          std::istringstream before(from_start.str());
          collide::load(alone, before);
          alone.steps(half, scene.dt);
          tests::values_of<simulation> expected, found, on_ranks;
          expected.read(one);
          found.read(alone);
          CHECK(equal(found, expected));
          std::istringstream last(at_end.str());
          collide::load(alone, last);
          on_ranks.read(alone);
          CHECK(equal(on_ranks, expected));
        }
      },
      scene.effects);
}

/// What all ranks throw.
template <class F>
std::string thrown(F const& f) {
  try {
    collide::thread_ranks::run(3, f);
  } catch (std::exception const& e) {
    return e.what();
  }
  return "nothing";
}

}  // namespace

TEST_CASE("checkpoints on ranks: what one rank saves others go on from") {
  check_checkpoints(tests::snow());
  check_checkpoints(tests::snow(true));
  check_checkpoints(tests::dust());
  check_checkpoints(tests::sizes_that_repeat());
  check_checkpoints(tests::piston_and_belt<collide::karabassi_swept<>>());
}

TEST_CASE("checkpoints on ranks: files, and what is refused") {
  using parts_type = collide::distributed<collide::simulation<tests::discrete<collide::host>, collide::sphere_contact>,
                                          collide::thread_ranks>;
  std::string const path = "checkpoint_on_ranks.tmp";
  float const centre[] = {0, 0, 0};
  collide::thread_ranks::run(3, [&](collide::thread_ranks const& ranks) {
    parts_type parts(ranks, collide::host(1));
    parts.set(collide::spheres_xyz(centre, 1, 0.1f));
    parts.step(0.0005f);
    collide::save(parts, path);
    parts_type later(ranks, collide::host(1));
    collide::load(later, path);
    collide::together(ranks, [&] {
      if (later.size() != 3 || later.time() != parts.time()) throw collide::error("something else was loaded");
    });
    later.step(0.0005f);
  });
  CHECK(thrown([&](collide::thread_ranks const& ranks) {
          parts_type parts(ranks, collide::host(1));
          collide::save(parts, path);
        }) == "collide: save: the simulation has no particles: call set before it");
  CHECK(thrown([&](collide::thread_ranks const& ranks) {
          parts_type parts(ranks, collide::host(1));
          parts.set(collide::spheres_xyz(centre, 1, 0.1f));
          collide::save(parts, "no/such/folder");
        }) == "collide: save: no/such/folder cannot be written");
  CHECK(thrown([&](collide::thread_ranks const& ranks) {
          parts_type parts(ranks, collide::host(1));
          collide::load(parts, "no/such/file");
        }) == "collide: load: no/such/file cannot be read");
  CHECK(std::ifstream(path + ".part").fail());
  std::remove(path.c_str());
}
