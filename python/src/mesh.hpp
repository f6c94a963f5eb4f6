/// \file
/// collide.Mesh for one space and one type of coordinates: detectors, made when a query first needs them.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include <collide/bucket.cuh>
#include <collide/bvh.cuh>
#include <collide/checks/validate.hpp>
#include <collide/checks/validate_surface.hpp>
#include <collide/detectors/posed.hpp>
#include <collide/karabassi.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/sinks/csr.hpp>
#include <collide/sinks/earliest.hpp>
#include <collide/sinks/impacts.hpp>
#include <collide/sinks/k_nearest.hpp>
#include <collide/sinks/signed_distance.hpp>
#include <collide/sinks/winding_number.hpp>

#include "closed.hpp"
#include "runtime.hpp"

namespace collide_python {

/// Kernel functor of `for_each` over points: takes the distance out of what was found.
template <class Record, class S>
struct take_distance {
  Record const* from;
  S* to;
  COLLIDE_HD void operator()(std::size_t i) const { to[i] = from[i].distance; }
};

/// What all queries with spheres have.
struct question {
  std::string_view precision;
  nb::object radius, displacements;  ///< the last one is None for spheres at rest
  collide::order order;
  nb::object capacity;                      ///< None, or for how many results there is room at most
  nb::object out;                           ///< None, or an array for them
  bool numpy;                               ///< whether results are numpy arrays
  std::vector<collide::pose> const& poses;  ///< of all bodies, or none where they are as they lie in memory
};

template <class Space, class S>
class mesh : public called<Space> {
 public:
  mesh(int threads, int device) : called<Space>(threads, device) {}

  void begin() {}

  /// Reads other arrays from now on; without triangles those of before. After an error it is as it was.
  void take(nb::object const& vertices, nb::object const& triangles, bool validate) {
    array const v = import_array(vertices, "vertices", runtime_.at());
    collide::point_view<S> const points = points_of<S>(v, "vertices", is_set_ ? " as before" : " or float64");
    corners t = triangles_;
    if (!triangles.is_none()) {
      t = copied(runtime_.keep(import_array(triangles, "triangles", runtime_.at())), points, validate);
    } else if (is_set_ && points.size() != view_.vertices().size()) {
      refuse("vertices", "has shape " + shape_of(v) + ", expected " + text_of({view_.vertices().size(), 3}) +
                             " as before: the triangles are the same");
    } else if (t.memory == nullptr && points.size() % 3 != 0) {
      refuse("vertices", "has shape " + shape_of(v) + ", but without triangles there are three rows for each");
    }
    view_ = t.memory != nullptr ? collide::indexed_mesh(points, t.data, t.size) : collide::triangle_soup(points);
    vertices_ = v;
    triangles_ = t;
    is_set_ = true;
    is_built_ = {};
  }

  /// Parts of the mesh that take poses: the first triangle of each, and how many. None: all is one.
  void divide(std::vector<std::pair<std::size_t, std::size_t>> const& bodies) {
    bodies_.clear();
    for (auto const& one : bodies) bodies_.push_back({one.first, one.second, {}});
    is_built_[5] = is_built_[6] = false;
  }

  std::size_t size() const { return view_.size(); }
  collide::mesh_view<S> const& view() const { return view_; }
  /// What keeps the memory of the view.
  std::pair<array, std::shared_ptr<void>> memory() const { return {vertices_, triangles_.memory}; }
  /// The triangles as they were given, or None: packed int32.
  nb::object triangles(bool numpy) {
    if (triangles_.memory == nullptr) return nb::none();
    auto own = std::make_unique<kept<std::shared_ptr<void>>>(runtime_.memory());
    own->sink = triangles_.memory;
    return given<std::int32_t>(triangles_.data, {triangles_.size, 3}, owner_of(std::move(own)), numpy);
  }

  /// Checks a mesh of the host. `what` is closed: a sentence, whether it is closed and oriented, and triangles and
  /// edges of each kind of problem; surface: a sentence, and pairs of triangles of each kind; or intersections: pairs.
  nb::object check(std::string_view what, double tolerance) {
    if (what == "intersections")
      return two_columns(without_the_gil([&] { return collide::self_intersections(view_, on_host()); }));
    nb::list parts;
    if (what == "closed") {
      auto const report = without_the_gil([&] { return collide::validate_closed(view_); });
      for (int k = 0; k < collide::seam_problem_count; ++k)
        parts.append(two_columns(report.where(static_cast<collide::seam_problem>(k))));
      return nb::make_tuple(report.message(), report.closed(), report.oriented(), parts);
    }
    auto const report = without_the_gil([&] { return collide::validate_surface(view_, tolerance, on_host()); });
    for (int k = 0; k < collide::surface_problem_count; ++k)
      parts.append(two_columns(report.where(static_cast<collide::surface_problem>(k))));
    return nb::make_tuple(report.message(), parts);
  }

  /// Whether each edge has an even number of triangles, as far as a number of 64 bits tells; on a GPU it does not look.
  bool seems_closed() {
    if constexpr (Space::host_accessible) {
      without_gil const others_run;
      return collide_python::seems_closed(view_, runtime_.space());
    } else {
      return true;
    }
  }

  /// What spheres touch. `what` is pairs, contacts, impacts, or closest or earliest, which are one for each sphere:
  /// records as rows of int32, how many there are, and how many in all; or count, a number; any, flags; csr, offsets
  /// and triangles.
  /// `results` are whether they are sorted, the capacity, `out`, and whether they are numpy's.
  nb::object query(std::string_view what, nb::object const& centres, nb::object const& radius,
                   nb::object const& displacements, std::string_view precision,
                   std::vector<std::vector<double>> const& poses, nb::tuple const& results) {
    auto const placed = poses_of(poses);
    auto const order = nb::cast<bool>(results[0]) ? collide::order::canonical : collide::order::unspecified;
    question const q{precision, radius, displacements, order, results[1], results[2], nb::cast<bool>(results[3]),
                     placed};
    array const x = runtime_.keep(import_array(centres, "centres", runtime_.at()));
    if (what == "pairs") return records<collide::pair, collide::pairs>(q, x);
    if (what == "contacts") return records<collide::contact<S>, collide::contacts<S>>(q, x);
    if (what == "impacts") return records<collide::impact<S>, collide::impacts<S>>(q, x);
    if (what == "closest") return records<collide::contact<S>, collide::closest_contact<S>>(q, x);
    if (what == "earliest") return records<collide::impact<S>, collide::earliest_impact<S>>(q, x);
    if (what == "csr") return rows(q, x);
    if (what == "count") {
      collide::count sink;
      ask(q, sink, x);
      return nb::cast(sink.total());
    }
    nb::object found;
    std::size_t const n = points_of<S>(x, "centres").size();
    collide::any_hit sink(each<std::uint8_t>(found, {n}, q.out, q.numpy));
    ask(q, sink, x);
    return nb::make_tuple(found, n);
  }

  /// What is near each point, in `out` or in memory of its own: `what` is nearest, k_nearest, signed_distance or
  /// winding, one record or k of them, and how many points there are; contains, flags; or distance or sides, numbers,
  /// which have a sign in the latter. `number` is k, or beta of winding numbers.
  nb::object search(std::string_view what, nb::object const& from, double number, double max_distance,
                    std::vector<std::vector<double>> const& poses, nb::tuple const& results) {
    auto const placed = poses_of(poses);
    array const kept_points = runtime_.keep(import_array(from, "points", runtime_.at()));
    if (!(max_distance >= 0)) refuse("max_distance", "is negative or NaN");
    S const farthest = static_cast<S>(max_distance);
    place_of_points const at{points_of<S>(kept_points, "points"), placed, results[2], nb::cast<bool>(results[3])};
    if (what == "contains") return found_by(at, collide::contains());
    if (what == "distance") return distances(at, collide::nearest<S>(farthest));
    if (what == "sides") return distances(at, collide::signed_distance<S>(farthest));
    if (what == "signed_distance") return found_by(at, collide::signed_distance<S>(farthest));
    if (what == "nearest") return found_by(at, collide::nearest<S>(farthest));
    if (what == "winding") return found_by(at, collide::winding_number<S>(number));
    auto const k = static_cast<int>(number);
    return found_by(at, collide::k_nearest<S>(k, farthest), {at.points.size(), static_cast<std::size_t>(k)});
  }

 private:
  using called<Space>::runtime_;
  template <class Precision>
  using at_rest = collide::detector<collide::bucket, collide::karabassi<Precision>, Space, S>;
  using swept = collide::detector<collide::bucket, collide::karabassi_swept<>, Space, S>;

  /// A sink with memory that lives as long as its results.
  template <class Sink>
  struct kept {
    std::shared_ptr<void> memory;
    collide::buffer<unsigned char> room;
    Sink sink;
    explicit kept(std::shared_ptr<void> m) : memory(std::move(m)) {}
    /// Room for so many records.
    template <class Record>
    Record* records(runtime<Space> const& of, std::size_t n) {
      if (n > static_cast<std::size_t>(PTRDIFF_MAX) / sizeof(Record)) throw std::bad_alloc();
      return reinterpret_cast<Record*>(room.reserve(of.space().resource(), n * sizeof(Record)));
    }
  };
  struct nothing {};

  /// Triangles in memory of our own, so that they stay what they were when they were checked.
  struct corners {
    std::shared_ptr<void> memory;
    collide::id const* data = nullptr;
    std::size_t size = 0;
  };
  corners copied(array const& a, collide::point_view<S> const& points, bool validate) {
    check_triangles(a, points.size());
    auto const own = std::make_shared<kept<nothing>>(runtime_.memory());
    std::size_t const n = a.shape(0);
    without_gil const others_run;
    auto const space = runtime_.space();
    auto* const to = own->template records<collide::id>(runtime_, 3 * n);
    auto const last = static_cast<collide::id>(points.size() - 1);
    copy_triangles(space, a, points.size(), validate ? collide::no_id : last, to);
    if (validate) {
      auto const report = collide::validate(collide::indexed_mesh(points, to, n), space);
      if (report.count(collide::problem::corner_out_of_range) != 0)
        throw std::invalid_argument("triangles: " + report.message());
    }
    return {own, to, n};
  }

  template <class Record, class Sink>
  nb::object records(question const& q, array const& centres) {
    constexpr std::size_t words = sizeof(Record) / 4;
    auto own = std::make_unique<kept<Sink>>(runtime_.memory());
    if constexpr (std::is_constructible<Sink, Record*, std::size_t, collide::order>::value) {  // many for a sphere
      own->sink = Sink(q.order);
      std::size_t n = 0;
      if (!q.out.is_none()) {
        auto* const to = room_of<std::int32_t>(q.out, runtime_.at(), {any_number, words}, &n);
        own->sink = Sink(reinterpret_cast<Record*>(to), n, q.order);
      } else if (!q.capacity.is_none()) {
        n = nb::cast<std::size_t>(q.capacity);
        own->sink = Sink(own->template records<Record>(runtime_, n), n, q.order);
      }
    }
    ask(q, own->sink, centres);
    std::size_t const n = own->sink.size();
    std::uint64_t const total = own->sink.total();
    if (!q.out.is_none()) return nb::make_tuple(q.out, n, total);
    auto const* const data = own->sink.data();
    return nb::make_tuple(given<std::int32_t>(data, {n, words}, owner_of(std::move(own)), q.numpy), n, total);
  }

  nb::object rows(question const& q, array const& centres) {
    auto own = std::make_unique<kept<collide::csr>>(runtime_.memory());
    collide::csr& sink = own->sink = collide::csr(q.order);
    ask(q, sink, centres);
    nb::object const owner = owner_of(std::move(own));
    return nb::make_tuple(given<std::int64_t>(sink.offsets(), {sink.rows() + 1}, owner, q.numpy),
                          given<std::int32_t>(sink.triangles(), {sink.size()}, owner, q.numpy));
  }

  template <class T>
  nb::object given(void const* data, std::vector<std::size_t> const& shape, nb::object const& owner, bool numpy) {
    return give(data, nb::dtype<T>(), shape, owner, runtime_.at(), numpy);
  }

  /// Has the detector of a precision answer, while other threads run.
  template <class Sink>
  void ask(question const& q, Sink& sink, array const& centres) {
    array radii, displacements;
    auto const points = points_of<S>(centres, "centres");
    auto const spheres = spheres_of(points, q.radius, radii, runtime_.at());
    if (radii.is_valid()) runtime_.keep(radii);
    if (q.displacements.is_none()) {
      if constexpr (!needs_motion<Sink>) {
        if (!q.poses.empty()) {
          if (q.precision != "exact") refuse("precision", "of a mesh in poses is 'exact'");
          return run_posed(posed_, 5, spheres, q.poses, sink);
        }
        if (q.precision == "exact") return run<0>(std::get<0>(at_rest_), spheres, sink);
        if (q.precision == "single") return run<1>(std::get<1>(at_rest_), spheres, sink);
        if (q.precision == "double") return run<2>(std::get<2>(at_rest_), spheres, sink);
        refuse("precision", "is '" + std::string(q.precision) + "', expected 'exact', 'double' or 'single'");
      } else {
        refuse("displacements", "impacts are of spheres that move");
      }
    } else if constexpr (needs_rest<Sink>) {
      refuse("displacements", "the closest triangle is of spheres at rest: ask for impacts");
    } else {
      displacements = runtime_.keep(import_array(q.displacements, "displacements", runtime_.at()));
      auto const paths = points_of<S>(displacements, "displacements");
      if (paths.size() != points.size())
        refuse("displacements", "has " + std::to_string(paths.size()) + " rows, expected " +
                                    std::to_string(points.size()) + ", one for each centre");
      if (q.precision != "exact") refuse("precision", "spheres that move are decided exactly: 'exact'");
      auto const moving = collide::with_displacements(spheres, paths);
      if (q.poses.empty()) return run<3>(swept_, moving, sink);
      if constexpr (needs_motion<Sink>) {
        run_posed(posed_swept_, 6, moving, q.poses, sink);
      } else {
        refuse("displacements", "of a mesh in poses are for impacts");
      }
    }
  }

  /// Points of the caller, where the mesh is, and where results go.
  struct place_of_points {
    collide::point_view<S> points;
    std::vector<collide::pose> const& poses;
    nb::object out;
    bool numpy;
  };

  /// Has a sink look at points, while other threads run.
  template <class Sink>
  void look(collide::point_view<S> const& points, std::vector<collide::pose> const& poses, Sink& sink) {
    if constexpr (!std::is_same<Sink, collide::winding_number<S>>::value) {  // which is of a whole mesh
      if (!poses.empty()) return run_posed(posed_, 5, points, poses, sink);
    }
    run<4>(nearby_, points, sink);
  }

  /// What a sink finds of each point, and how many points there are.
  template <class Sink>
  nb::object found_by(place_of_points const& at, Sink sink, std::vector<std::size_t> shape = {}) {
    std::size_t const n = at.points.size();
    if (shape.empty()) shape = {n};
    nb::object found;
    sink.write_to(each<std::decay_t<decltype(*sink.data())>>(found, shape, at.out, at.numpy));
    look(at.points, at.poses, sink);
    return nb::make_tuple(found, n);
  }

  /// Distances alone, by way of records for some points at a time.
  template <class Sink>
  nb::object distances(place_of_points const& at, Sink sink) {
    using record = std::decay_t<decltype(*sink.data())>;
    std::size_t const n = at.points.size(), most = Space::host_accessible ? 1u << 16 : 1u << 20;
    nb::object found;
    S* const to = each<S>(found, {n}, at.out, at.numpy);
    auto const room = std::make_unique<kept<nothing>>(runtime_.memory());
    record* const records = room->template records<record>(runtime_, std::min(n, most));
    sink.write_to(records);
    for (std::size_t first = 0; first < n; first += most) {
      std::size_t const m = std::min(n - first, most);
      look(at.points.subview(first, m), at.poses, sink);
      runtime_.space().for_each(m, take_distance<record, S>{records, to + first});
    }
    return nb::make_tuple(found, n);
  }

  /// Where records go, each `shape` of them, and in `found` the array that shows them: `out`, or of memory of its own.
  template <class Record>
  Record* each(nb::object& found, std::vector<std::size_t> shape, nb::object const& out, bool numpy) {
    constexpr bool is_number = sizeof(Record) == 1 || std::is_same<Record, S>::value;
    using word = std::conditional_t<is_number, Record, std::int32_t>;
    std::size_t n = 1;
    for (std::size_t const m : shape) n *= m;
    if (!is_number) shape.push_back(sizeof(Record) / sizeof(word));
    found = out;
    if (!out.is_none()) return reinterpret_cast<Record*>(room_of<word>(out, runtime_.at(), shape));
    auto own = std::make_unique<kept<nothing>>(runtime_.memory());
    Record* const to = own->template records<Record>(runtime_, n);
    found = given<word>(to, shape, owner_of(std::move(own)), numpy);
    return to;
  }

  /// The bodies' poses, or none; each is a position, and a unit quaternion w, x, y, z.
  std::vector<collide::pose> poses_of(std::vector<std::vector<double>> const& numbers) {
    std::size_t const expected = bodies_.empty() ? 1 : bodies_.size();
    if (!numbers.empty() && numbers.size() != expected)
      refuse("poses", "there are " + std::to_string(numbers.size()) + ", expected " + std::to_string(expected) +
                          ", one for each body");
    std::vector<collide::pose> poses;
    for (std::vector<double> const& from : numbers) {
      if (from.size() != 7) refuse("poses", "has rows of other than 7 numbers: a position and a quaternion w, x, y, z");
      collide::pose one;
      std::copy(from.begin(), from.begin() + 3, one.position);
      std::copy(from.begin() + 3, from.end(), one.rotation);
      poses.push_back(one);
    }
    return poses;
  }

  template <class Detector, class Spheres, class Sink>
  void run_posed(Detector& posed, std::size_t number, Spheres const& spheres, std::vector<collide::pose> const& poses,
                 Sink& sink) {
    without_gil const others_run;
    posed.space() = runtime_.space();
    if (!is_built_[number])
      posed.build(view_, bodies_.empty() ? std::vector<collide::body>{{0, view_.size(), {}}} : bodies_);
    is_built_[number] = true;
    posed.query(spheres, poses, sink);
  }

  template <class Check>
  static auto without_the_gil(Check const& check) {
    without_gil const others_run;
    return check();
  }
  collide::host on_host() const { return collide::host(runtime_.where().threads); }

  /// Pairs of numbers of 32 bits as an array of numpy.
  template <class Pair>
  nb::object two_columns(std::vector<Pair> const& pairs) {
    static_assert(sizeof(Pair) == 2 * sizeof(std::int32_t));
    auto own = std::make_unique<std::vector<Pair>>(pairs);
    void const* const data = own->data();
    return give(data, nb::dtype<std::int32_t>(), {pairs.size(), 2}, owner_of(std::move(own)), {}, true);
  }

  template <std::size_t number, class Detector, class Spheres, class Sink>
  void run(Detector& detector, Spheres const& spheres, Sink& sink) {
    without_gil const others_run;
    detector.space() = runtime_.space();
    if (!is_built_[number]) detector.build(view_);
    is_built_[number] = true;
    std::size_t const n = spheres.size();
    if constexpr (runtime<Space>::is_cuda && has_total<Sink>::value) {  // a second pass would cost more than some room
      if (pairs_a_sphere_ > 0)
        sink.reserve(detector.space(), n, static_cast<std::size_t>(1.2 * pairs_a_sphere_ * double(n)));
    }
    detector.query(spheres, sink);
    if constexpr (has_total<Sink>::value) {
      if (n != 0) pairs_a_sphere_ = static_cast<double>(sink.total()) / static_cast<double>(n);
    }
  }

  template <class Sink, class = void>
  struct has_total : std::false_type {};
  template <class Sink>
  struct has_total<Sink, std::void_t<decltype(std::declval<Sink&>().total())>> : std::true_type {};

  template <class Sink>
  static constexpr bool needs_motion =
      std::is_same<Sink, collide::impacts<S>>::value || std::is_same<Sink, collide::earliest_impact<S>>::value;
  template <class Sink>
  static constexpr bool needs_rest = std::is_same<Sink, collide::closest_contact<S>>::value;

  array vertices_;
  corners triangles_;
  collide::mesh_view<S> view_;
  std::tuple<at_rest<collide::exact>, at_rest<collide::single_precision>, at_rest<collide::double_precision>> at_rest_{
      at_rest<collide::exact>(runtime_.space()), at_rest<collide::single_precision>(runtime_.space()),
      at_rest<collide::double_precision>(runtime_.space())};
  swept swept_{runtime_.space()};
  collide::detector<collide::bvh, collide::karabassi<>, Space, S> nearby_{runtime_.space()};
  collide::posed<collide::detector<collide::bvh, collide::karabassi<>, Space, S>> posed_{runtime_.space()};
  collide::posed<swept> posed_swept_{runtime_.space()};
  std::vector<collide::body> bodies_;
  bool is_set_ = false;
  double pairs_a_sphere_ = 0;  ///< of the last query
  std::array<bool, 7> is_built_{};
};

}  // namespace collide_python
