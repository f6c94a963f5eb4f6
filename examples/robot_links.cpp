/// \file
/// How close a robot comes to what a camera sees, or how deep that is in it: its two links are indexed once, and take a
/// pose in each frame.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <collide/bvh.cuh>
#include <collide/detectors/posed.hpp>
#include <collide/sinks/signed_distance.hpp>

namespace {

constexpr double length = 0.5, half = 0.05;  // metres, of a link and of its width

constexpr unsigned box_faces[] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};

/// A link turned by an angle about the z axis, with its joint at a point.
collide::pose turned(double angle, double x, double y) {
  return {{x, y, 0}, {std::cos(angle / 2), 0, 0, std::sin(angle / 2)}};
}

}  // namespace

int main() {
  std::vector<double> corners;  // of both links, each in its own frame: a box along x, whose joint is the origin
  std::vector<unsigned> faces;
  for (unsigned first : {0u, 8u}) {
    for (unsigned i = 0; i < 8; ++i)
      corners.insert(corners.end(), {i & 1 ? length : 0, i & 2 ? half : -half, i & 4 ? half : -half});
    for (unsigned corner : box_faces) faces.push_back(first + corner);
  }
  std::vector<double> seen;  // an arm that reaches in
  for (int i = 0; i < 100; ++i) seen.insert(seen.end(), {0.3, 0.7 + 0.01 * i, 0.1});

  collide::posed<collide::detector<collide::bvh, collide::karabassi<>, collide::host, double>> robot;
  robot.build(collide::indexed_mesh(corners.data(), 16, faces.data(), 24), {{0, 12, {}}, {12, 12, {}}});
  collide::signed_distance<double> distance;  // negative inside of a link; its memory serves all frames
  for (int degrees = 0; degrees <= 60; degrees += 20) {
    double const angle = degrees * 3.14159265358979323846 / 180;
    std::vector<collide::pose> const poses{turned(angle, 0, 0),
                                           turned(2 * angle, length * std::cos(angle), length * std::sin(angle))};
    auto const found = robot.query(collide::points(seen.data(), seen.size() / 3), poses, distance).to_host();
    auto const closest = std::min_element(found.begin(), found.end(),
                                          [](auto const& a, auto const& b) { return a.distance < b.distance; });
    std::printf("%d degrees: link %u is %.3f m away\n", degrees, closest->triangle / 12, closest->distance);
  }
}
