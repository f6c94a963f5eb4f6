/// \file
/// collide.Simulation for one space and one type of coordinates: a list of effects that was compiled on its own.
#pragma once

#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <dlfcn.h>

#include <collide/bodies.hpp>

#include "mesh.hpp"
#include "simulation_base.hpp"

namespace collide_python {

template <class Space, class S>
class simulation {
 public:
  simulation(std::string const& library, int threads, int device) : runtime_(threads, device) {
    void* const loaded =
        dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);  // for good: its code is in objects that live on
    if (loaded == nullptr) throw collide::error(std::string("collide: ") + dlerror());
    make_ = reinterpret_cast<make_simulation*>(dlsym(loaded, "collide_simulation"));
    if (make_ == nullptr) throw collide::error("collide: " + library + " has no simulation");
  }

  void set_parameter(stream_of_call stream, std::size_t effect, std::string const& name,
                     std::vector<double> const& values) {
    call const now(*this, stream);
    if (!one().set_parameter(effect, name.c_str(), values.data(), values.size()))
      refuse(name.c_str(), "there is no such parameter of so many numbers");
    parameters_.push_back({effect, name, values});
  }

  /// Each body is its first triangle, how many, and the numbers of its motion.
  void set_mesh(stream_of_call stream, mesh<Space, S>& of, std::vector<std::vector<double>> const& bodies) {
    static_assert(sizeof(collide::body_motion) == 19 * sizeof(double));
    call const now(*this, stream);
    std::vector<collide::body> moving;
    for (std::vector<double> const& numbers : bodies) {
      if (numbers.size() != 21) refuse("bodies", "a body has 21 numbers");
      collide::body b{static_cast<std::size_t>(numbers[0]), static_cast<std::size_t>(numbers[1]), {}};
      std::memcpy(static_cast<void*>(&b.motion), numbers.data() + 2, sizeof b.motion);
      moving.push_back(b);
    }
    collide::mesh_view<S> const view = of.view();
    without_gil const others_run;
    one().set_mesh(&view, moving.data(), moving.size());
    view_ = view;
    bodies_ = std::move(moving);
    has_mesh_ = true;
  }

  void set(stream_of_call stream, nb::object const& centres, nb::object const& radius, nb::object const& velocities,
           std::size_t capacity) {
    call const now(*this, stream);
    array radii, v;
    array const x = runtime_.keep(import_array(centres, "centres", runtime_.at()));
    auto const spheres = spheres_of(points_of<S>(x, "centres"), radius, radii, runtime_.at());
    S const* packed = nullptr;
    if (!velocities.is_none()) {
      v = runtime_.keep(import_array(velocities, "velocities", runtime_.at()));
      auto const each = points_of<S>(v, "velocities");
      if (each.size() != spheres.size() || !(each.packed() || each.size() == 0))
        refuse("velocities",
               "has shape " + shape_of(v) + ", expected (" + std::to_string(spheres.size()) + ", 3), packed (C order)");
      packed = each.size() != 0 ? each.address(0) : nullptr;
    }
    if (radii.is_valid()) runtime_.keep(radii);
    without_gil const others_run;
    if (one_.use_count() > 1) renew();  // arrays of Python show the old columns, which stay as they are
    one().set(&spheres, packed, capacity);
  }

  void steps(stream_of_call stream, std::size_t n, double dt) {
    call const now(*this, stream);
    without_gil const others_run;
    one().steps(n, dt);
  }

  std::size_t size() { return peek().size(); }
  double time() { return peek().time(); }
  double largest_time_step() { return peek().largest_time_step(); }

  std::vector<double> energy(stream_of_call stream, double density) {
    call const now(*this, stream);
    std::vector<double> four(4);
    without_gil const others_run;
    one().energy(density, four.data());
    return four;
  }

  std::vector<std::string> columns() {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < peek().column_count(); ++i) names.emplace_back(peek().column_at(i).name);
    return names;
  }

  /// A column where it is: what is written to it the simulation has.
  nb::object column_of(stream_of_call stream, std::string const& name, bool numpy) {
    call const now(*this, stream);
    column const c = one().column_at(number_of(name));
    nb::object const owner = owner_of(std::make_unique<owned>(owned{one_, runtime_.memory()}));
    std::vector<std::size_t> shape{one().size()};
    if (c.width != 1) shape.push_back(c.width);
    auto const of = [&](auto const number) {
      return give(static_cast<decltype(number) const*>(c.data), shape, owner, runtime_.at(), numpy);
    };
    return c.kind == 'f'  ? of(S())
           : c.bytes == 1 ? of(std::uint8_t())
           : c.bytes == 4 ? of(std::int32_t())
                          : of(std::int64_t());
  }

  void assign(stream_of_call stream, std::string const& name, nb::object const& values) {
    call const now(*this, stream);
    std::size_t const number = number_of(name);
    column const c = one().column_at(number);
    array const a = runtime_.keep(import_array(values, name.c_str(), runtime_.at()));
    using code = nb::dlpack::dtype_code;
    auto const kind = static_cast<code>(a.dtype().code);
    bool const is_integer = kind == code::Int || kind == code::UInt || kind == code::Bool;
    if (a.dtype().bits != 8 * c.bytes || (c.kind == 'f' ? kind != code::Float : !is_integer))
      refuse_type(name.c_str(), "has dtype " + name_of(a.dtype()) + ", and the column another: nothing is converted");
    bool const fits =
        a.ndim() == (c.width == 1 ? 1U : 2U) && a.shape(0) == one().size() && (c.width == 1 || a.shape(1) == c.width);
    bool const is_packed =
        a.size() <= 1 || (fits && a.stride(a.ndim() - 1) == 1 && a.stride(0) == static_cast<std::int64_t>(c.width));
    if (!fits || !is_packed)
      refuse(name.c_str(), "has shape " + shape_of(a) + ", expected packed rows for " + std::to_string(one().size()) +
                               " particles of " + std::to_string(c.width) + " number(s)");
    if (a.size() == 0) return;
    without_gil const others_run;
    one().assign(number, a.data());
  }

  void save(stream_of_call stream, std::string const& path) {
    call const now(*this, stream);
    without_gil const others_run;
    one().save(path.c_str());
  }
  void load(stream_of_call stream, std::string const& path) {
    call const now(*this, stream);
    without_gil const others_run;
    if (one_.use_count() > 1) renew();
    one().load(path.c_str());
  }

 private:
  struct parameter {
    std::size_t effect;
    std::string name;
    std::vector<double> values;
  };
  /// What arrays of Python keep.
  struct owned {
    std::shared_ptr<void> memory;  ///< gone last
    std::shared_ptr<simulation_base> one;
    owned(std::shared_ptr<simulation_base> o, std::shared_ptr<void> m) : memory(std::move(m)), one(std::move(o)) {}
  };
  struct call {
    call_under_way under_way;
    one_at_a_time alone;
    typename runtime<Space>::scope here;
    call(simulation& s, stream_of_call const& stream) : alone(s.mutex_), here(s.runtime_, stream) {
      if (s.one_ == nullptr) s.one_.reset(s.make_(s.runtime_.where()));
      s.one_->use(s.runtime_.where());
    }
  };

  simulation_base& one() { return *one_; }
  simulation_base& peek() {
    call const now(*this, runtime_.current());
    return *one_;
  }

  std::size_t number_of(std::string const& name) {
    std::string all;
    for (std::size_t i = 0; i < one().column_count(); ++i) {
      if (name == one().column_at(i).name) return i;
      all += std::string(i != 0 ? ", " : "") + one().column_at(i).name;
    }
    throw nb::key_error(("there is no column '" + name + "' in this simulation; there are " + all).c_str());
  }

  /// Another simulation in place of this one, with the same effects and the same mesh.
  void renew() {
    one_.reset(make_(runtime_.where()));
    for (parameter const& p : parameters_)
      one().set_parameter(p.effect, p.name.c_str(), p.values.data(), p.values.size());
    if (has_mesh_) one().set_mesh(&view_, bodies_.data(), bodies_.size());
  }

  runtime<Space> runtime_;
  make_simulation* make_ = nullptr;
  std::shared_ptr<simulation_base> one_;
  std::vector<parameter> parameters_;
  collide::mesh_view<S> view_;
  std::vector<collide::body> bodies_;
  bool has_mesh_ = false;
  std::mutex mutex_;
};

}  // namespace collide_python
