/// \file
/// A list of effects as Python sees it. The source that _source.py writes has included the effects, and declared
/// `parameters(effect, f)` for each, which calls f(name, member).
#pragma once

#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/bodies.hpp>
#include <collide/bucket.cuh>
#include <collide/checkpoint.hpp>
#include <collide/energy.hpp>
#include <collide/simulation.cuh>

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

template <class Space>
Space make_space(whereabouts const& w) {
  if constexpr (std::is_same<Space, collide::host>::value) {
    return collide::host(w.threads);
  }
#if defined(__CUDACC__)
  else {
    return Space(static_cast<cudaStream_t>(w.stream), w.memory);
  }
#endif
}

/// The library's function of that name, which is found by its argument.
template <class Simulation>
double longest_step(Simulation const& of) {
  return largest_time_step(of);
}

/// Sets the member of a name.
struct parameter_setter {
  char const* wanted;
  double const* values;
  std::size_t n;
  bool* found;

  template <class Number>
  void operator()(char const* name, Number& member) const {
    if (n == 1 && std::strcmp(name, wanted) == 0) {
      member = static_cast<Number>(*values);
      *found = true;
    }
  }
  void operator()(char const* name, double (&member)[3]) const {
    if (n == 3 && std::strcmp(name, wanted) == 0) {
      std::copy(values, values + 3, member);
      *found = true;
    }
  }
  /// What takes `size` numbers at once.
  template <class Set>
  void operator()(char const* name, std::size_t size, Set const& set) const {
    if (n == size && std::strcmp(name, wanted) == 0) {
      set(values);
      *found = true;
    }
  }
};

template <class Space, class S, class NarrowPhase, class... Effect>
class simulation_of final : public simulation_base {
  using type = collide::simulation<collide::detector<collide::bucket, NarrowPhase, Space, S>, Effect...>;

 public:
  explicit simulation_of(whereabouts const& w) : one_(make_space<Space>(w)) {}

  void use(whereabouts const& w) override { one_.space() = make_space<Space>(w); }

  bool set_parameter(std::size_t effect, char const* name, double const* values, std::size_t n) override {
    bool found = false;
    std::size_t number = 0;
    parameter_setter const setter{name, values, n, &found};
    ((number++ == effect ? parameters(one_.template effect<Effect>(), setter) : void()), ...);
    return found;
  }

  void set_mesh(void const* mesh, void const* bodies, std::size_t body_count) override {
    auto const* const first = static_cast<collide::body const*>(bodies);
    one_.set_mesh(*static_cast<collide::mesh_view<S> const*>(mesh),
                  std::vector<collide::body>(first, first + body_count));
  }
  void set(void const* spheres, void const* velocities, std::size_t capacity) override {
    one_.set(*static_cast<collide::sphere_view<S> const*>(spheres), static_cast<S const*>(velocities), capacity);
  }
  void steps(std::size_t n, double dt) override { one_.steps(n, static_cast<S>(dt)); }

  std::size_t size() const override { return one_.size(); }
  double time() const override { return one_.time(); }
  double largest_time_step() const override { return longest_step(one_); }
  void energy(double density, double* four) override {
    collide::energy_sums const e = collide::energy(one_, density);
    for (double const part : {e.kinetic, e.rotational, e.elastic, e.potential}) *four++ = part;
  }

  std::size_t column_count() const override { return type::columns::size; }
  column column_at(std::size_t i) const override { return column_at(i, typename type::columns{}); }
  void assign(std::size_t i, void const* values) override { assign(i, values, typename type::columns{}); }

  void save(char const* path) const override { collide::save(one_, std::string(path)); }
  void load(char const* path) override { collide::load(one_, std::string(path)); }

 private:
  template <class... Column>
  column column_at(std::size_t i, collide::columns<Column...>) const {
    column result{};
    std::size_t number = 0;
    ((number++ == i ? void(result = describe<Column>()) : void()), ...);
    return result;
  }
  template <class Column>
  column describe() const {
    static std::string const name = short_name<Column>();
    using element = collide::detail::column_element<Column, S>;
    constexpr char kind = std::is_floating_point<element>::value ? 'f' : std::is_unsigned<element>::value ? 'u' : 'i';
    return {name.c_str(), std::size_t(collide::detail::column_layout<Column, S>::width), kind, sizeof(element),
            one_.template data<Column>()};
  }
  template <class... Column>
  void assign(std::size_t i, void const* values, collide::columns<Column...>) {
    std::size_t number = 0;
    ((number++ == i
          ? one_.template assign<Column>(static_cast<collide::detail::column_element<Column, S> const*>(values))
          : void()),
     ...);
  }

  type one_;
};

}  // namespace collide_python

/// Exports a list of effects: the space, the scalar, the narrow phase, and the effects.
#define COLLIDE_PYTHON_SIMULATION(...)                                                                   \
  extern "C" __attribute__((visibility("default"))) collide_python::simulation_base* collide_simulation( \
      collide_python::whereabouts const& where) {                                                        \
    return new collide_python::simulation_of<__VA_ARGS__>(where);                                        \
  }
