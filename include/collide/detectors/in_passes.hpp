/// \file
/// Meshes larger than one build, or than the memory of the space: a detector gets them in parts, one after the other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/broad/detail/grid/memory_plan.hpp>
#include <collide/core/contact.hpp>
#include <collide/detector.hpp>
#include <collide/detectors/detail/found_query.hpp>
#include <collide/sinks/detail/search_mesh.hpp>
#include <collide/spaces/detail/check_memory.hpp>
#include <collide/spaces/detail/host_array.hpp>

namespace collide {

/// A detector of a mesh in host memory, however large: a query goes over the mesh in passes. Each builds the detector
/// of some triangles, and finds their pairs; at last the sink gets the pairs of all. It holds what it would hold after
/// a query of one detector of the whole mesh; in canonical order, the same bytes.
///
/// Memory of the space: what the detector takes for the triangles of a pass, with `bucket`, float and one radius about
/// 60 bytes each where most are small (30 in `cuda_shared`), and 450 at most (420) if no cell width is given, on the
/// host about 10; with `all_pairs` 32; what it takes for the spheres; up to 20 bytes for each pair, also where the sink
/// only counts; and what the sink takes. On a device, besides, 36 bytes of float or 72 of double for each triangle of a
/// pass; and, unless the sink keeps ids alone (`keeps_ids_alone`, see concepts.hpp), 40 or 80 for each triangle that is
/// hit, up to three times that of the host, and 8 of the host for each pair of a pass. It is kept between queries. On
/// the host the mesh is read where it lies. `nearest` has no pairs: it takes, besides its result, as much again and a
/// triangle for each point.
///
/// If one pass is enough the mesh is built once, and a query is one of the detector. Otherwise each query builds
/// every part again: give it all spheres at once. One object is for one thread at a time.
///
/// \tparam Detector  a `detector`
template <class Detector>
class in_passes {
  static_assert(detail::is_detector<Detector>,
                "collide: what gets a mesh in passes is a detector, such as detector<bucket>");

 public:
  using scalar = typename Detector::scalar;                    ///< type of the coordinates: float or double
  using spheres_type = typename Detector::spheres_type;        ///< that of the detector
  using execution_space = typename Detector::execution_space;  ///< that of the detector

  /// Without a mesh. The stream and the memory resource of the space must outlive it.
  explicit in_passes(execution_space space = execution_space(), typename Detector::broad_phase options = {})
      : max_triangles_{max_triangles_of(options, 0)}, detector_(std::move(space), std::move(options)) {}

  /// Divides the mesh into parts that follow each other in its order, all about as large: passes cost least where
  /// triangles near each other have numbers near each other. If there is one part alone, builds the detector of it.
  ///
  /// \param mesh  triangles in host memory, in any layout, which must stay valid and unchanged until the last query is
  ///              done; a mesh has at most 2^32 - 2
  /// \param triangles_per_pass  the most that a pass takes
  /// \throws error  if `triangles_per_pass` is 0, or CUDA knows the mesh's memory as device memory
  ///
  /// After an exception there is no mesh, and it can be built again.
  /// \complexity O(1); of one pass alone, O(triangles).
  void build(mesh_view<scalar> mesh, std::size_t triangles_per_pass) {
    passes_ = 0;
    if (triangles_per_pass == 0) throw error("collide: in_passes: there are 0 triangles per pass");
    detail::check_memory<host>(mesh, "in_passes: the mesh is", "parts of it are taken from host memory");
    mesh_ = mesh;
    std::size_t const passes = mesh.size() == 0 ? 1 : (mesh.size() - 1) / triangles_per_pass + 1;
    if (passes == 1) detector_.build(part(0, mesh.size()));
    passes_ = passes;
  }

  /// In as few passes as the broad phase allows: see `bucket::max_triangles`.
  void build(mesh_view<scalar> mesh) { build(mesh, max_triangles_); }

  /// As `detector::query`, of all triangles: every colliding pair goes to the sink, exactly once.
  ///
  /// \param spheres  in memory of the space, as for `detector::query`
  /// \param sink     any sink; what it throws is passed on
  /// \return the sink, as `detector::query` does
  /// \throws error  if there was no `build`, or the last one failed; and what the detector throws, such as `error` or
  ///                what the memory resource throws where a pass does not fit: then take fewer triangles per pass
  ///
  /// After an exception it can be used again; what the sink holds is then unspecified.
  /// \complexity O(triangles), and of each pass O(spheres + candidates) for `bucket`.
  /// \sync Waits for the pairs of each pass; then as the sink says.
  template <class Sink>
  Sink query(spheres_type const& spheres, Sink&& sink) {
    if (passes_ == 0) throw error("collide: in_passes: query needs a mesh: call build before it");
    if (passes_ == 1) {
      detector_.query(spheres, sink);
    } else if constexpr (detail::sink_joins_parts<std::remove_reference_t<Sink>>) {
      auto const search_parts = [this](spheres_type const& of, auto const& f) { search(of, f); };
      run(sink, detail::search_query<Detector, decltype(search_parts)>{spheres, search_parts});
    } else {
      find(spheres, !detail::sink_keeps_ids_alone<std::remove_reference_t<Sink>>);
      hand_over(spheres, sink);
    }
    return std::forward<Sink>(sink);
  }

  /// Queries points, as `detector::query` does.
  template <class Points, class Sink, class = std::enable_if_t<std::is_same<Points, point_view<scalar>>::value>>
  Sink query(Points const& points, Sink&& sink) {
    return query(spheres_type(points, nullptr, 0, scalar(0)), std::forward<Sink>(sink));
  }

  /// How many passes a query makes; 0 if there is no mesh.
  std::size_t passes() const { return passes_; }
  /// The space.
  execution_space& space() { return detector_.space(); }

 private:
  using narrow_phase = typename Detector::narrow_phase;
  static constexpr bool reads_host = execution_space::host_accessible;

  /// The most triangles of a build.
  template <class Options>
  static auto max_triangles_of(Options const& options, int) -> decltype(std::size_t{options.max_triangles}) {
    return std::min(options.max_triangles, detail::max_triangles_of_grid);
  }
  template <class Options>
  static auto max_triangles_of(Options const& options, int) -> decltype(std::size_t{options.grid.max_triangles}) {
    return max_triangles_of(options.grid, 0);
  }
  template <class Options>
  static std::size_t max_triangles_of(Options const&, long) {
    return detail::max_triangles_of_grid;
  }

  /// The first triangle of pass number `pass`.
  std::size_t begin_of(std::size_t pass) const {
    std::size_t const longer = mesh_.size() % passes_;
    return mesh_.size() / passes_ * pass + std::min(pass, longer);
  }

  /// Some triangles, in memory of the space.
  mesh_view<scalar> part(std::size_t first, std::size_t n) {
    mesh_view<scalar> const on_host = mesh_.subview(first, n);
    if constexpr (reads_host) {
      return on_host;
    } else {
      scalar* const to = corners_.reserve(space().resource(), 9 * n);
      constexpr std::size_t max_size = std::size_t{1} << 20;  // triangles that are packed at a time
      for (std::size_t i = 0; i < n; i += max_size) {
        std::size_t const some = std::min(max_size, n - i);
        packed_.resize(space(), 9 * some);
        host().for_each(some, detail::pack_triangles<scalar>{on_host.subview(i, some), packed_.data()});
        space().copy_from_host(to + 9 * i, packed_.data(), 9 * some);
      }
      return triangle_soup(static_cast<scalar const*>(to), n);
    }
  }

  /// Searches all parts, and joins what is found.
  template <class F>
  void search(spheres_type const& spheres, F const& f) {
    std::size_t const n = spheres.size();
    if (n == 0) return;
    detail::search_part<F> each{f};
    each.f.to = near_.reserve(space().resource(), n);
    triangle<scalar>* const corners = near_corners_.reserve(space().resource(), n);
    for (std::size_t pass = 0; pass < passes_; ++pass) {
      std::size_t const first = begin_of(pass);
      mesh_view<scalar> const triangles = part(first, begin_of(pass + 1) - first);
      detector_.build(triangles);
      detector_.query(spheres, each);
      space().for_each(n, typename F::join{{f.max_distance, spheres, f.to, corners},
                                           {triangles, {static_cast<id>(first), nullptr}},
                                           each.f.to,
                                           pass == 0});
    }
  }

  /// Finds the pairs of all passes. `with_triangles`: whether the triangles in them are kept for the device.
  void find(spheres_type const& spheres, [[maybe_unused]] bool with_triangles) {
    found_.clear();
    hit_.clear();
    if (spheres.size() == 0) return;
    for (std::size_t pass = 0; pass < passes_; ++pass) {
      std::size_t const first = begin_of(pass), size = begin_of(pass + 1) - first;
      detector_.build(part(first, size));
      detector_.query(spheres, hits_);
      pair* const to = found_.append(space(), hits_.size());
      space().for_each(hits_.size(),
                       detail::renumber_pairs{hits_.data(), {0, nullptr}, {static_cast<id>(first), nullptr}, to});
      if constexpr (!reads_host) {
        if (with_triangles) keep_hit_triangles(first, size);
      }
    }
  }

  /// Copies those of a pass that were hit, each once.
  void keep_hit_triangles(std::size_t first, std::size_t size) {
    if (hits_.size() == 0) return;
    std::vector<bool> is_hit(size);
    for (pair const& p : hits_.to_host()) is_hit[p.triangle] = true;
    for (std::size_t t = 0; t < size; ++t) {
      if (!is_hit[t]) continue;
      hit_.push_back(detail::numbered_triangle<scalar>::of(static_cast<id>(first + t), mesh_[first + t]));
    }
  }

  template <class Sink>
  void hand_over(spheres_type const& spheres, Sink& sink) {
    if constexpr (reads_host) {
      using query_type = detail::found_query<narrow_phase, execution_space, mesh_view<scalar>, scalar>;
      run(sink, query_type{space(), mesh_, spheres, found_.data(), found_.size()});
    } else {
      kept_.keep(space(), found_.data(), found_.size(), {}, hit_, mesh_.size());
      run(sink, kept_.template query<narrow_phase>(space(), spheres));
    }
  }

  template <class Sink, class Query>
  void run(Sink& sink, Query const& query) {
    static_assert(detail::is_valid<detail::sink_run, Sink, execution_space, Query>,
                  "collide: the second argument of query is a sink: an object with a member run(space, query)");
    sink.run(space(), query);
  }

  std::size_t max_triangles_;  ///< triangles of a build
  Detector detector_;
  mesh_view<scalar> mesh_;
  std::size_t passes_ = 0;
  pairs hits_;  ///< of a pass
  detail::pair_list found_;
  buffer<nearest_triangle<scalar>> near_;  ///< in a part
  buffer<triangle<scalar>> near_corners_;  ///< of the nearest so far
  // where the space is a device:
  buffer<scalar> corners_;             ///< of a pass
  detail::host_array<scalar> packed_;  ///< on their way
  std::vector<detail::numbered_triangle<scalar>> hit_;
  detail::found_pairs<scalar> kept_;
};

}  // namespace collide
