/// \file
/// What a module of one space gives Python: the package's Python code calls it, users do not.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <collide/core/version.hpp>

#include "simulation.hpp"

namespace collide_python {

/// Errors of the library are collide.Error in Python.
inline void register_errors() {
  nb::register_exception_translator([](std::exception_ptr const& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (collide::error const& e) {
      PyErr_SetString(nb::module_::import_("collide._errors").attr("Error").ptr(), e.what());
    }
  });
}

/// Binds a function that is given what is called, and arguments, which may be None. In Python a stream, two numbers,
/// comes before them.
template <class Type, class Result, class Of, class... Argument>
void bind_call(nb::class_<held<Type>>& c, char const* name, Result (Of::*function)(Argument...)) {
  auto const call = [function](held<Type>& object, stream_of_call stream, Argument... arguments) {
    Type& of = *object.one;
    typename Type::call const now(of, stream);
    of.begin();
    if constexpr (std::is_same<Of, simulation_base>::value) {  // which knows nothing of Python
      without_gil const others_run;
      return (of.one().*function)(std::forward<Argument>(arguments)...);
    } else {
      return (of.*function)(std::forward<Argument>(arguments)...);
    }
  };
  c.def(name, call, nb::arg(), (static_cast<void>(sizeof(Argument)), nb::arg().none())...);
}

template <class Space, class S>
void bind_mesh(nb::module_& m, char const* name) {
  using type = mesh<Space, S>;
  nb::class_<held<type>> c(m, name);
  using bodies = std::vector<std::pair<std::size_t, std::size_t>> const&;
  c.def(nb::init<int, int, bodies>()).def("__len__", [](held<type> const& of) { return of.one->size(); });
  bind_call(c, "take", &type::take);
  bind_call(c, "query", &type::query);
  bind_call(c, "search", &type::search);
  bind_call(c, "triangles", &type::triangles);
  bind_call(c, "check", &type::check);
  bind_call(c, "seems_closed", &type::seems_closed);
}

template <class Space, class S>
void bind_simulation(nb::module_& m, char const* name) {
  using type = simulation<Space, S>;
  nb::class_<held<type>> c(m, name);
  c.def(nb::init<std::string, int, int>());
  bind_call(c, "set_parameter", &simulation_base::set_parameter);
  bind_call(c, "set_mesh", &type::set_mesh);
  bind_call(c, "set", &type::set);
  bind_call(c, "set_clumps", &type::set_clumps);
  bind_call(c, "columns", &type::columns);
  bind_call(c, "column", &type::column_of);
  bind_call(c, "assign", &type::assign);
  bind_call(c, "steps", &type::steps);
  bind_call(c, "size", &simulation_base::size);
  bind_call(c, "time", &simulation_base::time);
  bind_call(c, "largest_time_step", &simulation_base::largest_time_step);
  bind_call(c, "take_bookkeeping", &type::take_bookkeeping);
  bind_call(c, "energy", &simulation_base::energy);
  bind_call(c, "sums", &simulation_base::sums);
  bind_call(c, "clear", &simulation_base::clear);
  bind_call(c, "births", &simulation_base::births);
  bind_call(c, "contact_report", &simulation_base::contact_report);
  bind_call(c, "contacts", &type::contacts);
  bind_call(c, "drive", &simulation_base::drive);
  bind_call(c, "save", &simulation_base::save);
  bind_call(c, "load", &type::load);
}

template <class Space>
void bind(nb::module_& m) {
  m.attr("version") = nb::make_tuple(COLLIDE_VERSION_MAJOR, COLLIDE_VERSION_MINOR, COLLIDE_VERSION_PATCH);
  nb::set_leak_warnings(false);  // of what threads hold that the end of the interpreter stops
  register_errors();
  watch_forks();
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(&wait_for_calls));
  bind_mesh<Space, float>(m, "MeshFloat");
  bind_mesh<Space, double>(m, "MeshDouble");
  bind_simulation<Space, float>(m, "SimulationFloat");
  bind_simulation<Space, double>(m, "SimulationDouble");
}

}  // namespace collide_python
