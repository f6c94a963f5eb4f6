/// \file
/// How `detection::detect` detects and measures.
#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/bvh.cuh>
#include <collide/detectors/in_passes.hpp>
#include <collide/sinks/contains.hpp>
#include <collide/sinks/nearest.hpp>
#include <collide/sinks/signed_distance.hpp>

#include "../io/choose.hpp"
#include "../io/counting.hpp"
#include "../io/device.hpp"
#include "../io/progress.hpp"
#include "detection.hpp"

namespace detection {

/// The input in memory of the space: where it is for the host, a copy for CUDA.
template <class Space, class S>
class input {
 public:
  input(Space const& space, scene<S> const& from) : radius_{from.radius}, size_{from.spheres.size()} {
    auto const& mesh = from.mesh;
    auto const local = [&](auto& buffer, auto const& values) {
      if constexpr (Space::host_accessible) {
        return values.data();
      } else {
        auto* const to = buffer.reserve(space.resource(), values.size());
        space.copy_from_host(to, values.data(), values.size());
        return to;
      }
    };
    mesh_ = collide::indexed_mesh<S>(local(vertices_, mesh.vertices), mesh.vertices.size() / 3,
                                     local(corners_, mesh.corners), mesh.size());
    xyz_ = local(centres_, from.spheres.xyz);
    if (!from.spheres.radii.empty()) radii_ = local(own_radii_, from.spheres.radii);
  }

  collide::mesh_view<S> mesh() const { return mesh_; }
  std::size_t size() const { return size_; }
  bool one_radius() const { return radii_ == nullptr; }

  /// `count` spheres from number `first` on.
  collide::sphere_view<S> spheres(std::size_t first, std::size_t count) const {
    if (one_radius()) return collide::spheres_xyz(xyz_ + 3 * first, count, radius_);
    return collide::spheres_xyz(xyz_ + 3 * first, count, radii_ + first);
  }

 private:
  collide::buffer<S> vertices_, centres_, own_radii_;
  collide::buffer<collide::id> corners_;
  collide::mesh_view<S> mesh_;
  S const* xyz_ = nullptr;
  S const* radii_ = nullptr;
  S radius_;
  std::size_t size_;
};

/// Appends what a query of the spheres from `first` on has found.
template <class Sink, class Found>
void append(Sink const& sink, std::size_t first, std::vector<Found>& to) {
  auto part = sink.to_host();
  for (auto& found : part) found.sphere += static_cast<collide::id>(first);
  if (to.empty()) {
    to = std::move(part);
  } else {
    to.insert(to.end(), part.begin(), part.end());
  }
}

/// Gives a detector the mesh.
template <class Detector, class Input>
void build(options const&, Detector& detector, Input const& in) {
  if (in.one_radius()) {
    detector.build(in.mesh(), in.spheres(0, 0).common_radius());
  } else {
    detector.build(in.mesh());
  }
}
template <class Detector, class Input>
void build(options const& wish, collide::in_passes<Detector>& passes, Input const& in) {
  passes.build(in.mesh(), wish.triangles_per_pass);
}

/// Builds and queries as often as wanted, and calls keep(sink, first) with what the first run finds.
///
/// If someone watches and it takes longer than a person has patience for, the spheres are queried in parts of about a
/// fifth of that time, for the progress bar; otherwise all at once, as where each query builds the mesh again.
template <class Detector, class Input, class Sink, class S, class Keep>
void measure(options const& wish, Detector& detector, Input const& in, Sink& sink, findings<S>& out, Keep const& keep) {
  std::size_t const n = in.size();
  std::size_t step = n;
  io::progress bar("detecting", static_cast<double>(n) * wish.repeat);
  auto const timed = [&](auto const& work) {
    auto const start = clock::now();
    work();
    detector.space().synchronize();
    return milliseconds(clock::now() - start);
  };
  auto const query = [&](std::size_t first, std::size_t count) {
    return timed([&] { detector.query(in.spheres(first, count), sink); });
  };
  for (int run = 0; run < wish.repeat; ++run) {
    double const built = timed([&] { build(wish, detector, in); });
    constexpr std::size_t probe = 1024;
    if (run == 0 && wish.triangles_per_pass == 0 && io::progress::watched() && n > probe) {
      double const once = query(0, probe);
      double const patience = 1000 * io::progress::patience();
      if (once * static_cast<double>(n / probe) > patience) {
        step = std::max<std::size_t>(1, static_cast<std::size_t>(probe * std::min(patience / 5 / once, 1e6)));
      }
    }
    double spent = 0;
    std::size_t first = 0;
    do {
      spent += query(first, std::min(step, n - first));
      if (run == 0) keep(sink, first);
      first += step;
      bar.update(static_cast<double>(n) * run + static_cast<double>(std::min(first, n)));
    } while (first < n);
    out.build_ms.push_back(built);
    out.query_ms.push_back(spent);
    out.total_ms.push_back(built + spent);
  }
}

/// Asks about points what the options say. `run(sink, keep)` measures it.
template <class S, class Run>
void ask_points(options const& wish, findings<S>& out, Run const& run) {
  auto const find_nearest = [&](auto sink) {
    run(std::move(sink), [&](auto const& found, std::size_t) {
      for (auto const& n : found.to_host()) {
        out.nearest.push_back(n);
        out.total += n.triangle != collide::no_id;
      }
    });
  };
  if (wish.nearest) {
    find_nearest(collide::nearest<S>());
  } else if (wish.signed_distance) {
    find_nearest(collide::signed_distance<S>());
  } else {
    run(collide::contains(), [&](auto const& found, std::size_t) {
      for (auto const flag : found.to_host()) {
        out.inside.push_back(flag);
        out.total += flag;
      }
    });
  }
}

/// True for broad phases that can be asked about points, of one mesh.
template <class Detector>
inline constexpr bool answers_points = false;
template <class Broad, class Narrow, class Space, class S>
inline constexpr bool answers_points<collide::detector<Broad, Narrow, Space, S>> =
    !std::is_same<Broad, collide::bucket>::value;

/// The width of cells; in passes each has its own.
template <class Detector>
double cell_width(Detector const& detector) {
  return detector.cell_width();
}
template <class Detector>
double cell_width(collide::in_passes<Detector> const&) {
  return 0;
}

/// `Detector` is a detector, or one in passes.
template <class Detector, class S, class Broad>
findings<S> detect_with(options const& wish, scene<S> const& from, Broad const& broad) {
  using Space = typename Detector::execution_space;
  using device = io::device_of<Space>;
  io::counting_resource memory(device::memory());
  findings<S> out;
  {
    Detector detector(device::make(wish.threads, &memory), broad);
    input<Space, S> const in(detector.space(), from);
    if (Space::host_accessible) {
      memory.add((from.mesh.vertices.size() + from.spheres.xyz.size() + from.spheres.radii.size()) * sizeof(S) +
                 from.mesh.corners.size() * sizeof(collide::id));
    }
    auto const run = [&](auto sink, auto const& keep) { measure(wish, detector, in, sink, out, keep); };
    if (wish.asks_points()) {
      if constexpr (answers_points<Detector>) ask_points(wish, out, run);
    } else if (!wish.contacts.empty()) {
      run(collide::contacts<S>(collide::order::canonical),
          [&](auto const& sink, std::size_t first) { append(sink, first, out.contacts); });
      out.total = out.contacts.size();
    } else if (!wish.output.empty() || !wish.ply.empty()) {
      run(collide::pairs(collide::order::canonical),
          [&](auto const& sink, std::size_t first) { append(sink, first, out.pairs); });
      out.total = out.pairs.size();
    } else {
      run(collide::count(), [&](auto const& sink, std::size_t) { out.total += sink.total(); });
    }
    out.cell_width = cell_width(detector);
    out.threads = device::threads(detector.space());
  }
  out.peak_bytes = memory.peak;
  out.device = device::name();
  return out;
}

template <class Broad>
Broad broad_phase(options const& wish) {
  if constexpr (std::is_same<Broad, collide::bucket>::value) {
    return collide::bucket{wish.cell_width};
  } else {
    return Broad{};
  }
}

template <class Detector, class S>
findings<S> detect_with(options const& wish, scene<S> const& from) {
  auto const broad = broad_phase<typename Detector::broad_phase>(wish);
  if constexpr (Detector::execution_space::host_accessible) {
    if (wish.triangles_per_pass != 0) return detect_with<collide::in_passes<Detector>>(wish, from, broad);
  }
  return detect_with<Detector>(wish, from, broad);
}

template <class S>
findings<S> detect(options const& wish, scene<S> const& from) {
  using io::choose, io::named;
  findings<S> out;
  choose(
      wish.precision,
      [&](auto precision) {
        choose(
            wish.broad,
            [&](auto broad) {
              using broad_type = typename decltype(broad)::type;
              io::choose_space(wish.space, [&](auto space) {
                using narrow_phase = collide::karabassi<typename decltype(precision)::type>;
                out = detect_with<collide::detector<broad_type, narrow_phase, typename decltype(space)::type, S>>(wish,
                                                                                                                  from);
              });
            },
            named<collide::all_pairs>{"all_pairs"}, named<collide::bucket>{"bucket"}, named<collide::bvh>{"bvh"});
      },
      named<collide::exact>{"exact"}, named<collide::single_precision>{"single"},
      named<collide::double_precision>{"double"});
  return out;
}

}  // namespace detection
