/// \file
/// collide.Mesh for one space and one type of coordinates: detectors, made when a query first needs them.
#pragma once

#include <memory>
#include <optional>
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

/// Where the bodies of a mesh are, and how results go back.
struct wishes {
  std::vector<collide::pose> poses;  ///< of all bodies, or none where they are as they lie in memory
  collide::order order;
  nb::object capacity;  ///< None, or for how many results there is room at most
  nb::object out;       ///< None, or an array for them
  bool numpy;           ///< whether results are numpy arrays
};

/// A detector, and of which version of the mesh.
template <class Detector>
struct prepared {
  template <class Space>
  explicit prepared(Space const& space) : detector(space) {}

  Detector detector;
  std::uint64_t version = 0;
};

template <class Space, class S>
class mesh : public called<Space> {
 public:
  /// `bodies` are the parts of the mesh that take poses: the first triangle of each, and how many. None: all is one.
  mesh(int threads, int device, std::vector<std::pair<std::size_t, std::size_t>> const& bodies)
      : called<Space>(threads, device) {
    for (auto const& one : bodies) bodies_.push_back({one.first, one.second, {}});
  }

  void begin() {}

  /// Reads other arrays from now on; without triangles those of before. After an error it is as it was.
  void take(nb::object const& vertices, nb::object const& triangles, bool validate) {
    array const v = import_array(vertices, "vertices", runtime_.at());
    bool const is_set = version_ != 0;
    collide::point_view<S> const points = points_of<S>(v, "vertices", is_set ? " as before" : " or float64");
    corners t = triangles_;
    if (!triangles.is_none()) {
      t = copied(runtime_.keep(import_array(triangles, "triangles", runtime_.at())), points, validate);
    } else if (is_set && points.size() != view_.vertices().size()) {
      refuse("vertices", "has shape " + shape_of(v) + ", expected " + text_of({view_.vertices().size(), 3}) +
                             " as before: the triangles are the same");
    } else if (t.memory == nullptr && points.size() % 3 != 0) {
      refuse("vertices", "has shape " + shape_of(v) + ", but without triangles there are three rows for each");
    }
    view_ = t.memory != nullptr ? collide::indexed_mesh(points, t.data, t.size) : collide::triangle_soup(points);
    vertices_ = v;
    triangles_ = t;
    ++version_;
  }

  std::size_t size() const { return view_.size(); }
  collide::mesh_view<S> const& view() const { return view_; }
  /// What keeps the memory of the view.
  std::pair<array, std::shared_ptr<void>> memory() const { return {vertices_, triangles_.memory}; }
  /// The triangles as they were given, or None: packed int32.
  nb::object triangles(bool numpy) {
    if (triangles_.memory == nullptr) return nb::none();
    auto own = std::make_unique<std::shared_ptr<void>>(triangles_.memory);
    return given<std::int32_t>(triangles_.data, {triangles_.size, 3}, owner_of(std::move(own)), numpy);
  }

  /// Checks a mesh of the host. `what` is closed: a sentence, whether it is closed and oriented, and triangles and
  /// edges of each kind of problem; surface: a sentence, and pairs of triangles of each kind; or intersections: pairs.
  nb::object check(std::string_view what, double tolerance) {
    if (what == "intersections")
      return two_columns(without_the_gil([&] { return collide::self_intersections(view_, on_host()); }));
    if (what == "closed") {
      auto const report = without_the_gil([&] { return collide::validate_closed(view_); });
      auto const parts = parts_of<collide::seam_problem>(report, collide::seam_problem_count);
      return nb::make_tuple(report.message(), report.closed(), report.oriented(), parts);
    }
    auto const report = without_the_gil([&] { return collide::validate_surface(view_, tolerance, on_host()); });
    return nb::make_tuple(report.message(), parts_of<collide::surface_problem>(report, collide::surface_problem_count));
  }

  /// Whether each edge has an even number of triangles, as far as a number of 64 bits tells; on a GPU it does not look.
  bool seems_closed() {
    if constexpr (Space::host_accessible) {
      return without_the_gil([&] { return collide_python::seems_closed(view_, runtime_.space()); });
    } else {
      return true;
    }
  }

  /// What spheres touch. `what` is pairs, contacts, impacts, or closest or earliest, which are one for each sphere:
  /// records as rows of int32, how many there are, and how many in all; or count, a number; any, flags; csr, offsets
  /// and triangles. `results` are whether they are sorted, the capacity, `out`, and whether they are numpy's.
  nb::object query(std::string_view what, nb::object const& centres, nb::object const& radius,
                   nb::object const& displacements, std::string_view precision,
                   std::vector<std::vector<double>> const& poses, nb::tuple const& results) {
    question q{wishes_of(poses, results), precision, {}, {}};
    array radii;
    array const x = runtime_.keep(import_array(centres, "centres", runtime_.at()));
    q.spheres = spheres_of(points_of<S>(x, "centres"), radius, radii, runtime_.at());
    if (radii.is_valid()) runtime_.keep(radii);
    array const paths =
        displacements.is_none() ? array() : runtime_.keep(import_array(displacements, "displacements", runtime_.at()));
    if (paths.is_valid()) q.moving = moving_of(q.spheres, paths, precision);
    if (what == "pairs") return records<collide::pair, collide::pairs>(q);
    if (what == "contacts") return records<collide::contact<S>, collide::contacts<S>>(q);
    if (what == "impacts") return records<collide::impact<S>, collide::impacts<S>>(q);
    if (what == "closest") return records<collide::contact<S>, collide::closest_contact<S>>(q);
    if (what == "earliest") return records<collide::impact<S>, collide::earliest_impact<S>>(q);
    if (what == "csr") return rows(q);
    if (what == "count") {
      collide::count sink;
      ask(q, sink);
      return nb::cast(sink.total());
    }
    nb::object found;
    collide::any_hit sink(each<std::uint8_t>(found, {q.spheres.size()}, q.with));
    ask(q, sink);
    return nb::make_tuple(found, q.spheres.size());
  }

  /// What is near each point, in `out` or in memory of its own: `what` is nearest, k_nearest, signed_distance or
  /// winding, one record or k of them, and how many points there are; contains, flags; or distance or sides, numbers,
  /// which have a sign in the latter. `number` is k, or beta of winding numbers.
  nb::object search(std::string_view what, nb::object const& from, double number, double max_distance,
                    std::vector<std::vector<double>> const& poses, nb::tuple const& results) {
    auto const with = wishes_of(poses, results);
    array const x = runtime_.keep(import_array(from, "points", runtime_.at()));
    if (!(max_distance >= 0)) refuse("max_distance", "is negative or NaN");
    S const farthest = static_cast<S>(max_distance);
    auto const points = points_of<S>(x, "points");
    if (what == "contains") return found_by(points, with, collide::contains());
    if (what == "distance") return distances(points, with, collide::nearest<S>(farthest));
    if (what == "sides") return distances(points, with, collide::signed_distance<S>(farthest));
    if (what == "signed_distance") return found_by(points, with, collide::signed_distance<S>(farthest));
    if (what == "nearest") return found_by(points, with, collide::nearest<S>(farthest));
    if (what == "winding") return found_by(points, with, collide::winding_number<S>(number));
    auto const k = static_cast<int>(number);
    return found_by(points, with, collide::k_nearest<S>(k, farthest), {static_cast<std::size_t>(k)});
  }

 private:
  using called<Space>::runtime_;
  template <class Precision>
  using at_rest = collide::detector<collide::bucket, collide::karabassi<Precision>, Space, S>;
  using swept = collide::detector<collide::bucket, collide::karabassi_swept<>, Space, S>;
  using nearby = collide::detector<collide::bvh, collide::karabassi<>, Space, S>;

  /// What all queries with spheres have.
  struct question {
    wishes with;
    std::string_view precision;
    collide::sphere_view<S> spheres;
    std::optional<collide::moving_sphere_view<S>> moving;  ///< none for spheres at rest
  };

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

  /// Poses are a position, and a unit quaternion w, x, y, z, of each body, or none.
  wishes wishes_of(std::vector<std::vector<double>> const& poses, nb::tuple const& results) {
    auto const order = nb::cast<bool>(results[0]) ? collide::order::canonical : collide::order::unspecified;
    wishes with{{}, order, results[1], results[2], nb::cast<bool>(results[3])};
    std::size_t const expected = bodies_.empty() ? 1 : bodies_.size();
    if (!poses.empty() && poses.size() != expected)
      refuse("poses", "there are " + std::to_string(poses.size()) + ", expected " + std::to_string(expected) +
                          ", one for each body");
    for (std::vector<double> const& from : poses) {
      collide::pose& one = with.poses.emplace_back();
      std::copy_n(from.begin(), 3, one.position);
      std::copy_n(from.begin() + 3, 4, one.rotation);
    }
    return with;
  }

  collide::moving_sphere_view<S> moving_of(collide::sphere_view<S> const& spheres, array const& displacements,
                                           std::string_view precision) {
    auto const paths = points_of<S>(displacements, "displacements");
    if (paths.size() != spheres.size())
      refuse("displacements", "has " + std::to_string(paths.size()) + " rows, expected " +
                                  std::to_string(spheres.size()) + ", one for each centre");
    if (precision != "exact") refuse("precision", "spheres that move are decided exactly: 'exact'");
    return collide::with_displacements(spheres, paths);
  }

  template <class Record, class Sink>
  nb::object records(question const& q) {
    constexpr std::size_t words = sizeof(Record) / 4;
    wishes const& with = q.with;
    auto own = std::make_unique<kept<Sink>>(runtime_.memory());
    if constexpr (std::is_constructible<Sink, Record*, std::size_t, collide::order>::value) {  // many for a sphere
      own->sink = Sink(with.order);
      std::size_t n = 0;
      if (!with.out.is_none()) {
        auto* const to = room_of<std::int32_t>(with.out, runtime_.at(), {any_number, words}, &n);
        own->sink = Sink(reinterpret_cast<Record*>(to), n, with.order);
      } else if (!with.capacity.is_none()) {
        n = nb::cast<std::size_t>(with.capacity);
        own->sink = Sink(own->template records<Record>(runtime_, n), n, with.order);
      }
    }
    ask(q, own->sink);
    std::size_t const n = own->sink.size();
    std::uint64_t const total = own->sink.total();
    if (!with.out.is_none()) return nb::make_tuple(with.out, n, total);
    auto const* const data = own->sink.data();
    return nb::make_tuple(given<std::int32_t>(data, {n, words}, owner_of(std::move(own)), with.numpy), n, total);
  }

  nb::object rows(question const& q) {
    auto own = std::make_unique<kept<collide::csr>>(runtime_.memory());
    collide::csr& sink = own->sink = collide::csr(q.with.order);
    ask(q, sink);
    nb::object const owner = owner_of(std::move(own));
    return nb::make_tuple(given<std::int64_t>(sink.offsets(), {sink.rows() + 1}, owner, q.with.numpy),
                          given<std::int32_t>(sink.triangles(), {sink.size()}, owner, q.with.numpy));
  }

  template <class T>
  nb::object given(void const* data, std::vector<std::size_t> const& shape, nb::object const& owner, bool numpy) {
    return give(data, nb::dtype<T>(), shape, owner, runtime_.at(), numpy);
  }

  /// Has the detector of a precision answer.
  template <class Sink>
  void ask(question const& q, Sink& sink) {
    constexpr bool needs_motion =
        std::is_same<Sink, collide::impacts<S>>::value || std::is_same<Sink, collide::earliest_impact<S>>::value;
    constexpr bool needs_rest = std::is_same<Sink, collide::closest_contact<S>>::value;
    bool const is_posed = !q.with.poses.empty();
    if (q.moving) {
      if constexpr (needs_rest) {
        refuse("displacements", "the closest triangle is of spheres at rest: ask for impacts");
      } else if (!is_posed) {
        return run(swept_, *q.moving, sink);
      } else if constexpr (needs_motion) {
        return run(posed_swept_, *q.moving, sink, q.with.poses);
      }
      refuse("displacements", "of a mesh in poses are for impacts");
    }
    if constexpr (needs_motion) {
      refuse("displacements", "impacts are of spheres that move");
    } else {
      if (is_posed && q.precision != "exact") refuse("precision", "of a mesh in poses is 'exact'");
      if (is_posed) return run(posed_, q.spheres, sink, q.with.poses);
      if (q.precision == "exact") return run(std::get<0>(at_rest_), q.spheres, sink);
      if (q.precision == "single") return run(std::get<1>(at_rest_), q.spheres, sink);
      run(std::get<2>(at_rest_), q.spheres, sink);
    }
  }

  /// Has a sink look at points.
  template <class Sink>
  void look(collide::point_view<S> const& points, std::vector<collide::pose> const& poses, Sink& sink) {
    if constexpr (!std::is_same<Sink, collide::winding_number<S>>::value) {  // which is of a whole mesh
      if (!poses.empty()) return run(posed_, points, sink, poses);
    }
    run(nearby_, points, sink);
  }

  /// What a sink finds of each point, `shape` records, and how many points there are.
  template <class Sink>
  nb::object found_by(collide::point_view<S> const& points, wishes const& with, Sink sink,
                      std::vector<std::size_t> shape = {}) {
    nb::object found;
    shape.insert(shape.begin(), points.size());
    sink.write_to(each<std::decay_t<decltype(*sink.data())>>(found, shape, with));
    look(points, with.poses, sink);
    return nb::make_tuple(found, points.size());
  }

  /// Distances alone, by way of records for some points at a time.
  template <class Sink>
  nb::object distances(collide::point_view<S> const& points, wishes const& with, Sink sink) {
    using record = std::decay_t<decltype(*sink.data())>;
    std::size_t const n = points.size(), most = Space::host_accessible ? 1u << 16 : 1u << 20;
    nb::object found;
    S* const to = each<S>(found, {n}, with);
    auto const room = std::make_unique<kept<nothing>>(runtime_.memory());
    record* const records = room->template records<record>(runtime_, std::min(n, most));
    sink.write_to(records);
    for (std::size_t first = 0; first < n; first += most) {
      std::size_t const m = std::min(n - first, most);
      look(points.subview(first, m), with.poses, sink);
      runtime_.space().for_each(m, take_distance<record, S>{records, to + first});
    }
    return nb::make_tuple(found, n);
  }

  /// Where records go, each `shape` of them, and in `found` the array that shows them: `out`, or of memory of its own.
  template <class Record>
  Record* each(nb::object& found, std::vector<std::size_t> shape, wishes const& with) {
    constexpr bool is_number = sizeof(Record) == 1 || std::is_same<Record, S>::value;
    using word = std::conditional_t<is_number, Record, std::int32_t>;
    std::size_t n = 1;
    for (std::size_t const m : shape) n *= m;
    if (!is_number) shape.push_back(sizeof(Record) / sizeof(word));
    found = with.out;
    if (!found.is_none()) return reinterpret_cast<Record*>(room_of<word>(found, runtime_.at(), shape));
    auto own = std::make_unique<kept<nothing>>(runtime_.memory());
    Record* const to = own->template records<Record>(runtime_, n);
    found = given<word>(to, shape, owner_of(std::move(own)), with.numpy);
    return to;
  }

  /// Where a report has each kind of problem.
  template <class Problem, class Report>
  nb::list parts_of(Report const& report, int count) {
    nb::list parts;
    for (int k = 0; k < count; ++k) parts.append(two_columns(report.where(static_cast<Problem>(k))));
    return parts;
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

  template <class Detector>
  void build(Detector& one) {
    one.build(view_);
  }
  template <class Detector>
  void build(collide::posed<Detector>& one) {
    one.build(view_, bodies_.empty() ? std::vector<collide::body>{{0, view_.size(), {}}} : bodies_);
  }

  /// Has a detector answer, while other threads run: of a mesh as it lies in memory, or in poses.
  template <class Detector, class Spheres, class Sink, class... Poses>
  void run(prepared<Detector>& of, Spheres const& spheres, Sink& sink, Poses const&... poses) {
    without_gil const others_run;
    of.detector.space() = runtime_.space();
    if (of.version != version_) build(of.detector);
    of.version = version_;
    constexpr bool has_total = sizeof...(poses) == 0 && collide::detail::is_valid<total_of, Sink>;
    std::size_t const n = spheres.size();
    if constexpr (runtime<Space>::is_cuda && has_total) {  // a second pass would cost more than some room
      if (pairs_a_sphere_ > 0)
        sink.reserve(of.detector.space(), n, static_cast<std::size_t>(1.2 * pairs_a_sphere_ * double(n)));
    }
    of.detector.query(spheres, poses..., sink);
    if constexpr (has_total) {
      if (n != 0) pairs_a_sphere_ = static_cast<double>(sink.total()) / static_cast<double>(n);
    }
  }
  template <class Sink>
  using total_of = decltype(std::declval<Sink&>().total());

  array vertices_;
  corners triangles_;
  collide::mesh_view<S> view_;
  std::vector<collide::body> bodies_;
  std::uint64_t version_ = 0;  ///< how often arrays were taken
  std::tuple<prepared<at_rest<collide::exact>>, prepared<at_rest<collide::single_precision>>,
             prepared<at_rest<collide::double_precision>>>
      at_rest_{runtime_.space(), runtime_.space(), runtime_.space()};
  prepared<swept> swept_{runtime_.space()};
  prepared<nearby> nearby_{runtime_.space()};
  prepared<collide::posed<nearby>> posed_{runtime_.space()};
  prepared<collide::posed<swept>> posed_swept_{runtime_.space()};
  double pairs_a_sphere_ = 0;  ///< of the last query
};

}  // namespace collide_python
