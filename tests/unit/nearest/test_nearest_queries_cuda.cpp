/// The sink `nearest` on CUDA.
#include "nearest/nearest_queries.hpp"

using collide::all_pairs, collide::bvh, collide::cuda_shared;

TEST_CASE_TEMPLATE("nearest: what a loop over all triangles finds, to the last bit, on CUDA", S, float, double) {
  tests::check_nearest<bvh, cuda_shared, S>(cuda_shared());
  tests::check_nearest<bvh, collide::cuda, S>(collide::cuda());
  tests::check_nearest<all_pairs, cuda_shared, S>(cuda_shared());
}

TEST_CASE_TEMPLATE("k nearest: each is the nearest of those that are left, to the last bit, on CUDA", S, float,
                   double) {
  tests::check_k_nearest<bvh, cuda_shared, S>(cuda_shared());
}

TEST_CASE("nearest: plain arithmetic finds what is about as near, on CUDA") {
  tests::check_plain_nearest<collide::single_precision, cuda_shared, float>(cuda_shared());
  tests::check_plain_nearest<collide::double_precision, cuda_shared, double>(cuda_shared());
}

TEST_CASE("nearest: a mesh in passes has the same ones, to the last bit, on CUDA") {
  tests::check_nearest_in_passes<bvh, collide::exact, cuda_shared, float>(cuda_shared());
}

TEST_CASE("tree: refit finds the nearest triangles of a mesh that has deformed, on CUDA") {
  for (auto const& made : tests::hard_meshes<float>(300)) {
    CAPTURE(made.name);
    auto before = made;
    for (std::size_t i = 0; i < before.corners.size(); ++i) before.corners[i] *= i % 18 < 9 ? 0.5f : 0.75f;
    auto const points = tests::points_around(made, 100);
    cuda_shared const space;
    auto const mesh = collide::upload(space, made.view()), old = collide::upload(space, before.view());
    auto const there = collide::upload(space, collide::spheres_xyz(points.data(), points.size() / 3, 0.0f));
    collide::detector<bvh, collide::karabassi<>, cuda_shared> built(space), refitted(space);
    built.build(mesh.view());
    refitted.build(old.view());
    refitted.refit(mesh.view());
    CHECK(tests::same_bytes(refitted.query(there.view().centres(), collide::nearest()).to_host(),
                            built.query(there.view().centres(), collide::nearest()).to_host()));
  }
}

TEST_CASE("nearest: nothing is allocated once there is room, on CUDA") {
  tests::counting_resource memory(collide::cuda_memory::get());
  tests::check_nearest_allocates_once<bvh>(cuda_shared(nullptr, &memory), memory);
}
