/// \file
/// A detector on many ranks: of a mesh that each has, or of one that they divide.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <type_traits>
#include <utility>

#include <collide/detector.hpp>
#include <collide/detectors/detail/found_query.hpp>
#include <collide/ranks/detail/remote_nearest.hpp>
#include <collide/ranks/detail/remote_pairs.hpp>
#include <collide/ranks/ranks.hpp>

namespace collide {

/// Says to `distributed::build` that each rank has all of the mesh.
struct on_every_rank_t {};
/// The value of its type: `build(mesh, on_every_rank)`.
inline constexpr on_every_rank_t on_every_rank{};
/// Says to `distributed::build` that each rank has a part of the mesh.
struct divided_t {};
/// The value of its type: `build(mine, divided)`.
inline constexpr divided_t divided{};

/// A detector on many ranks, each of which queries spheres of its own; a sink then holds the pairs of its rank's
/// spheres, each pair exactly once, and the same that a detector of the whole scene finds. Spheres keep the numbers
/// that they have on their rank: one after the other, the ranks' results are the result of all spheres, canonical order
/// included; `count_before(ranks, spheres.size())` is the number of a rank's first. All ranks call all members, in the
/// same order. What one throws makes all throw: see `together`.
///
/// \tparam Detector  a `detector`; every rank makes its space and options
/// \tparam Ranks     `one_rank`, `thread_ranks` or `mpi_ranks`
template <class Detector, class Ranks = one_rank>
class distributed {
  static_assert(detail::is_detector<Detector>,
                "collide: the first parameter of distributed is a detector, such as detector<bucket>, or a simulation, "
                "which needs distributed_simulation.cuh");
  static_assert(detail::check_ranks<Ranks>());
  static constexpr bool alone = std::is_same<Ranks, one_rank>::value;

 public:
  using scalar = typename Detector::scalar;                    ///< type of the coordinates: float or double
  using spheres_type = typename Detector::spheres_type;        ///< that of the detector
  using execution_space = typename Detector::execution_space;  ///< that of the detector

  /// `chunk`: about how many spheres of a rank go to others at a time, where the mesh is divided: it bounds the memory
  /// for what is sent. Throws what making the space throws, and `error` if `chunk` is 0; other ranks do not hear of
  /// that.
  explicit distributed(Ranks ranks = Ranks(), execution_space space = execution_space(),
                       typename Detector::broad_phase options = {}, std::size_t chunk = std::size_t{1} << 20)
      : ranks_(std::move(ranks)), detector_(std::move(space), std::move(options)), chunk_{chunk} {
    if (chunk == 0) throw error("collide: distributed: chunk is 0");
  }

  /// For a mesh that is the same on every rank: queries then send nothing. As `detector::build` otherwise, also with a
  /// radius.
  void build(mesh_view<scalar> mesh, on_every_rank_t) {
    together(ranks_, [&] {
      is_divided_ = false;
      detector_.build(mesh);
    });
  }
  /// For a mesh that is the same on every rank, and spheres of radius up to `radius`; see `detector::build`.
  void build(mesh_view<scalar> mesh, scalar radius, on_every_rank_t) {
    together(ranks_, [&] {
      is_divided_ = false;
      detector_.build(mesh, radius);
    });
  }

  /// For a mesh of which each rank has some triangles, perhaps none. Their numbers are those of the whole mesh, in
  /// which the ranks' triangles follow one another. They are copied, and sorted among the ranks so that all have as
  /// many, and those near each other; the caller's mesh is not needed afterwards. Takes, of the host, 40 bytes of float
  /// or 76 of double for each triangle of a rank, twice that while it builds, and 0.3 MB for every 64 ranks; as much
  /// again in memory of a device; and what the detector takes for them. Throws `error` if there are more than 2^32 - 2
  /// triangles in all, or more on a rank than its detector builds (see `bucket::max_triangles`). O(triangles log
  /// triangles).
  void build(mesh_view<scalar> mine, divided_t) {
    if constexpr (alone) {
      build(mine, on_every_rank);
    } else {
      is_divided_ = true;
      is_built_ = false;
      mesh_.build(ranks_, detector_.space(), mine);
      together(ranks_, [&] { detector_.build(mesh_.view()); });
      is_built_ = true;
    }
  }

  /// As `detector::query`, of the spheres of this rank, perhaps none. Where the mesh is divided, spheres go to those
  /// other ranks that may have triangles for them, by way of memory of the host (pinned, if the space is a device), and
  /// pairs come back; with them the triangles, unless the sink says that it keeps ids alone (`keeps_ids_alone`, see
  /// concepts.hpp). Takes 8 bytes of the space for each such sphere and rank, as much again to sort them, and 8 for
  /// each pair. `nearest` takes an entry and a triangle for each sphere instead of pairs. Throws `error` if there was
  /// no `build`, or the last one failed.
  template <class Sink>
  Sink query(spheres_type const& spheres, Sink&& sink) {
    if constexpr (!alone) {
      if (is_divided_ && !is_built_) {
        throw error("collide: distributed: the last build has failed on some rank: build before you query");
      }
      if (is_divided_ && ranks_.size() > 1) {
        if constexpr (detail::sink_joins_parts<std::remove_reference_t<Sink>>) {
          search_divided(spheres, sink);
        } else {
          query_divided(spheres, sink);
        }
        return std::forward<Sink>(sink);
      }
    }
    together(ranks_, [&] { detector_.query(spheres, sink); });
    return std::forward<Sink>(sink);
  }

  /// Queries points, as `detector::query` does.
  template <class Points, class Sink, class = std::enable_if_t<std::is_same<Points, point_view<scalar>>::value>>
  Sink query(Points const& points, Sink&& sink) {
    return query(spheres_type(points, nullptr, 0, scalar(0)), std::forward<Sink>(sink));
  }

  /// The sum of `sink.total()` over all ranks: how many pairs collide.
  template <class Sink>
  std::uint64_t total(Sink const& sink) const {
    std::uint64_t const mine = sink.total();
    std::uint64_t all = 0;
    ranks_.reduce(&mine, &all, 1, reduction::sum);
    return all;
  }

  /// The ranks.
  Ranks const& ranks() const { return ranks_; }
  /// The detector of this rank: of the whole mesh, or of its part.
  Detector& local() { return detector_; }
  /// The space of this rank.
  execution_space& space() { return detector_.space(); }

 private:
  /// The search is for all ranks together, once the sink has its memory.
  template <class Sink>
  void search_divided(spheres_type const& spheres, Sink& sink) {
    std::function<void()> search;
    auto const put_off = [&](spheres_type const& of, auto const& f) {
      search = [this, &of, f] { nearest_.search(ranks_, detector_, mesh_, of, chunk_, f); };
    };
    together(ranks_, [&] {
      sink.run(detector_.space(), detail::search_query<Detector, decltype(put_off)>{spheres, put_off});
    });
    search();
  }

  template <class Sink>
  void query_divided(spheres_type const& spheres, Sink& sink) {
    using narrow_phase = typename Detector::narrow_phase;
    constexpr bool with_triangles = !detail::sink_keeps_ids_alone<std::remove_reference_t<Sink>>;
    remote_.find(ranks_, detector_, mesh_, spheres, chunk_, with_triangles);
    together(ranks_, [&] {
      found_.keep(detector_.space(), remote_.found(), remote_.size(), {mesh_.view(), {0, mesh_.numbers()}},
                  remote_.triangles(), mesh_.size());
      auto const query = found_.template query<narrow_phase>(detector_.space(), spheres);
      static_assert(detail::is_valid<detail::sink_run, std::remove_reference_t<Sink>, execution_space, decltype(query)>,
                    "collide: the second argument of query is a sink: an object with a member run(space, query)");
      sink.run(detector_.space(), query);
    });
  }

  Ranks ranks_;
  Detector detector_;
  std::size_t chunk_;
  bool is_divided_ = false;
  bool is_built_ = false;  ///< where the mesh is divided: on all ranks
  detail::divided_mesh<scalar> mesh_;
  detail::remote_pairs<Detector> remote_;
  detail::remote_nearest<Detector> nearest_;
  detail::found_pairs<scalar> found_;
};

}  // namespace collide
