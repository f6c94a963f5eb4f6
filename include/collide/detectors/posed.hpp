/// \file
/// Meshes of which parts move as a whole, such as the links of a robot: each is indexed once, and queries say where it
/// is.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/detector.hpp>
#include <collide/detectors/detail/found_query.hpp>
#include <collide/detectors/detail/posed_hit.hpp>
#include <collide/effects/bodies.hpp>
#include <collide/simulation/detail/bodies/body_memory.hpp>

namespace collide {

/// A detector of bodies: parts of a mesh, each in a frame of its own, that take a pose in each query. Nothing is built
/// again as they move. Every colliding pair goes to the sink exactly once, with the numbers that the sphere and the
/// triangle have in the whole; contacts are in the world.
///
/// A body sees a sphere as bodies of simulations do: the centre is taken to its frame, R^-1 (centre - position), in
/// double, and rounded to the scalar of the coordinates; the radius is as it is. A displacement is the end less the
/// centre, both taken there, in double, and then rounded. Whether that sphere touches a triangle, as it lies in memory,
/// is decided as the narrow phase decides, so with `exact` as in real arithmetic. Contacts are computed there, and
/// point and normal are taken to the world the same way. The same bits in every space.
///
/// `nearest` and `k_nearest` decide within a body as the narrow phase says; of bodies the one with the smaller
/// `distance` as that is rounded comes first, and of equal ones the smaller number. The point is in the world.
///
/// `contains` and `signed_distance` are for bodies that are closed, each by itself. A point is inside if it is inside
/// of any body, or on its surface. The signed distance is the least of all bodies' in the same way. Outside of all it
/// is that of their union. Inside it is how deep the point is in the body in which it is deepest: of bodies that
/// overlap the surface of the union is at least as far away, and the triangle may be inside of another body. The
/// gradient is in the world. They agree: `contains` is 1 where `signed_distance` is at most 0.
///
/// Triangles of no body rest where they are; to these three those that follow each other in the mesh are one body.
/// Memory: an index of each body, 20 bytes of float or 32 of double for each sphere, 24 if radii differ or 40, and up
/// to 20 for each pair, also where the sink only counts; searches of what is nearest or around a point take as
/// much again as their results. It is kept. One object is for one thread at a time.
///
/// \tparam Detector  a `detector`; with a narrow phase for spheres that move, bodies rest in their poses as these do
template <class Detector>
class posed {
  static_assert(detail::is_detector<Detector>, "collide: posed is of a detector, such as posed<detector<bucket>>");

 public:
  using scalar = typename Detector::scalar;                    ///< type of the coordinates: float or double
  using spheres_type = typename Detector::spheres_type;        ///< that of the detector
  using execution_space = typename Detector::execution_space;  ///< that of the detector

  /// Without a mesh. The stream and the memory resource of the space must outlive it.
  explicit posed(execution_space space = execution_space(), typename Detector::broad_phase options = {})
      : space_{std::move(space)}, options_{std::move(options)} {}

  /// Indexes each body.
  ///
  /// \param mesh    triangles in memory of the space, each body's in its own frame; not copied: valid and unchanged
  ///                until the last query is done
  /// \param bodies  their triangles, at most 64 of them; motions are not asked for
  /// \throws error  if a triangle is in two bodies, or in none of the mesh, or there are more than 64
  ///
  /// After an exception there is no mesh, and it can be built again.
  /// \complexity O(triangles).
  /// \sync Waits.
  void build(mesh_view<scalar> mesh, std::vector<body> const& bodies) { build_each(mesh, bodies); }

  /// Indexes each body, for spheres of up to a radius; see `detector::build`.
  ///
  /// \param mesh    as for the other `build`
  /// \param bodies  as for the other `build`
  /// \param radius  the largest usual radius, as for `detector::build`
  /// \throws error  as the other `build`, and if `radius` is negative or NaN
  void build(mesh_view<scalar> mesh, std::vector<body> const& bodies, scalar radius) {
    build_each(mesh, bodies, radius);
  }

  /// As `detector::query`, of bodies that are where `poses` says.
  ///
  /// \param spheres  in memory of the space, as for `detector::query`
  /// \param poses    on the host, one for each body in their order; rotations are made unit quaternions
  /// \param sink     `count`, `any_hit`, `pairs`, `csr`, `contacts`, `closest`, `closest_contact`, or `visit` of a
  ///                 function that takes any hit; of spheres that move also `impacts`, `earliest`, `earliest_impact`;
  ///                 `nearest`, `k_nearest`, `contains` or `signed_distance`, with a broad phase that finds what is
  ///                 near
  /// \return the sink, as `detector::query` does
  /// \throws error  if there was no `build`, there are not as many poses as bodies, or one is not finite or no rotation
  ///
  /// \complexity O(spheres * bodies), and of each body what a query of the spheres near it takes.
  /// \sync Waits for the spheres and the pairs of each body; then as the sink says.
  template <class Sink>
  Sink query(spheres_type const& spheres, std::vector<pose> const& poses, Sink&& sink) {
    if (!is_built_) throw error("collide: posed: query needs a mesh: call build before it");
    place(poses);
    if constexpr (detail::searches_bodies<std::decay_t<Sink>>) {
      run_search(spheres, sink);
    } else {
      run(spheres, sink);
    }
    return std::forward<Sink>(sink);
  }

  /// Queries points, which are spheres of radius 0; as for spheres otherwise.
  template <class Sink>
  Sink query(point_view<scalar> const& points, std::vector<pose> const& poses, Sink&& sink) {
    return query(spheres_type(points, nullptr, 0, scalar(0)), poses, std::forward<Sink>(sink));
  }

  /// How many bodies there are.
  std::size_t size() const { return bodies_.size(); }
  /// The space.
  execution_space& space() { return space_; }

 private:
  static constexpr bool is_at_rest = std::is_same<spheres_type, sphere_view<scalar>>::value;

  /// Triangles that follow each other, of one body or of none.
  struct part {
    std::size_t first, size;
    int frame;
  };

  template <class... Radius>
  void build_each(mesh_view<scalar> mesh, std::vector<body> const& bodies, Radius... radius) {
    is_built_ = false;
    detectors_.clear();
    bodies_.check(bodies, mesh.size(), nullptr, "posed");
    bodies_.build(space_, mesh, bodies, nullptr);
    mesh_ = mesh;
    divide(bodies);
    space_.fill(time_.reserve(space_.resource(), 1), 0, sizeof(double));
    for (part const& p : parts_)
      detectors_.emplace_back(space_, options_).build(mesh.subview(p.first, p.size), radius...);
    is_built_ = true;
  }

  /// The parts of the mesh, in its order.
  void divide(std::vector<body> const& bodies) {
    parts_.clear();
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      if (bodies[k].size != 0) parts_.push_back({bodies[k].first, bodies[k].size, static_cast<int>(k) + 1});
    }
    std::sort(parts_.begin(), parts_.end(), [](part const& a, part const& b) { return a.first < b.first; });
    std::vector<part> at_rest;
    std::size_t end = 0;
    for (part const& p : parts_) {
      if (p.first != end) at_rest.push_back({end, p.first - end, 0});
      end = p.first + p.size;
    }
    if (end != mesh_.size()) at_rest.push_back({end, mesh_.size() - end, 0});
    parts_.insert(parts_.end(), at_rest.begin(), at_rest.end());
    if (parts_.empty()) parts_.push_back({0, 0, 0});
  }

  void place(std::vector<pose> const& poses) {
    if (poses.size() != bodies_.size()) throw error("collide: posed: query needs a pose for each body");
    for (auto& of_part : detectors_) of_part.space() = space_;  // which may have another stream by now
    std::vector<body_state> states(poses.size());
    for (std::size_t k = 0; k < poses.size(); ++k) {
      states[k].at = poses[k];
      body_state checked = states[k];
      if (!detail::make_unit(checked))
        throw error("collide: posed: the pose of body " + std::to_string(k) +
                    " is not finite, or its rotation is no unit quaternion");
    }
    space_.copy_from_host(bodies_.states(), states.data(), states.size());
    bodies_.advance(space_, driven(), time_.data(), 0, 0, false, true);
  }

  template <class Sink>
  void run(spheres_type const& spheres, Sink& sink) {
    found_.clear();
    if (spheres.size() != 0) find(spheres);
    using query_type = detail::found_query<detail::in_frames<typename Detector::narrow_phase>, execution_space,
                                           detail::moving_mesh<scalar>, scalar>;
    static_assert(detail::is_valid<detail::sink_run, std::remove_reference_t<Sink>, execution_space, query_type>,
                  "collide: the third argument of query is a sink: an object with a member run(space, query)");
    sink.run(space_, query_type{space_, mesh(), spheres, found_.data(), found_.size()});
  }

  /// Searches the parts one after the other.
  template <class Sink>
  void run_search(spheres_type const& spheres, Sink& sink) {
    using result = std::decay_t<decltype(*sink.data())>;
    auto const search = [this](spheres_type const& from, auto const& f) {
      std::size_t const n = from.size();
      auto* const resource = space_.resource();
      scalar* const centres = centres_.reserve(resource, 3 * n);
      scalar* const radii = from.one_radius() ? nullptr : radii_.reserve(resource, n);
      auto of_part = f;
      std::size_t const width = detail::width_of(f);
      of_part.to = std::get<buffer<result>>(of_part_).reserve(resource, n * width);
      for (std::size_t k = 0; k < parts_.size(); ++k) {
        part const& p = parts_[k];
        space_.for_each(n, detail::see_from_body<scalar>{mesh(), p.frame, from, centres, radii});
        detectors_[k].query(view_of(from, centres, radii, n), detail::search_part<decltype(of_part)>{of_part});
        space_.for_each(n, detail::take_first<scalar, result>{mesh(), p.frame, static_cast<id>(p.first), width,
                                                              of_part.to, f.to, k == 0});
      }
    };
    sink.run(space_, detail::search_query<Detector, decltype(search)>{spheres, search});
  }

  /// Spheres as a body sees them.
  static sphere_view<scalar> view_of(spheres_type const& spheres, scalar const* centres, scalar const* radii,
                                     std::size_t n) {
    auto const at = points<scalar>(centres, n);
    return radii == nullptr ? spheres_at(at, spheres.common_radius()) : spheres_at(at, radii);
  }

  /// Finds the pairs of all parts.
  void find(spheres_type const& spheres) {
    auto* const resource = space_.resource();
    constexpr unsigned group = execution_space::host_accessible ? 64 : 1;
    std::size_t const n = spheres.size();
    auto* const count = clear_count();
    id* const near = near_.reserve(resource, n);
    space_.for_each((n + group - 1) / group,
                    detail::list_near_bodies<spheres_type, group>{mesh(), bodies_.margin(), spheres, count, near});
    std::size_t const size = space_.read(count);
    numbers_.reserve(resource, n);
    centres_.reserve(resource, 3 * n);
    if (!spheres.one_radius()) radii_.reserve(resource, n);
    if (!is_at_rest) displacements_.reserve(resource, 3 * n);
    for (std::size_t k = 0; size != 0 && k < parts_.size(); ++k) find(spheres, size, parts_[k], detectors_[k]);
  }

  /// Finds the pairs of a part and the first `n` spheres that are listed.
  void find(spheres_type const& spheres, std::size_t n, part const& p, Detector& detector) {
    auto* const count = clear_count();
    scalar* const radii = spheres.one_radius() ? nullptr : radii_.data();
    space_.for_each(
        n, detail::list_near_body<spheres_type>{mesh(), p.frame, bodies_.margin(), spheres, near_.data(), count,
                                                numbers_.data(), centres_.data(), radii, displacements_.data()});
    std::size_t const size = space_.read(count);
    if (size == 0) return;
    auto const seen = view_of(spheres, centres_.data(), radii, size);
    if constexpr (is_at_rest) {
      detector.query(seen, hits_);
    } else {
      detector.query(with_displacements(seen, displacements_.data()), hits_);
    }
    pair* const to = found_.append(space_, hits_.size());
    space_.for_each(hits_.size(), detail::renumber_pairs{
                                      hits_.data(), {0, numbers_.data()}, {static_cast<id>(p.first), nullptr}, to});
  }

  std::uint32_t* clear_count() {
    std::uint32_t* const count = count_.reserve(space_.resource(), 1);
    space_.fill(count, 0, sizeof *count);
    return count;
  }

  detail::moving_mesh<scalar> mesh() const { return bodies_.moving(mesh_, 0); }

  execution_space space_;
  typename Detector::broad_phase options_;
  mesh_view<scalar> mesh_;
  bool is_built_ = false;
  detail::body_memory<scalar, driven> bodies_;
  std::vector<part> parts_;
  std::vector<Detector> detectors_;  ///< of the parts
  pairs hits_;                       ///< of a part
  detail::pair_list found_;
  buffer<double> time_;
  buffer<std::uint32_t> count_;
  buffer<id> near_;                                 ///< spheres near any part
  buffer<id> numbers_;                              ///< of spheres near a part,
  buffer<scalar> centres_, radii_, displacements_;  ///< as it sees them
  /// Results of a search of a part.
  std::tuple<buffer<nearest_triangle<scalar>>, buffer<signed_nearest_triangle<scalar>>, buffer<std::uint8_t>> of_part_;
};

}  // namespace collide
