/// Bodies with poses on the host.
#include <atomic>
#include <string>

#include <collide/bucket.cuh>
#include <collide/bvh.cuh>

#include "execution/lockstep.hpp"
#include "streaming/posed.hpp"

using collide::bucket, collide::bvh, collide::detector, collide::host, collide::karabassi;
using in_lockstep = tests::lockstep<64, false>;
using on_host = detector<bucket>;
using tree_of_double = detector<bvh, karabassi<>, host, double>;
using cooperating = detector<bucket, karabassi<>, in_lockstep>;

TEST_CASE("posed: what a loop finds in the frames of bodies") {
  tests::check_posed<on_host>(host(2));
  tests::check_posed<tree_of_double>(host(2));
  tests::check_posed<cooperating>(in_lockstep(1));
}

TEST_CASE("posed: bodies so small that squares vanish") {
  tests::check_posed_tiny<on_host>(host(1));
  tests::check_posed_tiny<tree_of_double>(host(1));
}

TEST_CASE("posed: with half turns what a detector finds in the world") {
  tests::check_half_turns<on_host>(host(2));
  tests::check_half_turns<tree_of_double>(host(1));
  tests::check_half_turns<cooperating>(in_lockstep(1));
}

TEST_CASE("posed: the nearest triangle of all bodies, as a loop finds it") {
  tests::check_posed_nearest<tree_of_double>(host(2));
  tests::check_posed_nearest<detector<bvh>>(host(1));
}

TEST_CASE("posed: the k nearest triangles of all bodies, as a loop finds them") {
  tests::check_posed_k_nearest<tree_of_double>(host(2));
  tests::check_posed_k_nearest<detector<bvh>>(host(1));
}

TEST_CASE("posed: impacts of spheres that move past bodies, as a loop finds them") {
  tests::check_posed_impacts<detector<bucket, collide::karabassi_swept<>>>(host(2));
  tests::check_posed_impacts<detector<bvh, collide::karabassi_swept<>, host, double>>(host(1));
  tests::check_posed_impacts<detector<bucket, collide::karabassi_swept<>, in_lockstep>>(in_lockstep(1));
}

TEST_CASE("posed: inside, and the signed distance of all bodies, as each says alone") {
  tests::check_posed_sides<tree_of_double>(host(2));
  tests::check_posed_sides<detector<bvh>>(host(1));
}

TEST_CASE("posed: nothing is allocated once there is room") {
  tests::counting_resource memory(std::pmr::new_delete_resource());
  tests::check_posed_keeps_memory<on_host>(host(1, &memory), memory);
  tests::check_posed_keeps_memory<tree_of_double>(host(1, &memory), memory);
}

TEST_CASE("posed: a function gets hits in the world") {
  float const corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, centre[] = {5.25f, 0.25f, 0.25f};
  collide::posed<on_host> robot;
  robot.build(collide::triangle_soup(corners, 1), {{0, 1, {}}});
  collide::pose there;
  there.position[0] = 5;
  std::atomic<int> calls{0};
  robot.query(collide::spheres_xyz(centre, 1, 0.5f), {there}, collide::visit([&](auto const& hit) {
                ++calls;
                CHECK(hit.contact().point == collide::vec3<float>(5.25f, 0.25f, 0));
                CHECK(hit.contact().distance == 0.25f);
              }));
  CHECK(calls == 1);
}

TEST_CASE("posed: bodies and poses that make no sense are refused") {
  float const corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, centre[] = {0, 0, 0};
  auto const mesh = collide::triangle_soup(corners, 1);
  auto const sphere = collide::spheres_xyz(centre, 1, 1.0f);
  collide::posed<on_host> robot;
  CHECK_THROWS_WITH_AS(robot.query(sphere, {}, collide::count()),
                       "collide: posed: query needs a mesh: call build before it", collide::error);
  CHECK_THROWS_WITH_AS(robot.build(mesh, {{0, 2, {}}}),
                       "collide: posed: body 0 has triangles that the mesh does not have", collide::error);
  CHECK_THROWS_AS(robot.query(sphere, {{}}, collide::count()), collide::error);
  robot.build(mesh, {{0, 1, {}}});
  CHECK_THROWS_WITH_AS(robot.query(sphere, {}, collide::count()), "collide: posed: query needs a pose for each body",
                       collide::error);
  collide::pose bad;
  std::string const sentence =
      "collide: posed: the pose of body 0 is not finite, or its rotation is no unit quaternion";
  bad.rotation[0] = 1.1;
  CHECK_THROWS_WITH_AS(robot.query(sphere, {bad}, collide::count()), sentence.c_str(), collide::error);
  bad = {};
  bad.position[2] = std::nan("");
  CHECK_THROWS_WITH_AS(robot.query(sphere, {bad}, collide::count()), sentence.c_str(), collide::error);
  CHECK(robot.query(sphere, {{}}, collide::count()).total() == 1);
  robot.build(collide::mesh_view<float>(), {});
  CHECK(robot.query(sphere, {}, collide::count()).total() == 0);
}
