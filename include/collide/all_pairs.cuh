/// \file
/// Broad phase: every sphere against every triangle, in tiles. Includes the detector and everything to use it with:
/// with nvcc the CUDA spaces too.
///
/// In the terms of the original study: all_pairs x host = `brute_force_seq`, all_pairs x cuda = `brute_force`, and
/// all_pairs x cuda_shared = `brute_force_shamem`.
#pragma once

#include <collide/detail/block.hpp>
#include <collide/detail/bounding_sphere.hpp>
#include <collide/detail/hits.hpp>
#include <collide/detail/mesh_summary.hpp>
#include <collide/detail/sphere_batch.hpp>
#include <collide/detector.hpp>

namespace collide {

namespace detail {

/// Kernel body: each lane keeps some spheres; tiles of bounding spheres of the triangles pass by, in shared memory
/// where there is some; where a bounding sphere is reached, the narrow phase decides. With few spheres the mesh is
/// split among `splits` blocks.
template <class S, class NarrowPhase, class Sink>
struct all_pairs_query {
  static constexpr int items = 4;
  static constexpr int tile = 512;

  tester<S, NarrowPhase, Sink> tests;
  bounding_sphere<S> const* bounds;
  std::size_t splits;

  template <class Block>
  struct scratch {
    typename Block::template staging<bounding_sphere<S>, tile> staged;
    hit_buffer<Block> hits;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    constexpr int n = Block::items;
    typename Block::template per_lane<sphere_batch<S, n>> own;
    std::size_t const first = block.index() / splits * Block::lanes * n;
    std::size_t const triangles = tests.mesh.size();
    std::size_t const share = (triangles + splits - 1) / splits;
    std::size_t const begin = block.index() % splits * share;
    std::size_t const end = smaller(begin + share, triangles);

    if (!tests.begin(block, s.hits)) return;
    auto const first_of = [&](int lane) { return first + static_cast<std::size_t>(lane) * n; };
    block.each([&](int lane) { own[lane].load(tests.spheres, first_of(lane)); });
    bool const one_radius = at_rest<NarrowPhase, S> && tests.spheres.one_radius();
    S const radius = tests.spheres.common_radius();
    for (std::size_t base = begin; base < end; base += tile) {
      int const m = static_cast<int>(smaller(static_cast<std::size_t>(tile), end - base));
      auto const* const staged = block.stage(s.staged, bounds + base, m);
      block.each([&](int lane) {
        auto const& mine = own[lane];
        auto const sweep = [&](auto const& reach_of) {
          for (int t = 0; t < m; ++t) {
            bounding_sphere<S> const ball = staged[t];
            auto const reach = reach_of(ball);
            bool some = false;  // no branch per sphere: few are reached
            for (int k = 0; k < n; ++k) some |= ball.distance_squared(mine.x[k], mine.y[k], mine.z[k]) <= reach(k);
            if (some) test_reached(block, s, first_of(lane), static_cast<id>(base) + static_cast<id>(t), ball);
          }
        };
        if (one_radius) {
          sweep([&](bounding_sphere<S> const& ball) {
            S const common = ball.reach(radius);
            return [common](int) { return common; };
          });
        } else {
          sweep([&](bounding_sphere<S> const& ball) { return [&](int k) { return ball.reach(mine.radius[k]); }; });
        }
      });
      tests.make_room(block, s.hits);
    }
    tests.flush(block, s.hits);
  }

 private:
  /// Runs the narrow phase on those of a lane's spheres that reach the triangle's ball.
  template <class Block>
  COLLIDE_HD void test_reached(Block& block, scratch<Block>& s, std::size_t first, id triangle,
                               bounding_sphere<S> const& ball) const {
    for (std::size_t i = first; i < first + Block::items && i < tests.spheres.size(); ++i) {
      auto const candidate = tests.spheres[i];
      sphere<S> const around = enclosing(candidate);
      if (ball.reached(around.centre, around.radius)) {
        tests.test(block, s.hits, {static_cast<id>(i), triangle}, candidate);
      }
    }
  }
};

}  // namespace detail

/// Broad phase: all pairs. Nothing but a bounding sphere per triangle is prepared, so it is the right choice for small
/// meshes. Build O(triangles), query O(spheres * triangles); memory 4 scalars per triangle.
struct all_pairs {
  template <class S>
  class index {
   public:
    template <class Space>
    void build(Space& space, all_pairs const&, mesh_view<S> mesh) {
      mesh_ = mesh;
      bounds_.reserve(space.resource(), mesh.size());
      space.for_each(mesh.size(), detail::compute_bounds<S>{mesh, bounds_.data()});
    }

    template <class Space>
    void prepare(Space&, all_pairs const&, S) {}

    template <class Space>
    void prepare(Space&, all_pairs const&, sphere_view<S> const&) {}

    template <class NarrowPhase, class Space, class Sink>
    void query(Space& space, detail::spheres_of<NarrowPhase, S> const& spheres, Sink const& sink) const {
      detail::all_pairs_query<S, NarrowPhase, Sink> body{{mesh_, spheres, sink}, bounds_.data(), 1};
      std::size_t const blocks = detail::blocks_for<Space>(spheres.size(), body);
      std::size_t const tiles = (mesh_.size() + body.tile - 1) / body.tile;
      std::size_t const wanted = (space.concurrency() + blocks - 1) / blocks;
      body.splits = detail::larger<std::size_t>(1, detail::smaller(wanted, tiles));
      space.launch(blocks * body.splits, body);
    }

    template <class Space>
    double cell_width(Space&) const {
      return 0;
    }

   private:
    mesh_view<S> mesh_;
    buffer<detail::bounding_sphere<S>> bounds_;
  };
};

}  // namespace collide
