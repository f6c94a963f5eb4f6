/// \file
/// collide.Mesh for one space and one type of coordinates: detectors, made when a query first needs them.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include <collide/bucket.cuh>
#include <collide/bvh.cuh>
#include <collide/karabassi.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/sinks/csr.hpp>
#include <collide/sinks/earliest.hpp>
#include <collide/sinks/impacts.hpp>
#include <collide/sinks/k_nearest.hpp>
#include <collide/sinks/signed_distance.hpp>
#include <collide/validate.hpp>

#include "runtime.hpp"

namespace collide_python {

/// What all queries have: their arguments as Python gives them, in this order.
struct question {
  std::string precision;
  nb::object centres, radius, displacements;  ///< the last one is None for spheres at rest
  bool canonical;
  nb::object capacity;  ///< None, or for how many results there is room at most
  nb::object out;       ///< None, or an array for them
  bool numpy;           ///< whether results are numpy arrays

  explicit question(nb::tuple const& q)
      : precision(nb::cast<std::string>(q[0])),
        centres(q[1]),
        radius(q[2]),
        displacements(q[3]),
        canonical(nb::cast<bool>(q[4])),
        capacity(q[5]),
        out(q[6]),
        numpy(nb::cast<bool>(q[7])) {}
};

template <class Space, class S>
class mesh {
 public:
  using scalar = S;

  mesh(int threads, int device) : runtime_(threads, device) {}

  /// Reads other arrays from now on; without triangles those of before. After an error it is as it was.
  void take(stream_of_call stream, nb::object const& vertices, nb::object const& triangles, bool validate) {
    call const now(*this, stream);
    array const v = import_array(vertices, "vertices", runtime_.at());
    collide::point_view<S> const points = points_of<S>(v, "vertices", is_set_ ? " as before" : " or float64");
    if (points.size() > 0x7fffffff) refuse("vertices", "has more than 2,147,483,647 rows");
    array t = triangles_;
    if (!triangles.is_none()) {
      t = import_array(triangles, "triangles", runtime_.at());
    } else if (is_set_ && points.size() != view_.vertices().size()) {
      refuse("vertices", "has shape " + shape_of(v) + ", expected (" + std::to_string(view_.vertices().size()) +
                             ", 3) as before: the triangles are the same");
    } else if (!t.is_valid() && points.size() % 3 != 0) {
      refuse("vertices", "has shape " + shape_of(v) + ", but without triangles there are three rows for each");
    }
    collide::mesh_view<S> const view = t.is_valid() ? mesh_of(points, t, "triangles") : collide::triangle_soup(points);
    if (validate) check(view);
    vertices_ = v;
    triangles_ = t;
    view_ = view;
    is_set_ = true;
    is_built_ = {};
  }

  std::size_t size() const { return view_.size(); }
  collide::mesh_view<S> const& view() const { return view_; }
  runtime<Space>& where() { return runtime_; }

  std::uint64_t count(stream_of_call stream, nb::tuple const& asked) {
    call const now(*this, stream);
    question const q(asked);
    collide::count sink;
    ask(q, sink);
    return sink.total();
  }

  nb::object any(stream_of_call stream, nb::tuple const& asked) {
    call const now(*this, stream);
    question const q(asked);
    array const centres = runtime_.keep(import_array(q.centres, "centres", runtime_.at()));
    nb::object found;
    collide::any_hit sink(each<std::uint8_t>(found, {points_of<S>(centres, "centres").size()}, q.out, q.numpy));
    ask(q, sink, centres);
    return found;
  }

  /// (records as rows of int32, how many there are, how many there are in all).
  nb::object pairs(stream_of_call stream, nb::tuple const& q) {
    return records<collide::pair, collide::pairs>(stream, q);
  }
  nb::object contacts(stream_of_call stream, nb::tuple const& q) {
    return records<collide::contact<S>, collide::contacts<S>>(stream, q);
  }
  nb::object impacts(stream_of_call stream, nb::tuple const& q) {
    return records<collide::impact<S>, collide::impacts<S>>(stream, q);
  }

  /// One record for each sphere.
  nb::object closest(stream_of_call stream, nb::tuple const& q) {
    return records<collide::contact<S>, collide::closest_contact<S>>(stream, q);
  }
  nb::object earliest(stream_of_call stream, nb::tuple const& q) {
    return records<collide::impact<S>, collide::earliest_impact<S>>(stream, q);
  }

  /// What is near each point: `what` is nearest, k_nearest, signed_distance or contains. One record, or k of them, or a
  /// flag for each point, in `out` or in memory of its own; and how many points there are.
  nb::object search(stream_of_call stream, std::string const& what, nb::object const& from, int k, double max_distance,
                    nb::object const& out, bool numpy) {
    call const now(*this, stream);
    array const kept_points = runtime_.keep(import_array(from, "points", runtime_.at()));
    auto const points = points_of<S>(kept_points, "points");
    std::size_t const n = points.size();
    if (!(max_distance >= 0)) refuse("max_distance", "is negative or NaN");
    if (k < 1 || k > collide::detail::most_nearest) refuse("k", "is " + std::to_string(k) + ", expected 1 to 32");
    S const farthest = static_cast<S>(max_distance);
    using collide::exact;
    nb::object found;
    if (what == "contains") {
      look(points, collide::detail::find_inside{each<std::uint8_t>(found, {n}, out, numpy)});
    } else if (what == "signed_distance") {
      auto* const to = each<collide::signed_nearest_triangle<S>>(found, {n}, out, numpy);
      look(points, collide::detail::find_signed_distance<S, exact>{farthest, to});
    } else if (what == "nearest") {
      auto* const to = each<collide::nearest_triangle<S>>(found, {n}, out, numpy);
      look(points, collide::detail::find_nearest<S, exact>{farthest, to});
    } else {
      auto* const to = each<collide::nearest_triangle<S>>(found, {n, static_cast<std::size_t>(k)}, out, numpy);
      look(points, collide::detail::find_k_nearest<S, exact>{farthest, k, to});
    }
    return nb::make_tuple(found, n);
  }

  nb::object csr(stream_of_call stream, nb::tuple const& asked) {
    call const now(*this, stream);
    question const q(asked);
    auto sink = std::make_unique<kept<collide::csr>>(runtime_.memory());
    sink->sink = collide::csr(order_of(q));
    ask(q, sink->sink);
    auto const* const offsets = reinterpret_cast<std::int64_t const*>(sink->sink.offsets());
    auto const* const triangles = reinterpret_cast<std::int32_t const*>(sink->sink.triangles());
    std::size_t const rows = sink->sink.rows(), n = sink->sink.size();
    nb::object const owner = owner_of(std::move(sink));
    return nb::make_tuple(give(offsets, {rows + 1}, owner, runtime_.at(), q.numpy),
                          give(triangles, {n}, owner, runtime_.at(), q.numpy));
  }

 private:
  template <class Precision>
  using at_rest = collide::detector<collide::bucket, collide::karabassi<Precision>, Space, S>;
  using swept = collide::detector<collide::bucket, collide::karabassi_swept<>, Space, S>;

  /// A call of Python: one at a time, in its place.
  struct call {
    call_under_way under_way;
    one_at_a_time alone;
    typename runtime<Space>::scope here;
    call(mesh& m, stream_of_call const& stream) : alone(m.mutex_), here(m.runtime_, stream) {}
  };

  /// A sink with memory that lives as long as its results.
  template <class Sink>
  struct kept {
    std::shared_ptr<void> memory;
    collide::buffer<unsigned char> room;
    Sink sink;
    explicit kept(std::shared_ptr<void> m) : memory(std::move(m)) {}
  };

  static collide::order order_of(question const& q) {
    return q.canonical ? collide::order::canonical : collide::order::unspecified;
  }

  void check(collide::mesh_view<S> const& view) {
    without_gil const others_run;
    auto const report = collide::validate(view, runtime_.space());
    if (report.count(collide::problem::corner_out_of_range) != 0)
      throw std::invalid_argument("triangles: " + report.message());
  }

  template <class Record, class Sink>
  nb::object records(stream_of_call stream, nb::tuple const& asked) {
    call const now(*this, stream);
    question const q(asked);
    constexpr std::size_t words = sizeof(Record) / 4;
    auto own = std::make_unique<kept<Sink>>(runtime_.memory());
    if constexpr (std::is_constructible<Sink, Record*, std::size_t, collide::order>::value) {  // many for a sphere
      if (!q.out.is_none()) {
        auto const room = import_array<nb::ndarray<>>(q.out, "out", runtime_.at());
        auto* const to = room_of<std::int32_t>(room, "out", {any_number, words});
        Sink sink(reinterpret_cast<Record*>(to), room.shape(0), order_of(q));
        ask(q, sink);
        return nb::make_tuple(q.out, sink.size(), sink.total());
      }
      own->sink = Sink(order_of(q));
      if (!q.capacity.is_none()) {
        auto const n = nb::cast<std::size_t>(q.capacity);
        auto* const to = own->room.reserve(runtime_.space().resource(), n * sizeof(Record));
        own->sink = Sink(reinterpret_cast<Record*>(to), n, order_of(q));
      }
    }
    ask(q, own->sink);
    auto const* const data = reinterpret_cast<std::int32_t const*>(own->sink.data());
    std::size_t const n = own->sink.size();
    std::uint64_t const total = own->sink.total();
    return nb::make_tuple(give(data, {n, words}, owner_of(std::move(own)), runtime_.at(), q.numpy), n, total);
  }

  template <class Sink>
  void ask(question const& q, Sink& sink) {
    ask(q, sink, runtime_.keep(import_array(q.centres, "centres", runtime_.at())));
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
        if (q.precision == "exact") return run<0>(std::get<0>(at_rest_), spheres, sink);
        if (q.precision == "single") return run<1>(std::get<1>(at_rest_), spheres, sink);
        if (q.precision == "double") return run<2>(std::get<2>(at_rest_), spheres, sink);
        refuse("precision", "is '" + q.precision + "', expected 'exact', 'double' or 'single'");
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
      run<3>(swept_, collide::with_displacements(spheres, paths), sink);
    }
  }

  /// A sink that puts a search of the library's on the stream.
  template <class Find>
  struct searcher {
    Find find;
    template <class Query>
    void run(Space&, Query const& query) {
      collide::detail::search_mesh(query, find);
    }
  };
  template <class Find>
  void look(collide::point_view<S> const& points, Find const& find) {
    searcher<Find> sink{find};
    run<4>(nearby_, points, sink);
  }

  /// Where records go, each `shape` of them, and in `found` the array that shows them: `out`, or of memory of its own.
  template <class Record>
  Record* each(nb::object& found, std::vector<std::size_t> shape, nb::object const& out, bool numpy) {
    using word = std::conditional_t<sizeof(Record) == 1, std::uint8_t, std::int32_t>;
    struct room {
      std::shared_ptr<void> memory;
      collide::buffer<Record> records;
    };
    std::size_t n = 1;
    for (std::size_t const m : shape) n *= m;
    if (sizeof(Record) != 1) shape.push_back(sizeof(Record) / sizeof(word));
    if (!out.is_none()) {
      found = out;
      return reinterpret_cast<Record*>(
          room_of<word>(import_array<nb::ndarray<>>(out, "out", runtime_.at()), "out", shape));
    }
    auto own = std::make_unique<room>(room{runtime_.memory(), {}});
    Record* const to = own->records.reserve(runtime_.space().resource(), n);
    found = give(reinterpret_cast<word const*>(to), shape, owner_of(std::move(own)), runtime_.at(), numpy);
    return to;
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

  runtime<Space> runtime_;
  array vertices_, triangles_;
  collide::mesh_view<S> view_;
  std::tuple<at_rest<collide::exact>, at_rest<collide::single_precision>, at_rest<collide::double_precision>> at_rest_{
      at_rest<collide::exact>(runtime_.space()), at_rest<collide::single_precision>(runtime_.space()),
      at_rest<collide::double_precision>(runtime_.space())};
  swept swept_{runtime_.space()};
  collide::detector<collide::bvh, collide::karabassi<>, Space, S> nearby_{runtime_.space()};
  bool is_set_ = false;
  double pairs_a_sphere_ = 0;  ///< of the last query
  std::array<bool, 5> is_built_{};
  std::mutex mutex_;
};

}  // namespace collide_python
