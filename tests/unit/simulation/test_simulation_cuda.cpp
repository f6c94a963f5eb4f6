/// Simulations on the GPU.
#include <collide/effects/absorb.hpp>

#include "simulation/contact_forces.hpp"
#include "simulation/memory.hpp"
#include "simulation/simulation.hpp"

namespace {

using collide::bounce;
using collide::cuda_shared;
using collide::gravity;
using collide::karabassi;
using collide::karabassi_swept;
using collide::simulation;

template <class NarrowPhase>
using falls_in = simulation<tests::meets_mesh<cuda_shared, NarrowPhase>, gravity, bounce>;

/// `cuda_shared` on a GPU that has room for so many blocks.
template <std::size_t Blocks>
struct narrow : cuda_shared {
  using cuda_shared::cuda_shared;
  template <class Kernel>
  std::size_t max_resident_blocks() const {
    return Blocks;
  }
};

/// Steps that are captured in a graph of `together`, of `nodes` kernels, do what steps do that are not.
template <class Simulation, class... Effect>
void check_captured(tests::world<float> const& w, float dt, int together, int times, std::size_t nodes,
                    Effect... effects) {
  cudaStream_t stream;
  collide::cuda_check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "cudaStreamCreateWithFlags");
  {
    tests::running<Simulation> direct{cuda_shared(stream), w, effects...}, replayed{cuda_shared(stream), w, effects...};
    direct.simulation.steps(static_cast<std::size_t>(together * times), dt);

    cudaGraph_t graph;
    cudaGraphExec_t executable;
    collide::cuda_check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeGlobal), "cudaStreamBeginCapture");
    replayed.simulation.steps(static_cast<std::size_t>(together), dt);
    collide::cuda_check(cudaStreamEndCapture(stream, &graph), "cudaStreamEndCapture");
    std::size_t found = 0;
    collide::cuda_check(cudaGraphGetNodes(graph, nullptr, &found), "cudaGraphGetNodes");
    CHECK(found == nodes);
    collide::cuda_check(cudaGraphInstantiate(&executable, graph, 0), "cudaGraphInstantiate");
    for (int i = 0; i < times; ++i) collide::cuda_check(cudaGraphLaunch(executable, stream), "cudaGraphLaunch");
    CHECK((replayed.positions() == direct.positions()));
    CHECK((replayed.velocities() == direct.velocities()));
    cudaGraphExecDestroy(executable);
    cudaGraphDestroy(graph);
  }
  cudaStreamDestroy(stream);
}

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
  tests::check_coarse_bounces<falls_in<karabassi<>>>(cuda_shared(), 1.0 / 60, 0.5);
}

TEST_CASE("simulation: on the GPU, balls that touch hundreds of triangles") {
  tests::check_many_contacts<karabassi<>, float>(cuda_shared());
  tests::check_many_contacts<karabassi<>, double>(cuda_shared());
  tests::check_many_contacts<karabassi_swept<>, float>(cuda_shared());
}

TEST_CASE("simulation: on the GPU, balls that just touch, or just do not") {
  tests::check_tangent_balls<float>(cuda_shared());
  tests::check_tangent_balls<double>(cuda_shared());
  tests::check_sunk_balls<karabassi<>, float>(cuda_shared());
  tests::check_sunk_balls<karabassi<collide::single_precision>, float>(cuda_shared());
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

TEST_CASE("simulation: on the GPU, the same bits where blocks have more near the mesh than they resolve at a time") {
  tests::check_crowded_blocks<karabassi<>, float>(narrow<1>(), cuda_shared());
  tests::check_crowded_blocks<karabassi<>, double>(narrow<3>(), cuda_shared());
  tests::check_crowded_blocks<karabassi_swept<>, float>(narrow<1>(), cuda_shared());
  tests::check_crowded_blocks<karabassi<>, float>(narrow<2>(), cuda_shared(),
                                                  collide::absorbing_box{{-1, -1, -1}, {0, 1, 1}});
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
  check_captured<falls_in<karabassi<>>>(tests::crowd<float>(5000, 1, 0.05, 3, 11), 2e-3f, 4, 20, 4);
  // spheres that meet: a graph that is replayed while lists of neighbours are kept, and when they are made anew
  using meets = simulation<tests::meets_mesh<cuda_shared>, gravity, collide::sphere_contact, bounce>;
  auto const contact = collide::sphere_contact::from_restitution(0.5, 4e-3, 0.06, 1000, 0.5);
  check_captured<meets>(tests::crowd<float>(2000, 1, 0.06, 3, 12), 2e-4f, 2, 300, 16, gravity{}, contact, bounce{});
}

TEST_CASE("simulation: on the GPU, bytes are what it has taken, and once there is room nothing is allocated") {
  tests::check_bytes([](std::pmr::memory_resource* from) { return cuda_shared(nullptr, from); },
                     collide::cuda_memory::get());
}

TEST_CASE("simulation: on the GPU, time and forces of contacts") {
  tests::check_time(cuda_shared());
  tests::check_mesh_forces<karabassi<>>(cuda_shared());
  tests::check_mesh_forces<karabassi_swept<>>(cuda_shared());
  tests::check_mesh_forces<karabassi<>>(collide::cuda());
  tests::check_pair_forces<float>(cuda_shared());
  tests::check_pair_forces<double>(collide::cuda());
}
