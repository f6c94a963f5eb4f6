/// \file
/// collide.Simulation for one space and one type of coordinates: a list of effects that was compiled on its own.
#pragma once

#include <chrono>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <dlfcn.h>

#include <collide/detectors/sphere_pairs.cuh>
#include <collide/effects/bodies.hpp>

#include "mesh.hpp"
#include "simulation_base.hpp"

namespace collide_python {

template <class Space, class S>
class simulation : public called<Space> {
 public:
  simulation(std::string const& library, int threads, int device)
      : called<Space>(threads, device), make_{function_of<make_simulation>(library, "collide_simulation")} {}

  ~simulation() {
    if (mesh_.second.use_count() == 1) runtime_.settle();  // what reads it
  }

  /// What each call begins with.
  void begin() {
    if (one_ == nullptr) one_.reset(make_(runtime_.where()));
    one_->use(runtime_.where());
  }
  simulation_base& one() { return *one_; }

  /// Each body is its first triangle, how many, and the numbers of its motion.
  void set_mesh(held<mesh<Space, S>>& of, std::vector<std::vector<double>> const& bodies) {
    static_assert(sizeof(collide::body_motion) == 19 * sizeof(double));
    std::vector<collide::body> moving;
    for (std::vector<double> const& numbers : bodies) {
      if (numbers.size() != 21) refuse("bodies", "a body has 21 numbers");
      collide::body b{static_cast<std::size_t>(numbers[0]), static_cast<std::size_t>(numbers[1]), {}};
      std::memcpy(static_cast<void*>(&b.motion), numbers.data() + 2, sizeof b.motion);
      moving.push_back(b);
    }
    collide::mesh_view<S> const view = of.one->view();  // which other threads may change meanwhile
    auto memory = of.one->memory();
    runtime_.follow(of.one->its_runtime());
    {
      without_gil const others_run;
      one().set_mesh(&view, moving.data(), moving.size());
      if (mesh_.second.use_count() == 1) runtime_.settle();  // what reads it
    }
    std::swap(mesh_, memory);
  }

  /// False, and nothing has changed, if arrays of Python show its columns: then it must be another that is set.
  bool set(nb::object const& centres, nb::object const& radius, nb::object const& velocities, std::size_t capacity) {
    if (is_shown()) return false;
    array radii, v;
    array const x = runtime_.keep(import_array(centres, "centres", runtime_.at()));
    auto const spheres = spheres_of(points_of<S>(x, "centres"), radius, radii, runtime_.at());
    if (!velocities.is_none()) {
      v = runtime_.keep(import_array(velocities, "velocities", runtime_.at()));
      check_type<S>(v, "velocities", as_vertices);
      if (!has_shape(v, {spheres.size(), 3}) || !is_packed(v))
        refuse("velocities",
               "has shape " + shape_of(v) + ", expected " + text_of({spheres.size(), 3}) + ", packed (C order)");
    }
    if (radii.is_valid()) runtime_.keep(radii);
    without_gil const others_run;
    auto const report = collide::validate(spheres, runtime_.space());
    if (report.count(collide::problem::radius_nan) + report.count(collide::problem::radius_negative) != 0)
      throw std::invalid_argument("radius: " + report.message());
    one().set(&spheres, v.is_valid() && v.size() != 0 ? v.data() : nullptr, capacity);
    return true;
  }

  /// Steps for a tenth of a second, or one; returns how many, so that Ctrl-C comes between.
  std::size_t steps(std::size_t n, double dt) {
    using clock = std::chrono::steady_clock;
    without_gil const others_run;
    clock::time_point const end = clock::now() + std::chrono::milliseconds(100);
    std::size_t done = 0;
    for (; done < n && (done == 0 || clock::now() < end); ++done) one().steps(1, dt);
    return done;
  }

  /// Pairs of particles that touch, as (n, 2) int32.
  nb::object contacts(bool numpy) {
    struct owned {
      std::shared_ptr<void> memory;
      collide::pairs sink{collide::order::canonical};
    };
    auto own = std::make_unique<owned>(owned{runtime_.memory(), collide::pairs(collide::order::canonical)});
    {
      without_gil const others_run;
      collide::sphere_view<S> particles;
      one().spheres(&particles);
      pairs_.space() = runtime_.space();
      pairs_.query(particles, own->sink);
    }
    auto const* const data = own->sink.data();
    std::size_t const n = own->sink.size();
    return give(data, nb::dtype<std::int32_t>(), {n, 2}, owner_of(std::move(own)), runtime_.at(), numpy);
  }

  bool set_clumps(std::vector<double> const& shapes, std::vector<double> const& placed, std::size_t waiting) {
    if (is_shown()) return false;
    without_gil const others_run;
    if (!one().set_clumps(shapes, placed, waiting))
      throw collide::error("collide: set_clumps needs clumps in the list");
    return true;
  }

  void take_bookkeeping(std::string const& library) {
    one().books.reset(function_of<make_bookkeeping>(library, "collide_bookkeeping")());
  }
  bool load(std::string const& path) {
    if (is_shown()) return false;
    without_gil const others_run;
    one().books->load(one().whole(), path);
    one().clear(all_effects);
    return true;
  }

  std::vector<std::string> columns() {
    std::vector<std::string> names;
    for (column const& c : one().columns()) names.push_back(c.name);
    return names;
  }

  /// A column where it is: what is written to it the simulation has.
  nb::object column_of(std::size_t number, bool numpy) {
    column const c = one().columns()[number];
    struct owned {
      std::shared_ptr<void> memory;  ///< gone last
      std::shared_ptr<simulation_base> one;
    };
    nb::object const owner = owner_of(std::unique_ptr<owned>(new owned{runtime_.memory(), one_}));
    auto const code = c.is_float ? dlpack::Float : c.bytes == 1 ? dlpack::UInt : dlpack::Int;
    return give(c.data, {static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(8 * c.bytes), 1}, rows_of(c), owner,
                runtime_.at(), numpy);
  }

  void assign(std::size_t number, nb::object const& values) {
    column const c = one().columns()[number];
    char const* const name = c.name.c_str();
    array const a = runtime_.keep(import_array(values, name, runtime_.at()));
    auto const kind = static_cast<dlpack>(a.dtype().code);
    bool const is_integer = kind == dlpack::Int || kind == dlpack::UInt || kind == dlpack::Bool;
    if (a.dtype().bits != 8 * c.bytes || (c.is_float ? kind != dlpack::Float : !is_integer))
      refuse<nb::type_error>(name,
                             "has dtype " + name_of(a.dtype()) + ", and the column another: nothing is converted");
    if (!has_shape(a, rows_of(c)) || !is_packed(a))
      refuse(name, "has shape " + shape_of(a) + ", expected packed rows: " + text_of(rows_of(c)));
    if (a.size() == 0) return;
    without_gil const others_run;
    c.assign(one().whole(), a.data());
  }

 private:
  using called<Space>::runtime_;
  using dlpack = nb::dlpack::dtype_code;

  std::vector<std::size_t> rows_of(column const& c) const {
    return c.width == 1 ? std::vector<std::size_t>{one_->size()} : std::vector<std::size_t>{one_->size(), c.width};
  }

  /// A function of a library, which stays loaded for good: its code is in objects that live on.
  template <class Function>
  static Function* function_of(std::string const& library, char const* name) {
    void* const loaded = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (loaded == nullptr) throw collide::error(std::string("collide: ") + dlerror());
    auto* const found = reinterpret_cast<Function*>(dlsym(loaded, name));
    if (found == nullptr) throw collide::error("collide: " + library + " has no " + name);
    return found;
  }

  /// Whether arrays of Python show its columns: after `set` they show the old ones.
  bool is_shown() const { return one_.use_count() > 1; }

  make_simulation* make_;
  collide::sphere_pairs<Space, S> pairs_{runtime_.space()};
  std::shared_ptr<simulation_base> one_;
  std::pair<array, std::shared_ptr<void>> mesh_;  ///< the memory that it reads
};

}  // namespace collide_python
