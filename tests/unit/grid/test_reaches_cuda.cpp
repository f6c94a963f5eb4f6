/// Spheres of many radii, on the GPU.
#include <collide/sinks/any_hit.hpp>

#include "grid/reaches.hpp"

TEST_CASE("reaches: spheres whose radii change have the pairs of all pairs, on the device") {
  tests::check_changing_radii(collide::cuda());
  tests::check_changing_radii(collide::cuda_shared());
}

TEST_CASE("reaches: where each thread is alone few spheres get narrower cells, on the device") {
  tests::many_radii const scene(20000, 1000, 1);
  collide::cuda const alone;
  auto const mesh = collide::upload(alone, scene.mesh());
  auto const spheres = collide::upload(alone, scene.spheres(0));
  auto const width_in = [&](auto const& space) {
    collide::detector<collide::bucket, collide::karabassi<>, std::decay_t<decltype(space)>> detector(space);
    collide::any_hit sink;
    detector.build(mesh.view());
    detector.query(spheres.view(), sink);
    return detector.cell_width();
  };
  CHECK(width_in(alone) < 0.8 * width_in(collide::cuda_shared()));
}

TEST_CASE("few: spheres of many radii, first and again, on the GPU") {
  tests::many_radii const scene(100, 3000, 1000);
  tests::check_changing_radii<collide::karabassi<>>(collide::cuda_shared(), scene);
  tests::check_changing_radii<collide::karabassi_swept<>>(collide::cuda_shared(), scene);
}

TEST_CASE("reaches: queries of spheres of many radii can be captured in a graph, and follow radii that change") {
  tests::many_radii const scene(200, 8000, 1000);
  cudaStream_t stream = nullptr;
  collide::cuda_check(cudaStreamCreate(&stream), "cudaStreamCreate");
  {
    collide::cuda_shared space(stream);
    auto const mesh = collide::upload(space, scene.mesh());
    auto const spheres = collide::upload(space, scene.spheres(0));
    float const* radii = nullptr;
    spheres.view().for_each_array([&](float const* from, std::size_t) { radii = from; });
    for (bool const builds : {true, false}) {
      collide::detector<collide::bucket, collide::karabassi<>, collide::cuda_shared> detector(space);
      collide::any_hit sink;
      detector.build(mesh.view());
      detector.query(spheres.view(), sink);  // allocates
      detector.query(spheres.view(), sink);
      space.synchronize();
      cudaGraph_t graph = nullptr;
      cudaGraphExec_t runs = nullptr;
      collide::cuda_check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal), "cudaStreamBeginCapture");
      if (builds) detector.build(mesh.view());
      detector.query(spheres.view(), sink);
      collide::cuda_check(cudaStreamEndCapture(stream, &graph), "cudaStreamEndCapture");
      collide::cuda_check(cudaGraphInstantiate(&runs, graph, 0), "cudaGraphInstantiate");
      for (std::size_t const i : {1u, 0u, 0u, 2u, 3u}) {
        space.copy_from_host(const_cast<float*>(radii), scene.radii[i].data(), scene.radii[i].size());
        collide::cuda_check(cudaGraphLaunch(runs, stream), "cudaGraphLaunch");
        space.synchronize();
        collide::detector<collide::all_pairs, collide::karabassi<>, collide::cuda_shared> plain(space);
        plain.build(mesh.view());
        collide::any_hit expected;
        plain.query(spheres.view(), expected);
        CAPTURE(builds);
        CAPTURE(i);
        CHECK(sink.to_host() == expected.to_host());
      }
      collide::cuda_check(cudaGraphExecDestroy(runs), "cudaGraphExecDestroy");
      collide::cuda_check(cudaGraphDestroy(graph), "cudaGraphDestroy");
    }
  }
  collide::cuda_check(cudaStreamDestroy(stream), "cudaStreamDestroy");
}
