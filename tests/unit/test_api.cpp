/// The interface on the host.
#include <atomic>
#include <utility>

#include "api.hpp"
#include "compositions.hpp"

using collide::host;

TEST_CASE("api: sinks on the host") {
  tests::check_sink_interface<collide::all_pairs>(host());
  tests::check_sink_interface<collide::bucket>(host(1));
}

TEST_CASE("api: the baseline precision on the host") {
  tests::check_baseline<collide::all_pairs>(host());
  tests::check_baseline<collide::bucket>(host());
}

TEST_CASE("api: a sink or a detector that was used, or moved, is used again with other memory") {
  tests::small_scene const scene;
  tests::dirty_resource memory[2];
  collide::detector<collide::bucket> first(host(1, &memory[0])), second(host(2, &memory[1]));
  first.build(scene.mesh());
  second.build(scene.mesh());
  collide::count count;
  collide::pairs pairs;
  for (auto* const detector : {&first, &second, &first}) {
    CHECK(detector->query(scene.spheres(), count).total() == 4);
    CHECK(detector->query(scene.spheres(), pairs).total() == 4);
  }
  auto const moved_count = std::move(count);
  auto const moved_pairs = std::move(pairs);
  CHECK(moved_count.total() == 4);
  CHECK(moved_pairs.size() == 4);
  CHECK(first.query(scene.spheres(), count).total() == 4);
  CHECK(first.query(scene.spheres(), pairs).total() == 4);

  collide::detector<collide::bucket, collide::karabassi<>, tests::lockstep<64, true>> steps(
      tests::lockstep<64, true>(1, &memory[0]));
  CHECK(steps.detect(scene.mesh(), scene.spheres(), count).total() == 4);
  auto moved = std::move(steps);
  CHECK(moved.query(scene.spheres(), count).total() == 4);
  CHECK(steps.detect(scene.mesh(), scene.spheres(), count).total() == 4);
}

TEST_CASE("api: uploads on the host") { tests::check_uploads(host()); }

TEST_CASE("api: validate on the host") { tests::check_validate(host()); }

TEST_CASE("api: what is told to be device memory is refused by validate and upload on the host") {
  tests::small_scene const scene;
  static void const* there = nullptr;
  auto const before = std::exchange(collide::detail::in_device_memory, [](void const* p) { return p == there; });
  CHECK(collide::validate(scene.mesh()).ok());
  CHECK(collide::validate(scene.spheres()).ok());
  for (void const* array :
       {static_cast<void const*>(scene.vertices.data()), static_cast<void const*>(scene.corners.data())}) {
    there = array;
    CHECK_THROWS_WITH_AS(
        collide::validate(scene.mesh()),
        "collide: validate: the mesh is in device memory, which the space `host` cannot read: pass the "
        "space of that memory, as validate(mesh, space)",
        collide::error);
    CHECK_THROWS_AS(collide::upload(host(), scene.mesh()), collide::error);
  }
  for (float const* array : {scene.xyz.data() + 2, scene.radii.data()}) {
    there = array;
    CHECK_THROWS_AS(collide::validate(scene.spheres()), collide::error);
    CHECK_THROWS_AS(collide::upload(host(), scene.spheres()), collide::error);
  }
  CHECK(collide::validate(collide::mesh_view<float>()).ok());
  collide::detail::in_device_memory = before;
}

TEST_CASE("api: memory of the host") {
  tests::check_memory<host>([](std::pmr::memory_resource* from) { return host(2, from); },
                            std::pmr::new_delete_resource());
}

TEST_CASE("api: views read what they are made of") {
  double const vertices[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  unsigned const corners[] = {3, 0, 1};
  auto const mesh = collide::indexed_mesh(vertices, 4, corners, 1);
  CHECK(mesh.size() == 1);
  CHECK(mesh[0].a == collide::vec3<double>(9, 10, 11));
  CHECK(mesh[0].c == collide::vec3<double>(3, 4, 5));
  CHECK(collide::triangle_soup(vertices, 1)[0].b == collide::vec3<double>(3, 4, 5));

  CHECK(collide::spheres_xyz(vertices, 4, 2)[3].centre == collide::vec3<double>(9, 10, 11));
  CHECK(collide::spheres_xyz(vertices, 4, 2)[3].radius == 2);
  CHECK(collide::spheres_xyz(vertices, 4, vertices)[3].radius == 3);
  auto const quadruple = collide::spheres_xyzr(vertices, 3)[2];
  CHECK(quadruple.centre == collide::vec3<double>(8, 9, 10));
  CHECK(quadruple.radius == 11);
  auto const separate = collide::spheres_soa(vertices, vertices + 4, vertices + 8, 4, vertices + 1);
  CHECK(separate[2].centre == collide::vec3<double>(2, 6, 10));
  CHECK(separate[2].radius == 3);
  CHECK(collide::spheres_soa(vertices, vertices + 4, vertices + 8, 4, 7).radius(3) == 7);
  CHECK(collide::mesh_view<float>().size() == 0);
  CHECK(collide::sphere_view<float>().size() == 0);
}

TEST_CASE("api: what cannot be is refused with an error") {
  float const some[3] = {};
  int const corners[3] = {};
  CHECK_THROWS_AS(host(-1), collide::error);
  CHECK_THROWS_AS(collide::triangle_soup(some, 0xffffffff), collide::error);
  CHECK_THROWS_AS(collide::indexed_mesh(some, 1, corners, 0xffffffff), collide::error);
  CHECK_THROWS_AS(collide::spheres_xyz(some, 0xffffffff, 1), collide::error);
  CHECK_THROWS_AS(collide::spheres_xyzr(some, std::size_t{1} << 40), collide::error);
  CHECK(collide::spheres_xyz(some, 0xfffffffe, 1).size() == 0xfffffffe);
}

TEST_CASE("api: a detector is composed by naming the broad phase alone") {
  tests::small_scene const scene;
  collide::detector<collide::bucket> bucket;
  collide::detector<collide::all_pairs> all_pairs;
  CHECK(bucket.detect(scene.mesh(), scene.spheres(), collide::count()).total() == 4);
  CHECK(all_pairs.detect(scene.mesh(), scene.spheres(), collide::count()).total() == 4);
  CHECK(bucket.cell_width() > 0);
  CHECK(all_pairs.cell_width() == 0);
}

TEST_CASE("api: a visitor is called for each pair, and what it throws comes out of the query") {
  tests::small_scene const scene;
  collide::detector<collide::bucket> detector(host(3));
  detector.build(scene.mesh());
  std::atomic<int> calls{0};
  detector.query(scene.spheres(), collide::visit([&](auto const& hit) {
                   ++calls;
                   if (hit.contact().sphere != hit.sphere || hit.contact().triangle != hit.triangle) calls += 100;
                 }));
  CHECK(calls == 4);
  auto const refuse = [](auto const&) { throw std::runtime_error("enough"); };
  CHECK_THROWS_WITH(detector.query(scene.spheres(), collide::visit(refuse)), "enough");
  CHECK(detector.query(scene.spheres(), collide::count()).total() == 4);
}

TEST_CASE("api: single precision over doubles that float cannot hold") {
  for (double s : {1.0, 1e-46, 1e-100, 1e60}) {
    CAPTURE(s);
    double const corners[] = {-10 * s, -10 * s, 5 * s, 10 * s, -10 * s, 5 * s, 0, 10 * s, 5 * s};
    double const centre[] = {0, 0, 0};
    auto const hits = [&](auto detector, double radius) {
      detector.build(collide::triangle_soup(corners, 1));
      return detector.query(collide::spheres_xyz(centre, 1, radius), collide::count()).total();
    };
    using narrow = collide::karabassi<collide::single_precision>;
    for (double const radius : {s, 6 * s}) {
      std::uint64_t const expected = radius > 5 * s ? 1 : 0;
      CHECK(hits(collide::detector<collide::all_pairs, narrow, collide::host, double>(), radius) == expected);
      CHECK(hits(collide::detector<collide::bucket, narrow, collide::host, double>(), radius) == expected);
    }
  }
}

TEST_CASE("api: more spheres near the mesh, or far from it, than blocks go through at a time") {
  constexpr std::size_t n = 20001;
  using steps = tests::lockstep<64, true>;
  for (std::size_t const apart : {std::size_t{1}, std::size_t{61}}) {
    tests::check_crowd<collide::karabassi<>, steps>(n, apart);
    tests::check_crowd<collide::karabassi<collide::single_precision>, steps>(n, apart);
    tests::check_crowd<collide::karabassi_swept<>, steps>(n, apart);
  }
}
