/// \file
/// A robot that stops where a depth camera sees something near it: coordinates in double, a mesh that moves each frame,
/// and a camera whose pixels without a measurement are NaN.

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include <collide/bucket.cuh>

namespace {

constexpr double safety_distance = 0.25;  // metres

/// The arm: a box of 0.8 x 0.1 x 0.1 m that turns about the z axis, as 12 triangles.
class robot_arm {
 public:
  collide::mesh_view<double> turned_by(double angle) {
    for (unsigned i = 0; i < 8; ++i) {
      double const x = i & 1 ? 0.8 : 0, y = i & 2 ? 0.05 : -0.05, z = i & 4 ? 0.55 : 0.45;
      vertices_[i] = {std::cos(angle) * x - std::sin(angle) * y, std::sin(angle) * x + std::cos(angle) * y, z};
    }
    return collide::indexed_mesh(vertices_[0].data(), vertices_.size(), faces_, 12);
  }

 private:
  std::array<std::array<double, 3>, 8> vertices_{};
  unsigned faces_[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                         2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
};

/// The view of a camera of 64 x 48 pixels 2 m above the robot's base, looking down: the floor, a person's arm (10 cm
/// wide, 0.5 m above the floor, from y = 0.6 m on), and at the left edge nothing.
class depth_camera {
 public:
  std::vector<double> const& points() {
    points_.clear();
    for (int row = 0; row < height; ++row)
      for (int column = 0; column < width; ++column) {
        double const right = (column - width / 2) / focal_length, up = (height / 2 - row) / focal_length;
        double const depth = depth_at(column, right, up);
        points_.insert(points_.end(), {right * depth, up * depth, camera_height - depth});
      }
    return points_;
  }

 private:
  static constexpr int width = 64, height = 48;
  static constexpr double focal_length = 48, camera_height = 2;  // in pixels, and in metres

  static double depth_at(int column, double right, double up) {
    if (column == 0) return std::numeric_limits<double>::quiet_NaN();
    bool const person = std::fabs(right * 1.5) < 0.05 && up * 1.5 > 0.6;
    return person ? 1.5 : camera_height;
  }

  std::vector<double> points_;
};

}  // namespace

int main() {
  robot_arm arm;
  depth_camera camera;
  collide::detector<collide::bucket, collide::karabassi<>, collide::host, double> detector;
  collide::closest<double> closest;  // its memory serves all frames
  for (int degrees = 30; degrees <= 90; degrees += 15) {
    std::vector<double> const& points = camera.points();
    detector.build(arm.turned_by(degrees * 3.14159265358979323846 / 180), safety_distance);
    detector.query(collide::spheres_xyz(points.data(), points.size() / 3, safety_distance), closest);

    double distance = std::numeric_limits<double>::infinity();  // stays so if nothing is near; a NaN never is
    for (auto const& near : closest.to_host()) distance = std::fmin(distance, near.distance);
    if (distance <= safety_distance) {
      std::printf("%d degrees: stop, something is %.3f m away\n", degrees, distance);
      return 0;
    }
    std::printf("%d degrees: go on\n", degrees);
  }
}
