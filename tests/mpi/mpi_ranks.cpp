/// Ranks of MPI, checked as tests/unit/ranks says; the argument says what.
#define DOCTEST_CONFIG_IMPLEMENT
#include <csignal>
#include <iostream>

#include <collide/mpi.hpp>

#include "ranks/simulations.hpp"

namespace {

/// Short pieces: messages are then longer than one.
std::string check(std::string const& what) {
  tests::complaints wrong;
  for (std::size_t const piece : {std::size_t{1} << 30, std::size_t{64}, std::size_t{8}}) {
    if (what == "queries" && piece == 8) continue;
    collide::mpi_ranks const ranks(MPI_COMM_WORLD, piece);
    wrong.in("pieces of " + std::to_string(piece));
    if (what == "members") {
      tests::check_members(ranks, wrong);
      tests::check_agreement(ranks, wrong);
    } else if (piece == 64) {
      tests::check_both(ranks, tests::hard_scene<float>(), {}, wrong);
    } else {
      tests::check_queries(ranks, wrong);
      tests::check_short_memory(ranks, wrong);
    }
  }
  for (std::size_t const piece : {std::size_t{7}, std::size_t{1} << 31}) {
    try {
      collide::mpi_ranks{MPI_COMM_WORLD, piece};
      wrong.expect(false, "such a piece is refused");
    } catch (collide::error const&) {
    }
  }
  return wrong.text();
}

/// The checks of one scene.
template <class Scene>
void check_scene(collide::mpi_ranks const& ranks, Scene const& scene, tests::complaints& wrong) {
  tests::check_scene(ranks, scene, tests::expected_values<Scene>(scene), tests::split::odd, wrong);
}

/// Simulations, also with messages of several pieces.
std::string check_simulations() {
  tests::complaints wrong;
  for (std::size_t const piece : {std::size_t{1} << 30, std::size_t{1000}}) {
    collide::mpi_ranks const ranks(MPI_COMM_WORLD, piece);
    check_scene(ranks, tests::snow(), wrong);
    check_scene(ranks, tests::leaps(), wrong);
  }
  tests::check_refusals(collide::mpi_ranks(), wrong);
  return wrong.text();
}

/// One rank fails while the others wait for it.
[[noreturn]] void fail(bool dies) {
  collide::mpi_ranks const ranks;
  if (ranks.rank() == 1) {
    if (dies) std::raise(SIGKILL);
    throw collide::error("on purpose");
  }
  for (;;) collide::agree(ranks);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    collide::mpi_ranks{};
    std::cerr << "MPI was not initialised, and nobody said so\n";
    return 1;
  } catch (collide::error const&) {
  }
  try {
    collide::mpi_session const session(argc, argv);
    std::string const what = argc > 1 ? argv[1] : "queries";
    if (what == "throws" || what == "dies") fail(what == "dies");
    std::string const wrong = what == "simulations" ? check_simulations() : check(what);
    std::cerr << wrong;
    return wrong.empty() ? 0 : 1;
  } catch (std::exception const& e) {
    std::cerr << e.what() << "\n";
    return 1;
  }
}
