/// Ranks that send by NCCL, a GPU each, checked as tests/unit/ranks says; the argument says what. Started by mpirun.
#define DOCTEST_CONFIG_IMPLEMENT
#include <iostream>

#include <collide/cuda.cuh>
#include <collide/ranks/mpi.hpp>
#include <collide/ranks/nccl.hpp>

#include "ranks/simulations.hpp"

namespace {

std::string check(std::string const& what) {
  tests::complaints wrong;
  collide::nccl_ranks const ranks{collide::mpi_ranks()};
  if (what == "members") {
    tests::check_members(ranks, wrong);
    tests::check_agreement(ranks, wrong);
  } else {
    auto const scene = tests::snow<collide::cuda_shared>();
    tests::check_scene(ranks, scene, tests::expected_values<std::decay_t<decltype(scene)>>(scene), tests::split::odd,
                       wrong);
  }
  return wrong.text();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    collide::mpi_session const session(argc, argv);
    collide::mpi_ranks const processes;
    if (collide::cuda_device_count() < processes.size()) {
      if (processes.rank() == 0)
        std::cout << "skipped: NCCL wants a GPU for each of " << processes.size() << " ranks\n";
      return 77;
    }
    collide::cuda_check(cudaSetDevice(processes.rank()), "cudaSetDevice");
    std::string const what = argc > 1 ? argv[1] : "members";
    if (what == "throws" || what == "dies")
      tests::fail_on_one_rank(collide::nccl_ranks{collide::mpi_ranks(), 5}, what == "dies");
    std::string const wrong = check(what);
    std::cerr << wrong;
    return wrong.empty() ? 0 : 1;
  } catch (std::exception const& e) {
    std::cerr << e.what() << "\n";
    return 1;
  }
}
