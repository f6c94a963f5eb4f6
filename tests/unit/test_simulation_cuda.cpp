/// Simulations on the GPU.
#include "simulation.hpp"

namespace {

using collide::bounce;
using collide::cuda_shared;
using collide::gravity;
using collide::karabassi;
using collide::karabassi_swept;
using collide::simulation;

template <class NarrowPhase>
using falls_in = simulation<tests::meets_mesh<cuda_shared, NarrowPhase>, gravity, bounce>;

}  // namespace

TEST_CASE("simulation: on the GPU, free flight follows the closed form") {
  tests::check_free_flight<float>(cuda_shared());
  tests::check_free_flight<double>(collide::cuda());
}

TEST_CASE("simulation: on the GPU, bounces are e^(2n) as high, and end in rest") {
  tests::check_bounces<falls_in<karabassi<>>>(cuda_shared());
  tests::check_bounces<falls_in<karabassi_swept<>>>(cuda_shared());
}

TEST_CASE("simulation: on the GPU, a ball feels no bump at the inner edges of a plane") {
  tests::check_inner_edges<karabassi<>, float>(cuda_shared());
  tests::check_inner_edges<karabassi_swept<>, float>(cuda_shared());
  tests::check_coarse_bounces<falls_in<karabassi<>>>(cuda_shared());
}

TEST_CASE("simulation: on the GPU, balls that touch hundreds of triangles") {
  tests::check_many_contacts<karabassi<>, float>(cuda_shared());
  tests::check_many_contacts<karabassi<>, double>(cuda_shared());
  tests::check_many_contacts<karabassi_swept<>, float>(cuda_shared());
}

TEST_CASE("simulation: on the GPU, particles stay in a closed mesh for 1e5 steps") {
  tests::check_closed_mesh<karabassi<>, float>(cuda_shared(), 100000, 3, 1000);
}

TEST_CASE("simulation: on the GPU, particles too fast for the discrete test stay in a closed mesh if swept") {
  tests::check_closed_mesh<karabassi_swept<>, float>(cuda_shared(), 1000, 2000, 1000);
}

TEST_CASE("simulation: on the GPU, the same bits on every run") {
  tests::check_determinism<karabassi<>>(cuda_shared(), cuda_shared());
  tests::check_determinism<karabassi<>>(collide::cuda(), collide::cuda());
  tests::check_determinism<karabassi_swept<>>(cuda_shared(), cuda_shared());
}

TEST_CASE("simulation: on the GPU, memory is that of the columns, and a step takes none") {
  auto const make = [](std::pmr::memory_resource* from) { return cuda_shared(nullptr, from); };
  tests::check_memory_of_steps<cuda_shared>(make, collide::cuda_memory::get());
}

TEST_CASE("simulation: on the GPU, an effect of a user, with a column of its own") {
  tests::check_own_effect(cuda_shared());
}

TEST_CASE("simulation: on the GPU, radii that differ") { tests::check_radii(cuda_shared()); }

TEST_CASE("simulation: on the GPU, steps can be captured in a graph, with the same result") {
  auto const w = tests::crowd<float>(5000, 1, 0.05, 3, 11);
  cudaStream_t stream;
  collide::cuda_check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "cudaStreamCreateWithFlags");
  {
    tests::running<falls_in<karabassi<>>> direct{cuda_shared(stream), w}, replayed{cuda_shared(stream), w};
    direct.simulation.steps(80, 2e-3f);

    cudaGraph_t graph;
    cudaGraphExec_t executable;
    collide::cuda_check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeGlobal), "cudaStreamBeginCapture");
    replayed.simulation.steps(4, 2e-3f);
    collide::cuda_check(cudaStreamEndCapture(stream, &graph), "cudaStreamEndCapture");
    std::size_t nodes = 0;
    collide::cuda_check(cudaGraphGetNodes(graph, nullptr, &nodes), "cudaGraphGetNodes");
    CHECK(nodes == 8);  // two kernels a step
    collide::cuda_check(cudaGraphInstantiate(&executable, graph, 0), "cudaGraphInstantiate");
    for (int i = 0; i < 20; ++i) collide::cuda_check(cudaGraphLaunch(executable, stream), "cudaGraphLaunch");
    CHECK((replayed.positions() == direct.positions()));
    CHECK((replayed.velocities() == direct.velocities()));
    cudaGraphExecDestroy(executable);
    cudaGraphDestroy(graph);
  }
  cudaStreamDestroy(stream);
}
