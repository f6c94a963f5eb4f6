/// Ranks of MPI, checked as tests/unit/ranks says; the argument says what.
#define DOCTEST_CONFIG_IMPLEMENT
#include <iostream>

#include <collide/ranks/mpi.hpp>

#include "ranks/simulations.hpp"

namespace {

/// A space whose memory MPI takes: that of the host.
struct reachable_space {
  int* waits;
  void synchronize() const { ++*waits; }
  void copy_from_any_device(void* to, void const* from, std::size_t bytes) const { std::memcpy(to, from, bytes); }
};

/// Checks that a space sends the same as the host, once it is done with it.
void check_exchange_in_space(collide::mpi_ranks const& ranks, tests::complaints& wrong) {
  auto const size = static_cast<std::size_t>(ranks.size()), rank = static_cast<std::size_t>(ranks.rank());
  std::vector<std::uint64_t> to_each(size), of_each(size);
  std::vector<int> from, to, expected;
  for (std::size_t q = 0; q < size; ++q) {
    to_each[q] = rank + 3 * q;
    of_each[q] = q + 3 * rank;
    for (std::size_t i = 0; i < to_each[q]; ++i) from.push_back(static_cast<int>(1000 * rank + 100 * q + i));
    for (std::size_t i = 0; i < of_each[q]; ++i) expected.push_back(static_cast<int>(1000 * q + 100 * rank + i));
  }
  to.resize(expected.size());
  int waits = 0;
  ranks.exchange_in_space(reachable_space{&waits}, from.data(), to_each.data(), to.data(), of_each.data(), sizeof(int));
  wrong.expect(waits > 0, "an exchange waits for the space");
  wrong.expect(to == expected, "an exchange in space");
  ranks.takes_device_memory();  // whatever it says, it can be asked
}

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
      check_exchange_in_space(ranks, wrong);
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
    if (what == "throws" || what == "dies") tests::fail_on_one_rank(collide::mpi_ranks(), what == "dies");
    std::string const wrong = what == "simulations" ? check_simulations() : check(what);
    std::cerr << wrong;
    return wrong.empty() ? 0 : 1;
  } catch (std::exception const& e) {
    std::cerr << e.what() << "\n";
    return 1;
  }
}
