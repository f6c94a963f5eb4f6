/// \file
/// A mesh and points in Eigen matrices, as libigl has them, and points in structs.

#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>

struct record {
  double time;
  double x, y, z;
};

int main() {
  Eigen::MatrixXd V(4, 3);
  V << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  Eigen::MatrixXi F(2, 3);
  F << 0, 1, 2, 0, 2, 3;
  Eigen::MatrixXf const cloud = Eigen::MatrixXf{{0.9f, 0.1f, 0.1f}, {0.1f, 0.9f, 0}, {5, 5, 5}};

  collide::detector<collide::bucket, collide::karabassi<>, collide::host, double> detector;
  detector.build(collide::indexed_mesh(V, F));

  // floats beside a mesh of doubles: a copy in double, which is exact
  Eigen::MatrixXd const centres = cloud.cast<double>();
  auto touches = [&](auto const& spheres) {
    int n = 0;
    for (auto flag : detector.query(spheres, collide::any_hit()).to_host()) n += flag;
    return n;
  };
  std::printf("%d of 3 points are near the mesh\n", touches(collide::spheres_at(collide::points(centres), 0.2)));

  std::vector<record> const records{{0, 0.9, 0.1, 0.1}, {1, 0.1, 0.9, 0}, {2, 5, 5, 5}};
  std::printf("%d of 3 records are\n", touches(collide::spheres_at(collide::points(records.data(), 3), 0.2)));
}
