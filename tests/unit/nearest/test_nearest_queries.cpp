/// The sink `nearest` on the host.
#include <atomic>

#include <collide/ranks/distributed.hpp>
#include <collide/ranks/thread_ranks.hpp>

#include "execution/lockstep.hpp"
#include "nearest/nearest_queries.hpp"

using collide::all_pairs, collide::bvh, collide::host;
using in_lockstep = tests::lockstep<64, false>;

TEST_CASE_TEMPLATE("nearest: what a loop over all triangles finds, to the last bit", S, float, double) {
  tests::check_nearest<bvh, host, S>(host(2));
  tests::check_nearest<bvh, in_lockstep, S>(in_lockstep(1));
  tests::check_nearest<all_pairs, host, S>(host(1));
}

TEST_CASE_TEMPLATE("k nearest: each is the nearest of those that are left, to the last bit", S, float, double) {
  tests::check_k_nearest<bvh, host, S>(host(2));
  tests::check_k_nearest<bvh, in_lockstep, S>(in_lockstep(1));
  tests::check_k_nearest<all_pairs, host, S>(host(1));
}

TEST_CASE("nearest: plain arithmetic finds what is about as near") {
  tests::check_plain_nearest<collide::single_precision, host, float>(host(1));
  tests::check_plain_nearest<collide::double_precision, host, float>(host(1));
  tests::check_plain_nearest<collide::double_precision, host, double>(host(1));
}

TEST_CASE("nearest: a mesh in passes has the same ones, to the last bit") {
  tests::check_nearest_in_passes<bvh, collide::exact, host, float>(host(2));
  tests::check_nearest_in_passes<bvh, collide::exact, host, double>(host(1));
  tests::check_nearest_in_passes<all_pairs, collide::single_precision, host, float>(host(1));
  tests::check_nearest_in_passes<bvh, collide::exact, in_lockstep, float>(in_lockstep(1));
}

namespace {

/// A mesh that ranks divide has the nearest triangles that one detector of all finds.
template <class S>
void check_nearest_on_ranks(int ranks, std::size_t chunk) {
  for (auto const& made : tests::hard_meshes<S>(50)) {
    CAPTURE(made.name);
    auto const points = tests::points_around(made, 49);
    S const radius = made.extent() / 64;
    collide::detector<bvh, collide::karabassi<>, host, S> whole(host(1));
    whole.build(made.view());
    for (S const most : {std::numeric_limits<S>::infinity(), made.extent() / 16}) {
      auto const expected =
          whole.query(collide::spheres_xyz(points.data(), points.size() / 3, radius), collide::nearest<S>(most))
              .to_host();
      std::atomic<int> wrong{0};
      collide::thread_ranks::run(ranks, [&](collide::thread_ranks const& r) {
        auto const me = static_cast<std::size_t>(r.rank()), n = static_cast<std::size_t>(r.size());
        auto const share = [&](std::size_t all, std::size_t k) { return all * k / n; };
        std::size_t const t = share(made.size(), me), p = share(points.size() / 3, me),
                          own = share(points.size() / 3, me + 1) - p;
        collide::distributed<collide::detector<bvh, collide::karabassi<>, host, S>, collide::thread_ranks> divided(
            r, host(1), bvh(), chunk);
        divided.build(made.view().subview(t, share(made.size(), me + 1) - t), collide::divided);
        collide::nearest<S> found(most);
        for (int again = 0; again < 2; ++again) {
          divided.query(collide::spheres_xyz(points.data() + 3 * p, own, radius), found);
          std::vector<collide::nearest_triangle<S>> const mine(expected.begin() + static_cast<std::ptrdiff_t>(p),
                                                               expected.begin() + static_cast<std::ptrdiff_t>(p + own));
          wrong += !tests::same_bytes(found.to_host(), mine);
        }
      });
      CHECK(wrong == 0);
    }
  }
}

}  // namespace

TEST_CASE_TEMPLATE("nearest: a mesh that ranks divide has the same ones, to the last bit", S, float, double) {
  check_nearest_on_ranks<S>(2, 7);
  check_nearest_on_ranks<S>(3, 1000);
}

TEST_CASE("nearest: nothing is allocated once there is room") {
  tests::counting_resource memory(std::pmr::new_delete_resource());
  tests::check_nearest_allocates_once<bvh>(host(2, &memory), memory);
  tests::check_nearest_allocates_once<bvh>(in_lockstep(1, &memory), memory);
  tests::check_nearest_allocates_once<all_pairs>(host(1, &memory), memory);
}

TEST_CASE("nearest: a largest distance that is none is refused") {
  CHECK_THROWS_WITH_AS(collide::nearest<float>(-1), "collide: nearest: the largest distance is negative or NaN",
                       collide::error);
  CHECK_THROWS_AS(collide::nearest<double>(std::nan("")), collide::error);
  CHECK_THROWS_AS(collide::k_nearest<double>(3, std::nan("")), collide::error);
  CHECK_THROWS_WITH_AS(collide::k_nearest<float>(0), "collide: k_nearest: k is not from 1 to 32", collide::error);
  CHECK_THROWS_AS(collide::k_nearest<float>(33), collide::error);
}

TEST_CASE("nearest: points go to other sinks as spheres of radius 0") {
  float const corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, at[] = {0.25f, 0.25f, 0, 0.25f, 0.25f, 1e-30f};
  collide::detector<bvh> detector;
  detector.build(collide::triangle_soup(corners, 1));
  auto const points = collide::points(at, 2);
  CHECK(detector.query(points, collide::count()).total() == 1);
  auto const found = detector.query(points, collide::nearest()).to_host();
  CHECK(found[0].distance == 0);
  CHECK(found[1].distance == 1e-30f);
  CHECK(found[1].feature == collide::feature::face);
  CHECK(found[1].barycentric == collide::vec3<float>(0.5f, 0.25f, 0.25f));
}
