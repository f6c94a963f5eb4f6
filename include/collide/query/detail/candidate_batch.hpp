/// \file
/// Candidates that are decided several at a time, in the lanes of the processor's vector unit.
#pragma once

#include <collide/exact/detail/geometry/bounding_sphere.hpp>
#include <collide/narrow/detail/intersects.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

/// Pairs that wait for their verdict, number by number in arrays of their own. Of a sphere that moves there are two
/// spheres with one centre: one around its path, and one in the middle of it.
template <class S>
struct candidate_batch {
  static constexpr int capacity = 64;

  int size;
  pair ids[capacity];
  S corners[9][capacity];
  S centre[3][capacity];
  S radius[capacity];
  S midpoint_radius[capacity];               ///< of spheres that move
  moving_sphere<S> const* moving[capacity];  ///< the sphere itself, if it moves
  std::int32_t verdicts[capacity];
  std::uint8_t uncertain[capacity];

  void add(pair p, triangle<S> const& t, sphere<S> const& s) {
    int const k = size++;
    ids[k] = p;
    COLLIDE_UNROLL
    for (int c = 0; c < 3; ++c) {
      corners[c][k] = t.a[c];
      corners[3 + c][k] = t.b[c];
      corners[6 + c][k] = t.c[c];
      centre[c][k] = s.centre[c];
    }
    radius[k] = s.radius;
  }

  /// The sphere must stay where it is until the pair is decided.
  void add(pair p, triangle<S> const& t, moving_sphere<S> const& s) {
    midpoint_radius[size] = midpoint_sphere(s).radius;
    moving[size] = &s;
    add(p, t, swept_bounding_sphere(s));
  }

  triangle<S> triangle_of(int k) const {
    return {{corners[0][k], corners[1][k], corners[2][k]},
            {corners[3][k], corners[4][k], corners[5][k]},
            {corners[6][k], corners[7][k], corners[8][k]}};
  }

  sphere<S> sphere_of(int k) const { return {{centre[0][k], centre[1][k], centre[2][k]}, radius[k]}; }

  sphere<S> midpoint_sphere_of(int k) const { return {{centre[0][k], centre[1][k], centre[2][k]}, midpoint_radius[k]}; }

  /// Sets the verdicts to what a quick test without branches says.
  template <class Test>
  void filter_batch(Test const& test) {
    multiversioned([&] {
      for (int k = 0; k < size; ++k) verdicts[k] = static_cast<std::int32_t>(test(k));
    });
  }

  /// Takes the hits to the pipeline and empties the batch.
  template <class Pipeline, class Block>
  void decide(Pipeline const& pipeline, Block& block, pipeline_storage<Block>& hits) {
    if (size == 0) return;
    using stages = filtered_predicate<typename Pipeline::narrow_phase>;
    constexpr bool rest = is_discrete<typename Pipeline::narrow_phase, S>;
    if constexpr (rest) {
      // pairs that wait together are of about one size
      S const scale = min(inverse_power_of_two(max_norm(to_local<S>(triangle_of(0), sphere_of(0)))), S(0x1p50));
      filter_batch([&](int k) { return stages::filter_branchless(triangle_of(k), sphere_of(k), scale); });
    } else {
      filter_batch(
          [&](int k) { return stages::filter_branchless(triangle_of(k), sphere_of(k), midpoint_sphere_of(k)); });
    }
    int n = 0;  // no branch per pair: it would often be mispredicted
    for (int k = 0; k < size; ++k) {
      uncertain[n] = static_cast<std::uint8_t>(k);
      n += verdicts[k] != static_cast<std::int32_t>(verdict::miss);
    }
    for (int i = 0; i < n; ++i) {
      int const k = uncertain[i];
      auto const v = static_cast<verdict>(verdicts[k]);
      if constexpr (rest) {
        if (v == verdict::out_of_range) {
          pipeline.push(block, hits, ids[k], sphere_of(k));
        } else if (v == verdict::hit || stages::resolve(triangle_of(k), sphere_of(k))) {
          pipeline.push_hit(block, hits, ids[k]);
        }
      } else {
        v == verdict::hit ? pipeline.push_hit(block, hits, ids[k]) : pipeline.push(block, hits, ids[k], *moving[k]);
      }
      pipeline.drain_if_full(block, hits);
    }
    size = 0;
  }
};

/// True if candidates are decided several at a time: with a narrow phase that has a quick test without branches, and
/// coordinates of the type that it works in.
template <class NarrowPhase, class S>
inline constexpr bool in_batches = filtered_predicate<NarrowPhase>::value&& std::is_same<S, float>::value;

}  // namespace collide::detail
