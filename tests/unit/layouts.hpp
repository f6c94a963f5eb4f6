/// Meshes and spheres in every layout, in memory of a space: each gives the results of the packed ones; instantiated by
/// test_layouts.cpp and test_layouts_cuda.cpp.
#pragma once

#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <collide/core/moving_spheres.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/sinks/impacts.hpp>
#include <collide/spaces/upload.hpp>

#include "compositions.hpp"
#include "scenes.hpp"

namespace tests {

/// Arrays in memory of a space, as long as this lives.
template <class Space>
class copies {
 public:
  explicit copies(Space const& space) : space_{space} {}

  template <class T>
  T const* operator()(std::vector<T> const& from) {
    auto const made = std::make_shared<array<T>>();
    kept_.push_back(made);
    return made->assign(space_, from);
  }

 private:
  Space space_;
  std::vector<std::shared_ptr<void>> kept_;
};

/// A point among other things.
template <class S>
struct record {
  int number;
  S z, x, y;
  S weight[2];
};

template <class T>
struct named {
  std::string name;
  T view;
};

/// Every layout of packed points.
template <class S, class Space>
std::vector<named<collide::point_view<S>>> layouts_of(std::vector<S> const& xyz, copies<Space>& copy) {
  constexpr int any = Eigen::Dynamic;
  std::size_t const n = xyz.size() / 3;
  std::vector<S> padded, x, y, z;
  std::vector<record<S>> records;
  for (std::size_t i = 0; i < n; ++i) {
    S const* const p = xyz.data() + 3 * i;
    padded.insert(padded.end(), {p[0], p[1], p[2], S(-7)});
    x.push_back(p[0]), y.push_back(p[1]), z.push_back(p[2]);
    records.push_back({1, p[2], p[0], p[1], {S(3), S(4)}});
  }
  std::vector<S> columns(x);
  columns.insert(columns.end(), y.begin(), y.end());
  columns.insert(columns.end(), z.begin(), z.end());
  auto const rows = static_cast<Eigen::Index>(n);
  S const *const packed = copy(xyz), *const by_column = copy(columns), *const by_four = copy(padded);
  using column_major = Eigen::Map<Eigen::Matrix<S, any, 3> const>;
  using row_major = Eigen::Map<Eigen::Matrix<S, any, any, Eigen::RowMajor> const>;
  using three_rows = Eigen::Map<Eigen::Matrix<S, 3, any> const>;
  using four_columns = Eigen::Map<Eigen::Matrix<S, any, 4, Eigen::RowMajor> const>;
  return {{"packed", collide::points(packed, n)},
          {"stride 4", collide::points(by_four, n, 4)},
          {"three arrays", collide::points(copy(x), copy(y), copy(z), n)},
          {"three arrays, stride 4", collide::points(by_four, by_four + 1, by_four + 2, n, 4)},
          {"structs", collide::points(copy(records), n)},
          {"column-major", collide::points(column_major(by_column, rows, 3))},
          {"row-major", collide::points(row_major(packed, rows, 3))},
          {"three rows", collide::points(three_rows(packed, 3, rows))},
          {"block", collide::points(four_columns(by_four, rows, 4).template leftCols<3>())},
          {"transposed", collide::points(three_rows(packed, 3, rows).transpose())}};
}

/// A square of n x n x 2 triangles that share their vertices.
template <class S>
mesh<S> bumpy_square(int n) {
  mesh<S> made;
  auto const number = [n](int i, int k) { return static_cast<std::uint32_t>(i * (n + 1) + k); };
  for (int i = 0; i <= n; ++i) {
    for (int k = 0; k <= n; ++k) {
      for (double x : {i + 0.25 * (k % 3), k + 0.125 * (i % 5), std::sin(i) * std::cos(0.5 * k)})
        made.vertices.push_back(static_cast<S>(x));
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k) {
      std::uint32_t const a = number(i, k), b = number(i + 1, k), c = number(i + 1, k + 1), d = number(i, k + 1);
      made.corners.insert(made.corners.end(), {a, b, c, a, c, d});
    }
  }
  return made;
}

/// All contacts, in canonical order.
template <class Broad, class S, class Space>
std::vector<collide::contact<S>> contacts_of(Space const& space, collide::mesh_view<S> mesh,
                                             collide::sphere_view<S> spheres) {
  collide::detector<Broad, collide::karabassi<>, Space, S> detector(space);
  return detector.detect(mesh, spheres, collide::contacts<S>(collide::order::canonical)).to_host();
}

template <class T>
bool same_records(std::vector<T> const& a, std::vector<T> const& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

/// Meshes in every layout of vertices and of indices, spheres in every layout of centres and of radii.
template <class Broad, class S, class Space>
void check_layouts(Space const& space) {
  scene<S> made;
  made.mesh = bumpy_square<S>(24);
  made.spheres = spheres_near(made.mesh, 5, 3001, 0.5, 0.5);
  std::vector<S> const& xyz = made.spheres.centres;
  std::size_t const n = made.spheres.size(), faces = made.mesh.size();
  copies<Space> copy(space);
  auto const* const corners = copy(made.mesh.corners);
  std::vector<S> two_radii;
  for (S r : made.spheres.radii) two_radii.insert(two_radii.end(), {S(9), r});

  auto const vertices = layouts_of(made.mesh.vertices, copy);
  auto const centres = layouts_of(xyz, copy);
  auto const* const radii = copy(made.spheres.radii);
  auto const spheres = collide::spheres_at(centres[0].view, radii);
  auto const mesh = collide::indexed_mesh(vertices[0].view, corners, faces);
  auto const expected = contacts_of<Broad>(space, mesh, spheres);
  REQUIRE(expected.size() > n);

  for (auto const& form : vertices) {
    CAPTURE(form.name);
    CHECK(same_records(contacts_of<Broad>(space, collide::indexed_mesh(form.view, corners, faces), spheres), expected));
  }
  for (auto const& form : centres) {
    CAPTURE(form.name);
    CHECK(same_records(contacts_of<Broad>(space, mesh, collide::spheres_at(form.view, radii)), expected));
  }
  CHECK(same_records(contacts_of<Broad>(space, mesh, collide::spheres_at(centres[1].view, copy(two_radii) + 1, 2)),
                     expected));

  std::vector<int> by_column;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < faces; ++i) by_column.push_back(static_cast<int>(made.mesh.corners[3 * i + k]));
  }
  using matrix = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
  std::vector<S> columns;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = k; i < made.mesh.vertices.size(); i += 3) columns.push_back(made.mesh.vertices[i]);
  }
  Eigen::Map<matrix const> const v(copy(columns), static_cast<Eigen::Index>(columns.size() / 3), 3);
  Eigen::Map<Eigen::MatrixXi const> const f(copy(by_column), static_cast<Eigen::Index>(faces), 3);
  CHECK(same_records(contacts_of<Broad>(space, collide::indexed_mesh(v, f), spheres), expected));
}

/// Uploads of every layout are packed copies.
template <class S, class Space>
void check_uploaded_layouts(Space const& space) {
  auto const m = bumpy_square<S>(10);
  auto const s = spheres_near(m, 5, 500, 0.5, 0.5);
  copies<collide::host> copy(collide::host(1));
  std::vector<int> columns;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = k; i < m.corners.size(); i += 3) columns.push_back(static_cast<int>(m.corners[i]));
  }
  Eigen::Map<Eigen::MatrixXi const> const f(columns.data(), static_cast<Eigen::Index>(m.size()), 3);
  auto const spheres = collide::spheres_xyz(s.centres.data(), s.size(), s.radii.data());
  auto const packed = collide::indexed_mesh(m.vertices.data(), m.vertices.size() / 3, m.corners.data(), m.size());
  auto const expected = contacts_of<collide::bucket>(collide::host(1), packed, spheres);
  auto const centres = layouts_of(s.centres, copy);
  for (std::size_t i = 0; i < centres.size(); ++i) {
    CAPTURE(centres[i].name);
    Eigen::Map<Eigen::Matrix<S, Eigen::Dynamic, 3, Eigen::RowMajor> const> const v(
        m.vertices.data(), static_cast<Eigen::Index>(m.vertices.size() / 3), 3);
    auto const there = collide::upload(space, collide::indexed_mesh(v, f));
    auto const balls = collide::upload(space, collide::spheres_at(centres[i].view, s.radii.data()));
    CHECK(balls.view().centres().packed());
    CHECK(there.view().packed_indices());
    CHECK(same_records(contacts_of<collide::bucket>(space, there.view(), balls.view()), expected));
  }
}

/// Displacements in every layout.
template <class Broad, class S, class Space>
void check_moving_layouts(Space const& space) {
  auto const m = bumpy_square<S>(10);
  auto const s = spheres_near(m, 5, 1001, 2, 0.1);
  auto const ways = spheres_near(m, 6, 1001, 0.5, 0.1).centres;
  copies<Space> copy(space);
  auto const mesh = collide::indexed_mesh(copy(m.vertices), m.vertices.size() / 3, copy(m.corners), m.size());
  auto const centres = layouts_of(s.centres, copy);
  auto const displacements = layouts_of(ways, copy);
  std::vector<collide::impact<S>> expected;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    CAPTURE(centres[i].name);
    collide::detector<Broad, collide::karabassi_swept<>, Space, S> detector(space);
    auto const moving =
        collide::with_displacements(collide::spheres_at(centres[i].view, S(0.1)), displacements[i].view);
    auto const found = detector.detect(mesh, moving, collide::impacts<S>(collide::order::canonical)).to_host();
    if (i == 0) expected = found;
    REQUIRE(expected.size() > 100);
    CHECK(same_records(found, expected));
  }
}

}  // namespace tests
