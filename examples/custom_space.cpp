/// \file
/// An execution space of one's own: the host, but every pass over the data is reported. Shows what a space must have,
/// and what the bucket detector does.

#include <cstdio>

#include <collide/bucket.cuh>

/// All that differs from `host` is said here. Spaces are small values and are copied freely.
class reporting : public collide::host {
 public:
  using host::host;
  static constexpr char const* name() { return "reporting"; }

  /// Runs a body once per block.
  template <class Body>
  void launch(std::size_t blocks, Body const& body) const {
    std::printf("%zu block(s)\n", blocks);
    host::launch(blocks, body);
  }

  /// Calls f(i) for each i < n.
  template <class F>
  void for_each(std::size_t n, F const& f) const {
    std::printf("each of %zu\n", n);
    host::for_each(n, f);
  }

  void exclusive_scan(std::uint32_t* values, std::size_t n, collide::buffer<unsigned char>& scratch) const {
    std::printf("scan\n");
    host::exclusive_scan(values, n, scratch);
  }
};

int main() {
  float const vertices[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  unsigned const corners[] = {0, 1, 2, 0, 2, 3};
  float const centres[] = {0.9f, 0.1f, 0, 0.1f, 0.9f, 0, 5, 5, 5};
  collide::detector<collide::bucket, collide::karabassi<>, reporting> detector{reporting(1)};

  std::printf("build\n");  // a summary of the mesh; the plan of a grid; a bit for each cell that a triangle touches
  detector.build(collide::indexed_mesh(vertices, 4, corners, 2), 0.2f);
  std::printf("query\n");  // spheres listed, counted, scanned, numbered, sorted; the triangles look for them; the end
  auto const hits = detector.query(collide::spheres_xyz(centres, 3, 0.2f), collide::count());
  std::printf("%d hits\n", static_cast<int>(hits.total()));
}
