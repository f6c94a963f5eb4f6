/// \file
/// Bodies with poses in a space, against a loop over all triangles.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory_resource>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/all_pairs.cuh>
#include <collide/detectors/posed.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/sinks/csr.hpp>
#include <collide/sinks/earliest.hpp>
#include <collide/sinks/impacts.hpp>
#include <collide/sinks/k_nearest.hpp>
#include <collide/spaces/upload.hpp>

#include "nearest/point_cases.hpp"
#include "type_erased_detector.hpp"

namespace tests {

/// A robot of triangles, and what is around it.
template <class S>
struct posed_scene {
  std::vector<S> corners, xyz, radii;
  std::vector<collide::body> bodies;
  std::mt19937 engine{17};

  S uniform() { return std::uniform_real_distribution<S>(-1, 1)(engine); }
  std::size_t triangles() const { return corners.size() / 9; }
  collide::mesh_view<S> mesh() const { return collide::triangle_soup(corners.data(), triangles()); }

  void add_triangles(std::size_t n, S away) {
    for (std::size_t i = 0; i < n; ++i) {
      collide::vec3<S> const at(away + uniform(), uniform(), uniform());
      for (int k = 0; k < 9; ++k) corners.push_back(at[k % 3] + uniform());
    }
  }

  /// Ten links, one without triangles and one far from its own origin, and triangles of none between them.
  posed_scene() {
    add_triangles(5, 0);
    for (std::size_t link = 0; link < 10; ++link) {
      std::size_t const first = triangles(), size = link == 3 ? 0 : 10 + link;
      add_triangles(size, link == 6 ? S(1000) : S(0));
      bodies.push_back({first, size, {}});
      if (link == 4) add_triangles(3, 0);
    }
    std::swap(bodies[1], bodies[8]);  // in any order
    for (std::size_t i = 0; i < 600; ++i) {
      for (int k = 0; k < 3; ++k) xyz.push_back(3 * uniform());
      radii.push_back(S(0.2) + uniform() / 8);
    }
    S const nan = std::numeric_limits<S>::quiet_NaN(), infinite = std::numeric_limits<S>::infinity();
    xyz[3] = nan, xyz[7] = infinite, radii[3] = nan, radii[4] = -1, radii[5] = infinite;
  }

  /// A pose somewhere, of any rotation.
  std::vector<collide::pose> any_poses() {
    std::vector<collide::pose> all(bodies.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
      double squared = 0;
      for (double& q : all[k].rotation) {
        q = double(uniform());
        squared += q * q;
      }
      for (double& q : all[k].rotation) q /= std::sqrt(squared);
      for (double& p : all[k].position) p = 2 * double(uniform());
      if (bodies[k].size != 0 && std::abs(corners[9 * bodies[k].first]) > 500) {  // back from where its triangles are
        auto const there = all[k](collide::vec3<double>(1000, 0, 0));
        for (int j = 0; j < 3; ++j) all[k].position[j] -= there[j];
      }
    }
    return all;
  }

  /// The body of each triangle; 0 is none.
  std::vector<std::size_t> owners() const {
    std::vector<std::size_t> all(triangles());
    for (std::size_t k = 0; k < bodies.size(); ++k)
      for (std::size_t i = 0; i < bodies[k].size; ++i) all[bodies[k].first + i] = k + 1;
    return all;
  }
};

/// The contacts, in canonical order, each computed in the frame of its body.
template <class S>
std::vector<collide::contact<S>> posed_by_loop(posed_scene<S> const& scene, std::vector<collide::pose> const& poses,
                                               collide::sphere_view<S> const& spheres) {
  using collide::detail::rounded_to;
  std::vector<collide::contact<S>> all;
  auto const owners = scene.owners();
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (std::size_t t = 0; t < scene.triangles(); ++t) {
      collide::sphere<S> seen = spheres[i];
      collide::detail::frame_pose frame = collide::detail::frame_pose_of({});
      if (owners[t] != 0) {
        collide::body_state state;
        state.at = poses[owners[t] - 1];
        collide::detail::make_unit(state);
        frame = collide::detail::frame_pose_of(state.at);
        seen.centre = rounded_to<S>(frame.to_local(seen.centre.template cast<double>()));
      }
      if (!collide::karabassi<>::intersects(scene.mesh()[t], seen)) continue;
      auto c = collide::karabassi<>::contact_of(scene.mesh()[t], seen);
      c.sphere = static_cast<collide::id>(i);
      c.triangle = static_cast<collide::id>(t);
      if (owners[t] != 0) {
        c.point = rounded_to<S>(frame.to_world(c.point.template cast<double>()));
        c.normal = rounded_to<S>(frame.rotated(c.normal.template cast<double>()));
      }
      all.push_back(c);
    }
  }
  return all;
}

template <class S>
bool same_contacts(std::vector<collide::contact<S>> const& a, std::vector<collide::contact<S>> const& b) {
  bool same = a.size() == b.size();
  for (std::size_t i = 0; same && i < a.size(); ++i)
    same = a[i].sphere == b[i].sphere && a[i].triangle == b[i].triangle && a[i].point == b[i].point &&
           a[i].normal == b[i].normal && a[i].distance == b[i].distance && a[i].depth == b[i].depth;
  return same;
}

/// Spheres that just touch the end of a triangle, which is where the sphere around its body ends, from a size on whose
/// square is not a number of S any more.
template <class Detector>
void check_posed_tiny(typename Detector::execution_space const& space) {
  using S = typename Detector::scalar;
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  collide::posed<Detector> robot(space);
  S const least = std::sqrt(std::numeric_limits<S>::min());
  for (int power = -12; power < 8; ++power) {
    CAPTURE(power);
    S const scale = std::ldexp(least, power);
    S corners[9] = {};
    for (int k = 0; k < 3; ++k) corners[3 + k] = scale * static_cast<S>(uniform(engine));
    collide::vec3<S> const end(corners[3] / scale, corners[4] / scale, corners[5] / scale);
    std::vector<S> xyz, radii;
    for (int i = 0; i < 100; ++i) {
      double const away = 2 * uniform(engine);
      for (int k = 0; k < 3; ++k) xyz.push_back(static_cast<S>(1 + away) * corners[3 + k]);
      radii.push_back(static_cast<S>(1.0001 * away) * end.norm() * scale);
    }
    auto const mesh = collide::triangle_soup(static_cast<S const*>(corners), 1);
    auto const spheres = collide::spheres_xyz(xyz.data(), radii.size(), radii.data());
    std::size_t expected = 0;
    for (std::size_t i = 0; i < spheres.size(); ++i) expected += collide::karabassi<>::intersects(mesh[0], spheres[i]);
    CHECK(expected > 90);
    auto const mesh_there = collide::upload(space, mesh);
    auto const there = collide::upload(space, spheres);
    robot.build(mesh_there.view(), {{0, 1, {}}});
    CHECK(robot.query(there.view(), {{}}, collide::count()).total() == expected);
  }
}

/// Every sink, pose after pose, with one radius and with many.
template <class Detector>
void check_posed(typename Detector::execution_space const& space) {
  using S = typename Detector::scalar;
  using collide::order;
  posed_scene<S> scene;
  auto const mesh = collide::upload(space, scene.mesh());
  collide::posed<Detector> robot(space);
  robot.build(mesh.view(), scene.bodies);
  CHECK(robot.size() == 10);
  std::size_t const n = scene.radii.size();
  for (int frame = 0; frame < 4; ++frame) {
    auto const poses = scene.any_poses();
    auto const on_host = frame % 2 == 0 ? collide::spheres_xyz(scene.xyz.data(), n, scene.radii.data())
                                        : collide::spheres_xyz(scene.xyz.data(), n, S(0.25));
    auto const there = collide::upload(space, on_host);
    auto const expected = posed_by_loop(scene, poses, on_host);
    CHECK(expected.size() > 250);
    CHECK(same_contacts(robot.query(there.view(), poses, collide::contacts<S>(order::canonical)).to_host(), expected));
    CHECK(robot.query(there.view(), poses, collide::count()).total() == expected.size());
    auto const sorted = robot.query(there.view(), poses, collide::pairs(order::canonical)).to_host();
    std::vector<std::uint8_t> touched(n);
    std::vector<S> nearest(n, std::numeric_limits<S>::infinity());
    bool same = sorted.size() == expected.size();
    for (std::size_t i = 0; i < expected.size(); ++i) {
      auto const& c = expected[i];
      same = same && sorted[i].sphere == c.sphere && sorted[i].triangle == c.triangle;
      touched[c.sphere] = 1;
      nearest[c.sphere] = std::min(nearest[c.sphere], c.distance);
    }
    CHECK(same);
    CHECK(robot.query(there.view(), poses, collide::any_hit()).to_host() == touched);
    CHECK(robot.query(there.view(), poses, collide::csr(order::canonical)).to_host().offsets.back() == expected.size());
    auto const closest = robot.query(there.view(), poses, collide::closest<S>()).to_host();
    auto const closest_contacts = robot.query(there.view(), poses, collide::closest_contact<S>()).to_host();
    for (std::size_t i = 0; i < n; ++i) {
      CHECK(closest[i].distance == nearest[i]);
      CHECK(closest_contacts[i].triangle == closest[i].triangle);
    }
    // contacts are where the sphere is in the world
    for (auto const& c : closest_contacts) {
      if (c.triangle == collide::no_id || !(on_host.radius(c.sphere) < 1)) continue;
      S const far = (c.point - on_host.centre(c.sphere)).norm();
      CHECK(std::abs(far - c.distance) < 1000 * 8 * std::numeric_limits<S>::epsilon());
    }
  }
  CHECK(robot.query(collide::sphere_view<S>(), scene.any_poses(), collide::count()).total() == 0);
}

/// Half turns and shifts by few bits are exact: so it finds what a detector finds of the mesh as it is in the world.
template <class Detector>
void check_half_turns(typename Detector::execution_space const& space) {
  using S = typename Detector::scalar;
  using collide::order;
  posed_scene<S> scene;
  for (S& x : scene.corners) x = std::ldexp(std::nearbyint(std::ldexp(x, 8)), -8);  // sums are exact
  for (S& x : scene.xyz) x = std::ldexp(std::nearbyint(std::ldexp(x, 8)), -8);
  std::vector<collide::pose> poses(scene.bodies.size());
  std::vector<S> world = scene.corners;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    for (int j = 0; j < 4; ++j) poses[k].rotation[j] = std::size_t(j) == k % 4 ? (k % 3 == 0 ? -1 : 1) : 0;
    for (double& p : poses[k].position) p = double(scene.engine() % 17) / 4 - 2;
    for (std::size_t i = 9 * scene.bodies[k].first; i < 9 * (scene.bodies[k].first + scene.bodies[k].size); ++i) {
      bool const keeps = k % 4 == 0 || i % 3 + 1 == k % 4;
      world[i] = S(poses[k].position[i % 3]) + (keeps ? world[i] : -world[i]);
    }
  }
  std::size_t const n = scene.radii.size();
  auto const spheres = collide::upload(space, collide::spheres_xyz(scene.xyz.data(), n, scene.radii.data()));
  auto const mesh = collide::upload(space, scene.mesh());
  auto const world_mesh = collide::upload(space, collide::triangle_soup(world.data(), scene.triangles()));
  Detector plain(space);
  plain.build(world_mesh.view());
  collide::posed<Detector> robot(space);
  robot.build(mesh.view(), scene.bodies, S(0.5));
  auto const expected = plain.query(spheres.view(), collide::pairs(order::canonical)).to_host();
  auto const found = robot.query(spheres.view(), poses, collide::pairs(order::canonical)).to_host();
  CHECK(expected.size() > 250);
  bool same = found.size() == expected.size();
  for (std::size_t i = 0; same && i < found.size(); ++i)
    same = found[i].sphere == expected[i].sphere && found[i].triangle == expected[i].triangle;
  CHECK(same);
}

/// The nearest triangle over all bodies, each searched in its frame.
template <class S>
std::vector<collide::nearest_triangle<S>> nearest_posed_by_loop(posed_scene<S> const& scene,
                                                                std::vector<collide::pose> const& poses,
                                                                collide::sphere_view<S> const& spheres, S most) {
  using collide::detail::rounded_to;
  std::vector<collide::nearest_triangle<S>> all;
  auto const owners = scene.owners();
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    collide::nearest_triangle<S> best{};
    best.triangle = collide::no_id;
    best.distance = std::numeric_limits<S>::infinity();
    for (std::size_t owner = 0; owner <= poses.size(); ++owner) {
      collide::body_state state;
      if (owner != 0) state.at = poses[owner - 1];
      collide::detail::make_unit(state);
      auto const frame = collide::detail::frame_pose_of(state.at);
      auto centre = spheres.centre(i);
      if (owner != 0) centre = rounded_to<S>(frame.to_local(centre.template cast<double>()));
      collide::detail::nearest_search<S, collide::exact> search(centre, most);
      for (collide::id t = 0; t < scene.triangles(); ++t)
        if (owners[t] == owner) search.consider(scene.mesh()[t], t);
      auto n = search.result();
      if (n.triangle == collide::no_id) continue;
      if (owner != 0) n.point = rounded_to<S>(frame.to_world(n.point.template cast<double>()));
      if (n.distance < best.distance || (n.distance == best.distance && n.triangle < best.triangle)) best = n;
    }
    all.push_back(best);
  }
  return all;
}

template <class Detector>
void check_posed_nearest(typename Detector::execution_space const& space) {
  using S = typename Detector::scalar;
  posed_scene<S> scene;
  auto const mesh = collide::upload(space, scene.mesh());
  std::size_t const n = scene.radii.size();
  auto const on_host = collide::spheres_xyz(scene.xyz.data(), n, S(0));
  auto const there = collide::upload(space, on_host);
  collide::posed<Detector> robot(space);
  robot.build(mesh.view(), scene.bodies);
  for (S const most : {std::numeric_limits<S>::infinity(), S(0.5)}) {
    auto const poses = scene.any_poses();
    auto const expected = nearest_posed_by_loop(scene, poses, on_host, most);
    auto const found = robot.query(there.view().centres(), poses, collide::nearest<S>(most)).to_host();
    std::size_t wrong = 0, none = 0;
    for (std::size_t i = 0; i < n; ++i) {
      none += expected[i].triangle == collide::no_id;
      wrong += found[i].triangle != expected[i].triangle || found[i].distance != expected[i].distance ||
               (found[i].triangle != collide::no_id && !(found[i].point == expected[i].point));
    }
    CHECK(found.size() == n);
    CHECK(wrong == 0);
    CHECK(none >= 2);  // a NaN and an infinite coordinate
    CHECK(none < n);
  }
  // spheres with a radius each: to their surface
  auto const spheres = collide::upload(space, collide::spheres_xyz(scene.xyz.data(), n, scene.radii.data()));
  auto const poses = scene.any_poses();
  auto const to_surface = robot.query(spheres.view(), poses, collide::nearest<S>()).to_host();
  auto const to_centre = robot.query(there.view(), poses, collide::nearest<S>()).to_host();
  for (std::size_t i = 6; i < n; ++i) CHECK(to_surface[i].distance == to_centre[i].distance - scene.radii[i]);
  robot.build(collide::mesh_view<S>(), {});
  CHECK(robot.query(there.view(), {}, collide::nearest<S>()).to_host()[n - 1].triangle == collide::no_id);
}

/// The k nearest triangles of all bodies, each searched alone in its frame.
template <class Detector>
void check_posed_k_nearest(typename Detector::execution_space const& space) {
  using S = typename Detector::scalar;
  using collide::detail::rounded_to;
  posed_scene<S> scene;
  std::size_t const n = scene.radii.size();
  auto const mesh = collide::upload(space, scene.mesh());
  auto const on_host = collide::spheres_xyz(scene.xyz.data(), n, S(0));
  auto const there = collide::upload(space, on_host);
  auto const owners = scene.owners();
  collide::posed<Detector> robot(space);
  robot.build(mesh.view(), scene.bodies);
  for (S const most : {std::numeric_limits<S>::infinity(), S(0.5)}) {
    auto const poses = scene.any_poses();
    std::vector<collide::detail::frame_pose> frames(1 + poses.size());
    for (std::size_t k = 0; k < frames.size(); ++k) {
      collide::body_state state;
      if (k != 0) state.at = poses[k - 1];
      collide::detail::make_unit(state);
      frames[k] = collide::detail::frame_pose_of(state.at);
    }
    constexpr int k = 12;
    auto const found = robot.query(there.view().centres(), poses, collide::k_nearest<S>(k, most)).to_host();
    REQUIRE(found.size() == k * n);
    std::size_t wrong = 0, none = 0;
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<collide::nearest_triangle<S>> all(scene.triangles());
      for (collide::id t = 0; t < all.size(); ++t) {
        auto centre = on_host.centre(i);
        auto const& frame = frames[owners[t]];
        if (owners[t] != 0) centre = rounded_to<S>(frame.to_local(centre.template cast<double>()));
        collide::detail::nearest_search<S, collide::exact> alone(centre, most);
        alone.consider(scene.mesh()[t], t);
        all[t] = alone.result();
        if (owners[t] != 0 && all[t].triangle != collide::no_id)
          all[t].point = rounded_to<S>(frame.to_world(all[t].point.template cast<double>()));
      }
      auto sorted = all;
      std::sort(sorted.begin(), sorted.end(), [](auto const& a, auto const& b) { return a.distance < b.distance; });
      for (std::size_t j = 0; j < k; ++j) {
        auto const& one = found[k * i + j];
        none += one.triangle == collide::no_id;
        wrong += one.distance != sorted[j].distance;
        if (one.triangle == collide::no_id) continue;
        wrong += !(one.point == all[one.triangle].point) || one.distance != all[one.triangle].distance;
        for (std::size_t m = 0; m < j; ++m) wrong += found[k * i + m].triangle == one.triangle;
      }
    }
    CHECK(wrong == 0);
    CHECK(none >= 2 * k);
    CHECK(none < k * n);
  }
}

/// Spheres that move past bodies that rest in their poses: every impact is that of the sphere as its body sees it.
template <class Detector>
void check_posed_impacts(typename Detector::execution_space const& space) {
  using S = typename Detector::scalar;
  using collide::detail::rounded_to;
  posed_scene<S> scene;
  std::size_t const n = scene.radii.size();
  std::vector<S> paths;
  for (std::size_t i = 0; i < 3 * n; ++i) paths.push_back(i % 30 < 3 ? S(0) : 2 * scene.uniform());
  paths[20] = std::numeric_limits<S>::quiet_NaN(), paths[31] = std::numeric_limits<S>::infinity();
  auto const mesh = collide::upload(space, scene.mesh());
  auto const owners = scene.owners();
  collide::posed<Detector> robot(space);
  robot.build(mesh.view(), scene.bodies);
  for (bool const one_radius : {false, true}) {
    auto const resting = one_radius ? collide::spheres_xyz(scene.xyz.data(), n, S(0.125))
                                    : collide::spheres_xyz(scene.xyz.data(), n, scene.radii.data());
    auto const spheres = collide::with_displacements(resting, paths.data());
    auto const spheres_there = collide::upload(space, resting);
    auto const paths_there = collide::upload(space, collide::spheres_xyz(paths.data(), n, S(0)));
    auto const there = collide::with_displacements(spheres_there.view(), paths_there.view().centres());
    auto const poses = scene.any_poses();
    auto const found = robot.query(there, poses, collide::impacts<S>(collide::order::canonical)).to_host();
    std::vector<S> first(n, std::numeric_limits<S>::infinity());
    std::size_t place = 0, wrong = 0;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t t = 0; t < scene.triangles(); ++t) {
        collide::moving_sphere<S> seen = spheres[i];
        collide::body_state state;
        if (owners[t] != 0) state.at = poses[owners[t] - 1];
        collide::detail::make_unit(state);
        auto const frame = collide::detail::frame_pose_of(state.at);
        if (owners[t] != 0) {
          auto const begin = seen.centre.template cast<double>(), path = seen.displacement.template cast<double>();
          auto const from = frame.to_local(begin), to = frame.to_local(begin + path);
          seen.centre = rounded_to<S>(from);
          seen.displacement = rounded_to<S>(to - from);
        }
        if (!collide::karabassi_swept<>::intersects(scene.mesh()[t], seen)) continue;
        auto expected = collide::karabassi_swept<>::impact_of(scene.mesh()[t], seen);
        if (owners[t] != 0)
          expected.contact.point = rounded_to<S>(frame.to_world(expected.contact.point.template cast<double>()));
        first[i] = std::min(first[i], expected.time);
        if (place == found.size()) {
          ++wrong;
          continue;
        }
        auto const& one = found[place++];
        wrong += one.contact.sphere != i || one.contact.triangle != t || one.time != expected.time ||
                 !(one.contact.point == expected.contact.point) || one.contact.depth != expected.contact.depth;
      }
    }
    CHECK(wrong == 0);
    CHECK(place == found.size());
    CHECK(place > 250);
    auto const earliest = robot.query(there, poses, collide::earliest<S>()).to_host();
    for (std::size_t i = 0; i < n; ++i) CHECK(earliest[i].time == first[i]);
  }
}

/// Closed links, one turned inside out, that overlap each other; one is far from its own origin, one has no triangles,
/// and a ball of none rests.
template <class S>
struct closed_links {
  std::vector<S> corners;
  std::vector<collide::body> bodies;

  std::size_t triangles() const { return corners.size() / 9; }
  collide::mesh_view<S> mesh() const { return collide::triangle_soup(corners.data(), triangles()); }

  void add_ball(int levels, double radius, oracle::point const& at, bool turned) {
    for (auto const& t : triangles_of(icosphere<S>(levels, radius, at))) {
      // nvcc 13.0 takes a list in braces for another
      collide::vec3<S> const all[] = {t.a, turned ? t.c : t.b, turned ? t.b : t.c};
      for (auto const& v : all) corners.insert(corners.end(), {v.x(), v.y(), v.z()});
    }
  }

  closed_links() {
    for (int k = 0; k < 6; ++k) {
      std::size_t const first = triangles();
      if (k != 2) add_ball(k % 2, 0.5 + 0.25 * k, {k == 4 ? 100.0 : 0.25, 0, 0}, k == 3);
      bodies.push_back({first, triangles() - first, {}});
      if (k == 0) add_ball(1, 0.75, {-1, 0.5, 0}, false);
    }
  }

  std::vector<collide::pose> any_poses(dice& roll) const {
    std::vector<collide::pose> all(bodies.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
      double squared = 0;
      for (double& q : all[k].rotation) {
        q = roll.uniform(-1, 1);
        squared += q * q;
      }
      for (double& q : all[k].rotation) q /= std::sqrt(squared);
      auto const there = all[k](collide::vec3<double>(k == 4 ? 100 : 0, 0, 0));
      for (int j = 0; j < 3; ++j) all[k].position[j] = roll.uniform(-1, 1) - there[j];
    }
    return all;
  }

  /// Body k, and the ball that rests after all.
  collide::body part(std::size_t k) const {
    if (k < bodies.size()) return bodies[k];
    return {bodies[0].size, bodies[1].first - bodies[0].size, {}};
  }
};

/// Inside, and how far: the least of what is found of each body alone, in its frame.
template <class Detector>
void check_posed_sides(typename Detector::execution_space const& space) {
  using S = typename Detector::scalar;
  using collide::detail::rounded_to;
  using plain = collide::detector<collide::all_pairs, collide::karabassi<>, collide::host, S>;
  closed_links<S> const links;
  dice roll(31);
  auto const mesh = collide::upload(space, links.mesh());
  collide::posed<Detector> robot(space);
  robot.build(mesh.view(), links.bodies);
  for (S const most : {std::numeric_limits<S>::infinity(), S(0.25)}) {
    auto const poses = links.any_poses(roll);
    std::vector<S> xyz;
    for (int i = 0; i < 600; ++i) {
      auto const p = roll.in_cube(2.5);
      xyz.insert(xyz.end(), {S(p.x), S(p.y), S(p.z)});
    }
    xyz[0] = std::numeric_limits<S>::quiet_NaN(), xyz[4] = std::numeric_limits<S>::infinity();
    std::size_t const n = xyz.size() / 3;
    auto const points = collide::points(xyz.data(), n);
    std::vector<collide::signed_nearest_triangle<S>> expected(n);
    std::vector<std::uint8_t> inside(n), bodies_around(n);
    for (std::size_t k = 0; k <= poses.size(); ++k) {
      collide::body const part = links.part(k);
      collide::body_state state;
      if (k < poses.size()) state.at = poses[k];
      collide::detail::make_unit(state);
      auto const at = collide::detail::frame_pose_of(state.at);
      std::vector<S> seen = xyz;
      for (std::size_t i = 0; i < n && k < poses.size(); ++i) {
        auto const local = rounded_to<S>(at.to_local(points[i].template cast<double>()));
        for (int j = 0; j < 3; ++j) seen[3 * i + std::size_t(j)] = local[j];
      }
      plain alone;
      alone.build(links.mesh().subview(part.first, part.size));
      auto const here = alone.query(collide::points(seen.data(), n), collide::signed_distance<S>(most)).to_host();
      auto const flags = alone.query(collide::points(seen.data(), n), collide::contains()).to_host();
      for (std::size_t i = 0; i < n; ++i) {
        inside[i] |= flags[i];
        bodies_around[i] += flags[i];
        auto found = here[i];
        if (found.triangle != collide::no_id) found.triangle += collide::id(part.first);
        if (found.triangle != collide::no_id && k < poses.size()) {
          found.point = rounded_to<S>(at.to_world(found.point.template cast<double>()));
          found.gradient = rounded_to<S>(at.rotated(found.gradient.template cast<double>()));
        }
        bool const is_less = found.distance < expected[i].distance ||
                             (found.distance == expected[i].distance && found.triangle < expected[i].triangle);
        if (k == 0 || is_less) expected[i] = found;
      }
    }
    auto const there = collide::upload(space, collide::spheres_xyz(xyz.data(), n, S(0)));
    auto const found = robot.query(there.view().centres(), poses, collide::signed_distance<S>(most)).to_host();
    CHECK(robot.query(there.view().centres(), poses, collide::contains()).to_host() == inside);
    std::size_t wrong = 0, disagree = 0, within = 0, overlaps = 0, askew = 0;
    for (std::size_t i = 0; i < n; ++i) {
      wrong += found[i].triangle != expected[i].triangle || found[i].distance != expected[i].distance ||
               (found[i].triangle != collide::no_id &&
                !(found[i].point == expected[i].point && found[i].gradient == expected[i].gradient));
      disagree += (found[i].distance <= 0) != (inside[i] != 0);
      within += inside[i];
      overlaps += bodies_around[i] > 1;
      // down the gradient by the distance is the point on the surface, in the world
      if (found[i].triangle == collide::no_id) continue;
      collide::vec3<S> const back = points[i] - found[i].gradient * found[i].distance;
      askew += !((back - found[i].point).norm() < 5000 * std::numeric_limits<S>::epsilon());
    }
    CHECK(wrong == 0);
    CHECK(disagree == 0);
    CHECK(askew == 0);
    CHECK(within > 50);
    CHECK(within < n - 50);
    CHECK(overlaps > 10);
  }
  robot.build(collide::mesh_view<S>(), {});
  auto const spheres = collide::spheres_xyz(links.corners.data(), 1, S(1));
  auto const there = collide::upload(space, spheres);
  CHECK(robot.query(there.view(), {}, collide::contains()).to_host()[0] == 0);
  CHECK(robot.query(there.view(), {}, collide::signed_distance<S>()).to_host()[0].triangle == collide::no_id);
}

/// From the third query on nothing is allocated.
template <class Detector>
void check_posed_keeps_memory(typename Detector::execution_space const& space, counting_resource& memory) {
  using S = typename Detector::scalar;
  posed_scene<S> scene;
  auto const mesh = collide::upload(space, scene.mesh());
  auto const spheres = collide::upload(space, collide::spheres_xyz(scene.xyz.data(), scene.radii.size(), S(0.25)));
  auto const poses = scene.any_poses();
  collide::posed<Detector> robot(space);
  robot.build(mesh.view(), scene.bodies);
  collide::contacts<S> contacts;
  for (int i = 0; i < 2; ++i) robot.query(spheres.view(), poses, contacts);
  std::size_t const before = memory.allocations;
  robot.query(spheres.view(), poses, contacts);
  CHECK(memory.allocations == before);
}

}  // namespace tests
