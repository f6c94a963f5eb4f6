/// `automatic` on the host.
#include "automatic.hpp"
#include "compositions.hpp"

TEST_CASE("automatic: the pairs are the same, the grid is there only where it pays, on the host") {
  tests::check_automatic(collide::host(1));
  tests::check_automatic(tests::lockstep<64, true>(1));
  tests::check_automatic_swept(collide::host(1));
}

TEST_CASE("automatic: many queries of few spheres make a grid in the end, on the host") {
  tests::check_many_queries(collide::host(1));
}

namespace {

/// A detector of a scene of bars finds what all pairs do; returns the width of the cells that it uses in the end.
template <class Space>
double cells_for_bars(Space space, io::bars_in layout, double slender, double reach, bool radius_is_known,
                      std::size_t triangles = 3000, int queries = 1) {
  io::scene const s = io::bars_scene(layout, slender, reach, 4000, triangles, 0);
  std::vector<float> const vertices(s.vertices.begin(), s.vertices.end()), centres(s.centres.begin(), s.centres.end());
  auto const mesh = collide::indexed_mesh(vertices.data(), vertices.size() / 3, s.corners.data(), s.triangle_count());
  auto const radius = static_cast<float>(s.radius);
  auto const balls = collide::spheres_xyz(centres.data(), s.sphere_count(), radius);
  collide::detector<collide::all_pairs> plain;
  plain.build(mesh);
  collide::detector<collide::automatic, collide::karabassi<>, Space> chooses(space);
  radius_is_known ? chooses.build(mesh, radius) : chooses.build(mesh);
  collide::pairs found(collide::order::canonical), expected(collide::order::canonical);
  for (int i = 0; i < queries; ++i) chooses.query(balls, found);
  plain.query(balls, expected);
  CHECK(expected.size() > 1000);
  CHECK(found.to_host() == expected.to_host());
  return chooses.cell_width();
}

}  // namespace

TEST_CASE("automatic: a tree for long thin triangles that few spheres touch, a grid where many do, on the host") {
  for (bool const known : {false, true}) {
    CHECK(cells_for_bars(collide::host(1), io::bars_in::cage, 100, 1, known) > 0);
    // thousands of spheres want an index: if it is no grid it is the tree
    CHECK(cells_for_bars(collide::host(1), io::bars_in::shaft, 100, 0.1, known) == 0);
  }
  // the grid knows of them, and has narrow cells
  CHECK(cells_for_bars(collide::host(1), io::bars_in::tube, 1000, 0.5, true, 40000) > 0);
  // a tree takes more than a query saves, and less than three do
  CHECK(cells_for_bars(collide::host(1), io::bars_in::tube, 1000, 0.5, false) > 0);
  CHECK(cells_for_bars(collide::host(1), io::bars_in::tube, 1000, 0.5, false, 3000, 4) == 0);
  // where trees are those of devices there is none
  CHECK(cells_for_bars(tests::lockstep<64, true>(1), io::bars_in::shaft, 100, 0.1, false) > 0);
}

TEST_CASE("automatic: a first query tests all pairs where that takes less than to build a grid, on the host") {
  struct row {
    std::size_t triangles, spheres;
    bool has_grid;
  };
  // as measured: docs/development/experiments.md
  for (row const& r : {row{18, 30, false},
                       {18, 300, true},
                       {1008, 10, false},
                       {1008, 300, true},
                       {3136, 113, true},
                       {16464, 10, false},
                       {16464, 300, true},
                       {13924, 182, true}}) {
    CAPTURE(r.triangles);
    CAPTURE(r.spheres);
    io::scene const s = io::study_scene(r.spheres, r.triangles);
    std::vector<float> const vertices(s.vertices.begin(), s.vertices.end()),
        centres(s.centres.begin(), s.centres.end());
    collide::detector<collide::automatic> detector(collide::host(1));
    detector.build(collide::indexed_mesh(vertices.data(), vertices.size() / 3, s.corners.data(), s.triangle_count()));
    detector.query(collide::spheres_xyz(centres.data(), r.spheres, 3), collide::count());
    CHECK((detector.cell_width() > 0) == r.has_grid);
  }
}

TEST_CASE("automatic: takes the index that was measured to be the fastest in small families of scenes, on the host") {
  enum class choice { grid, tree, all_pairs };
  struct row {
    char const* scene;
    std::size_t spheres, triangles;
    choice first, again;  // in the first query, and in the hundredth
  };
  // as measured, where the others take at least a fifth longer: docs/development/experiments.md
  for (row const& r : {row{"study", 2000, 200, choice::grid, choice::grid},          // compact
                       row{"grains", 20000, 2000, choice::grid, choice::grid},       // many of both
                       row{"soup", 200, 40, choice::all_pairs, choice::grid},        // few, far apart
                       row{"giants_1", 40, 40, choice::all_pairs, choice::grid},     // few, one of them a giant
                       row{"giants_10", 20000, 2000, choice::grid, choice::grid},    // giants among small ones
                       row{"needles_1000", 2000, 200, choice::grid, choice::grid},   // few long ones, large spheres
                       row{"tube_1000", 20000, 2000, choice::tree, choice::tree},    // long, side by side
                       row{"shaft_100", 20000, 2000, choice::tree, choice::tree},    // a bundle
                       row{"tube_1000", 4000, 3000, choice::grid, choice::tree}}) {  // a tree pays later
    CAPTURE(r.scene);
    CAPTURE(r.spheres);
    io::scene const s = io::find_scene(r.scene)->make(r.spheres, r.triangles, 1);
    std::vector<float> const vertices(s.vertices.begin(), s.vertices.end()),
        centres(s.centres.begin(), s.centres.end());
    auto const mesh = collide::indexed_mesh(vertices.data(), vertices.size() / 3, s.corners.data(), s.triangle_count());
    auto const balls = collide::spheres_xyz(centres.data(), s.sphere_count(), static_cast<float>(s.radius));
    collide::host space(1);
    collide::automatic::index<float> index;
    index.build(space, collide::automatic(), mesh);
    auto const chosen = [&](int queries) {
      for (int k = 0; k < queries; ++k) index.prepare(space, collide::automatic(), balls);
      if (index.cell_width(space) > 0) return choice::grid;
      return index.mesh_lookup().asks_tree() ? choice::tree : choice::all_pairs;
    };
    CHECK(chosen(1) == r.first);
    CHECK(chosen(99) == r.again);
  }
}

TEST_CASE("automatic: small scenes have the same pairs by whichever way, on the host") {
  tests::check_automatic_scenes(collide::host(1));
  tests::check_automatic_scenes(tests::lockstep<64, true>(1));
}

TEST_CASE("automatic: a simulation has the bits of one with buckets, on the host") {
  tests::check_automatic_steps<collide::karabassi<>>(collide::host(1));
  tests::check_automatic_steps<collide::karabassi_swept<>>(collide::host(2));
  tests::check_automatic_steps<collide::karabassi<>>(tests::lockstep<64, true>(1));
}
