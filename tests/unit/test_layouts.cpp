/// Meshes and spheres in every layout, on the host.
#include "layouts.hpp"

TEST_CASE("layouts: each gives the contacts of the packed one on the host") {
  tests::check_layouts<collide::bucket, float>(collide::host(1));
  tests::check_layouts<collide::bucket, double>(collide::host(2));
  tests::check_layouts<collide::all_pairs, float>(collide::host(1));
}

TEST_CASE("layouts: each is uploaded as a packed copy on the host") {
  tests::check_uploaded_layouts<float>(collide::host(1));
}

TEST_CASE("layouts: spheres that move in each give the impacts of the packed ones on the host") {
  tests::check_moving_layouts<collide::bucket, float>(collide::host(1));
  tests::check_moving_layouts<collide::bucket, double>(collide::host(1));
}

TEST_CASE("layouts: Eigen matrices of either order and of fixed size are read as they lie") {
  constexpr int any = Eigen::Dynamic;
  Eigen::MatrixXd v(4, 3);
  v << 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11;
  Eigen::MatrixXi f(2, 3);
  f << 3, 0, 1, 1, 2, 3;
  Eigen::Matrix<double, any, any, Eigen::RowMajor> const v_rows = v;
  Eigen::Matrix<int, any, any, Eigen::RowMajor> const f_rows = f;
  Eigen::Matrix<double, 4, 3> const v_fixed = v;
  Eigen::Matrix<unsigned, 2, 3> const f_fixed = f.cast<unsigned>();
  Eigen::Matrix3Xd const v_columns = v.transpose();
  Eigen::Matrix<int, 3, any> const f_columns = f.transpose();
  Eigen::Array<double, any, 3> const v_array = v;
  for (auto const& mesh : {collide::indexed_mesh(v, f), collide::indexed_mesh(v_rows, f_rows),
                           collide::indexed_mesh(v_rows, f), collide::indexed_mesh(v, f_rows),
                           collide::indexed_mesh(v_fixed, f_fixed), collide::indexed_mesh(v_columns, f_columns),
                           collide::indexed_mesh(v_array, f), collide::indexed_mesh(v.leftCols(3), f.topRows(2)),
                           collide::indexed_mesh(collide::points(v), f_rows.data(), 2)}) {
    REQUIRE(mesh.size() == 2);
    CHECK(mesh.vertices().size() == 4);
    CHECK(mesh[0].a == collide::vec3<double>(9, 10, 11));
    CHECK(mesh[0].c == collide::vec3<double>(3, 4, 5));
    CHECK(mesh[1].b == collide::vec3<double>(6, 7, 8));
  }
  CHECK(collide::triangle_soup(collide::points(v.topRows(3)))[0].b == collide::vec3<double>(3, 4, 5));
  CHECK(collide::spheres_at(collide::points(v), 2)[3].centre == collide::vec3<double>(9, 10, 11));
  CHECK(collide::spheres_at(collide::points(v_columns), v.data())[3].radius == 9);
  CHECK(collide::points(Eigen::Matrix3d(v.topRows(3)).eval().row(1))[0] == collide::vec3<double>(3, 4, 5));
  CHECK(collide::points(Eigen::MatrixXf(0, 3).leftCols(3)).size() == 0);
}

TEST_CASE("layouts: matrices and arrays of a wrong shape are refused") {
  Eigen::MatrixXd const v = Eigen::MatrixXd::Zero(4, 3);
  Eigen::MatrixXi const f = Eigen::MatrixXi::Zero(3, 2);
  CHECK_THROWS_WITH_AS(collide::indexed_mesh(v, f),
                       "collide: a matrix of faces has 3 columns, this one is 3 x 2; of one with 3 rows give "
                       "matrix.transpose()",
                       collide::error);
  Eigen::MatrixXd const flat = Eigen::MatrixXd::Zero(3, 4);
  CHECK_THROWS_AS(collide::points(flat), collide::error);
  CHECK(collide::points(flat.transpose()).size() == 4);
  CHECK_THROWS_AS(collide::triangle_soup(collide::points(v)), collide::error);
  CHECK_THROWS_AS(collide::points(v.data(), 4, std::size_t{1} << 32), collide::error);
  CHECK_THROWS_AS(collide::spheres_at(collide::points(v), v.data(), std::size_t{1} << 32), collide::error);
  auto const spheres = collide::spheres_at(collide::points(v), 1);
  CHECK_THROWS_AS(collide::with_displacements(spheres, collide::points(v.data(), 3)), collide::error);
}
