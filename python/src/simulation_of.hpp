/// \file
/// A list of effects as Python sees it. The source that _source.py writes has included the effects, and declared
/// `parameters(effect, f)` for each, which calls f(name, member).
#pragma once

#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/place_clumps.hpp>

#include "simulation_base.hpp"

namespace collide_python {

/// The name of a type without its namespaces.
template <class T>
std::string short_name() {
  std::string_view text = __PRETTY_FUNCTION__;  // ... [with T = collide::velocity; ...]
  text.remove_prefix(text.find("T = ") + 4);
  text = text.substr(0, text.find_first_of(";]"));
  std::size_t const last = text.rfind("::");
  return std::string(last == std::string_view::npos ? text : text.substr(last + 2));
}

inline collide::host make_space(whereabouts const& w, collide::host const*) { return collide::host(w.threads); }
#if defined(__CUDACC__)
template <class Space>
Space make_space(whereabouts const& w, Space const*) {
  return Space(static_cast<cudaStream_t>(w.stream), w.memory);
}
#endif

/// Sets the member of a name.
struct parameter_setter {
  std::string const& wanted;
  std::vector<double> const& values;
  bool* found;

  template <class Number>
  void operator()(char const* name, Number& member) const {
    (*this)(name, 1, [&](double const* v) { member = static_cast<Number>(*v); });
  }
  void operator()(char const* name, double (&member)[3]) const {
    (*this)(name, 3, [&](double const* v) { std::copy(v, v + 3, member); });
  }
  /// What takes `size` numbers at once.
  template <class Set>
  void operator()(char const* name, std::size_t size, Set const& set) const {
    if (values.size() != size || name != wanted) return;
    set(values.data());
    *found = true;
  }
};

template <class Space, class S, class NarrowPhase, class... Effect>
class simulation_of final : public simulation_base {
  using type = collide::simulation<collide::detector<collide::bucket, NarrowPhase, Space, S>, Effect...>;

 public:
  explicit simulation_of(whereabouts const& w) : one_(make_space(w, static_cast<Space*>(nullptr))) {}

  void* whole() override { return &one_; }
  void use(whereabouts const& w) override { one_.space() = make_space(w, &one_.space()); }

  bool set_parameter(std::size_t effect, std::string const& name, std::vector<double> const& values) override {
    bool found = false;
    each(effect, [&](auto* type, auto& sums) {
      parameters(of(type), parameter_setter{name, values, &found});
      sums.make(one_.space(), of(type), bodies_, triangles_);
    });
    return found;
  }

  void set_mesh(void const* mesh, void const* bodies, std::size_t body_count) override {
    auto const& view = *static_cast<collide::mesh_view<S> const*>(mesh);
    auto const* const first = static_cast<collide::body const*>(bodies);
    one_.set_mesh(view, std::vector<collide::body>(first, first + body_count));
    if (bodies_ == body_count && triangles_ == view.size()) return;
    bodies_ = body_count;
    triangles_ = view.size();
    each(all_effects, [&](auto* type, auto& sums) { sums.make(one_.space(), of(type), bodies_, triangles_); });
  }
  void set(void const* spheres, void const* velocities, std::size_t capacity) override {
    one_.set(*static_cast<collide::sphere_view<S> const*>(spheres), static_cast<S const*>(velocities), capacity);
    clear(all_effects);
  }
  bool set_clumps([[maybe_unused]] std::vector<double> const& shapes,
                  [[maybe_unused]] std::vector<double> const& placed, [[maybe_unused]] std::size_t waiting) override {
    if constexpr (has_clumps) {
      std::vector<collide::clump_shape> kinds;
      for (double const* from = shapes.data(); from != shapes.data() + shapes.size();) {
        collide::clump_shape& shape = kinds.emplace_back();
        double const* const last = from + 9 + 4 * static_cast<std::size_t>(*from);
        shape.volume = from[1];
        std::copy_n(from + 2, 3, shape.inertia);
        std::copy_n(from + 5, 4, shape.frame.rotation);  // its position is that of the centre of mass, as for Python
        for (from += 9; from != last; from += 4) shape.spheres.push_back({{from[0], from[1], from[2]}, from[3]});
      }
      static_assert(sizeof(collide::placed_clump) == 15 * sizeof(double));
      std::vector<collide::placed_clump> all(placed.size() / 15);
      if (!all.empty()) std::memcpy(static_cast<void*>(all.data()), placed.data(), placed.size() * sizeof(double));
      for (std::size_t i = 0; i < all.size(); ++i) all[i].shape = static_cast<std::size_t>(placed[15 * i]);
      collide::set_clumps(one_, kinds, all, waiting);
      clear(all_effects);
    }
    return has_clumps;
  }
  void steps(std::size_t n, double dt) override { one_.steps(n, static_cast<S>(dt)); }

  std::size_t size() override { return one_.size(); }
  double time() override { return one_.time(); }
  double largest_time_step() override { return collide::largest_time_step(one_); }

  std::vector<double> sums(std::size_t effect) override {
    std::vector<double> found;
    each(effect, [&](auto*, auto& sums) { found = sums.read(one_.space()); });
    return found;
  }
  void clear(std::size_t effect) override {
    each(effect, [&](auto*, auto& sums) { sums.clear(one_.space()); });
  }

  std::vector<double> births() override {
    if constexpr (type::effects_type::makes) {
      collide::birth_counts const n = one_.births();
      return {static_cast<double>(n.due), static_cast<double>(n.overlapping), static_cast<double>(n.not_born)};
    }
    return {};
  }
  void spheres(void* to) override { *static_cast<collide::sphere_view<S>*>(to) = one_.spheres(); }
  bool drive(std::vector<double> const& states) override {
    if constexpr ((std::is_same<Effect, collide::moving_bodies<collide::driven>>::value || ...)) {
      static_assert(sizeof(collide::body_state) == 16 * sizeof(double));
      std::vector<collide::body_state> of(states.size() / 16);
      std::memcpy(static_cast<void*>(of.data()), states.data(), 16 * of.size() * sizeof(double));
      one_.space().copy_from_host(one_.bodies().states(), of.data(), of.size());
      return true;
    }
    return false;
  }

  std::vector<column> columns() override { return describe(typename type::columns{}); }

 private:
  static constexpr bool has_clumps = type::effects_type::has_clumps;

  /// Calls f with the type of an effect, or of each, and its sums: not with the effect, which would wake what sleeps.
  template <class F>
  void each(std::size_t effect, F const& f) {
    std::size_t number = 0;
    auto const is_meant = [&] { return effect == all_effects || effect == number++; };
    ((is_meant() ? f(static_cast<Effect*>(nullptr), std::get<sums_of<Effect>>(sums_)) : void()), ...);
  }
  template <class E>
  E& of(E*) {
    return one_.template effect<E>();
  }

  template <class... Column>
  std::vector<column> describe(collide::columns<Column...>) {
    return {describe<Column>()...};
  }
  template <class Column>
  column describe() {
    using element = collide::detail::column_element<Column, S>;
    std::size_t const width = collide::detail::column_layout<Column, S>::width;
    auto const assign = [](void* to, void const* values) {
      using of_spheres =
          collide::columns<collide::position, collide::velocity, collide::angular_velocity, collide::radius>;
      if constexpr (has_clumps && collide::detail::contains<of_spheres, Column>) {
        throw collide::error("collide: set_clumps says where the spheres of clumps are, and how they move");
      } else {
        static_cast<type*>(to)->template assign<Column>(static_cast<element const*>(values));
      }
    };
    bool const is_float = std::is_floating_point<element>::value;
    return {short_name<Column>(), width, is_float, sizeof(element), one_.template data<Column>(), assign};
  }

  type one_;
  std::tuple<sums_of<Effect>...> sums_;
  std::size_t bodies_ = 0, triangles_ = 0;  ///< of the mesh
};

}  // namespace collide_python

/// Exports a list of effects: the space, the scalar, the narrow phase, and the effects.
#define COLLIDE_PYTHON_SIMULATION(...)                                                                   \
  extern "C" __attribute__((visibility("default"))) collide_python::simulation_base* collide_simulation( \
      collide_python::whereabouts const& where) {                                                        \
    return new collide_python::simulation_of<__VA_ARGS__>(where);                                        \
  }
