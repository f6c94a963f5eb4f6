/// \file
/// A broad phase of one's own: one box around the whole mesh. Spheres outside it are done; the others meet every
/// triangle. It is written once, against the library's block of lanes, and so runs in every execution space.

#include <cstdio>

#include <collide/bucket.cuh>

/// What runs: a block of lanes looks at `items` spheres per lane.
template <class S, class NarrowPhase, class Sink>
struct one_box_query {
  static constexpr int items = 4;

  collide::detail::tester<S, NarrowPhase, Sink> tests;
  collide::detail::mesh_summary<S> const* summary;

  template <class Block>
  struct scratch {  // shared memory in cuda_shared; not initialised
    collide::detail::hit_buffer<Block> hits;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    block.each([&](int lane) { tests.begin(s.hits, lane); });
    for (std::size_t k = 0; k < std::size_t(Block::items); ++k) {
      std::size_t const first = (block.index() * Block::items + k) * Block::lanes;
      for (std::size_t t = 0; t < tests.mesh.size(); ++t) {
        block.each([&](int lane) {
          std::size_t const i = first + static_cast<std::size_t>(lane);
          if (i >= tests.spheres.size()) return;
          collide::sphere<S> const ball = tests.spheres[i];
          if (outside(ball)) return;
          tests.test(block, s.hits, {static_cast<collide::id>(i), static_cast<collide::id>(t)}, ball);
        });
        tests.make_room(block, s.hits);  // for one more hit per lane
      }
    }
    tests.flush(block, s.hits);
  }

 private:
  /// Rounding is monotone, so this never rejects a sphere that some triangle's own box would not reject.
  COLLIDE_HD bool outside(collide::sphere<S> const& ball) const {
    for (int axis = 0; axis < 3; ++axis) {
      S const c = ball.centre[axis];
      if (summary->lower_of(axis) - c > ball.radius || c - summary->upper_of(axis) > ball.radius) return true;
    }
    return false;
  }
};

/// The policy: its options, of which there are none, and an index per type of coordinate.
struct one_box {
  template <class S>
  class index {
   public:
    template <class Space>
    void build(Space& space, one_box const&, collide::mesh_view<S> mesh) {
      mesh_ = mesh;
      auto* const summary = summary_.reserve(space.resource(), 1);
      collide::detail::mesh_summary<S>::clear(space, summary);
      collide::detail::summarise_mesh<S> const body{mesh, summary, nullptr};
      space.launch(collide::detail::grid_size<Space>(mesh.size(), body), body);
    }

    /// What depends on the radius, or on the spheres; here nothing does.
    template <class Space>
    void prepare(Space&, one_box const&, S) {}
    template <class Space>
    void prepare(Space&, one_box const&, collide::sphere_view<S> const&) {}

    template <class NarrowPhase, class Space, class Sink>
    void query(Space& space, collide::sphere_view<S> const& spheres, Sink const& sink) const {
      one_box_query<S, NarrowPhase, Sink> const body{{mesh_, spheres, sink}, summary_.data()};
      space.launch(collide::detail::grid_size<Space>(spheres.size(), body), body);
    }

    template <class Space>
    double cell_width(Space&) const {
      return 0;  // no cells
    }

   private:
    collide::mesh_view<S> mesh_;
    collide::buffer<collide::detail::mesh_summary<S>> summary_;
  };
};

int main() {
  float const vertices[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  unsigned const corners[] = {0, 1, 2, 0, 2, 3};
  float const centres[] = {0.9f, 0.1f, 0, 0.5f, 0.5f, 0.1f, 0.5f, 0.5f, 0.3f, 5, 5, 5};
  auto const mesh = collide::indexed_mesh(vertices, 4, corners, 2);
  auto const spheres = collide::spheres_xyz(centres, 4, 0.2f);

  collide::detector<one_box> detector;
  for (auto [sphere, triangle] : detector.detect(mesh, spheres, collide::pairs(collide::order::canonical)).to_host()) {
    std::printf("%u %u\n", sphere, triangle);
  }
}
