/// Simulations on ranks that are saved and loaded, on the host.
#include "ranks/on_threads.hpp"

namespace {

/// The error that all ranks throw.
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
  tests::check_checkpoints(tests::snow());
  tests::check_checkpoints(tests::snow(true));
  tests::check_checkpoints(tests::dust());
  tests::check_checkpoints(tests::sizes_that_repeat());
  tests::check_checkpoints(tests::piston_and_belt<collide::karabassi_swept<>>());
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
