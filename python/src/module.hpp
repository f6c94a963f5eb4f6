/// \file
/// What a module of one space gives Python: the package's Python code calls it, users do not.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "simulation.hpp"

namespace collide_python {

/// A stream of calls, and what DLPack's exporters are told.
using stream_numbers = std::pair<std::uintptr_t, std::int64_t>;

inline void set_error(nb::handle error, std::exception const& e) { PyErr_SetString(error.ptr(), e.what()); }

/// Errors of the library are collide.Error in Python.
inline void register_errors() {
  nb::register_exception_translator(
      [](std::exception_ptr const& thrown, void*) {
        try {
          std::rethrow_exception(thrown);
        } catch (collide::error const& e) {
          set_error(nb::module_::import_("collide._errors").attr("Error"), e);
        }
      },
      nullptr);
}

/// Binds a member whose first argument is a stream: in Python two numbers.
template <class Class, class Type, class Result, class... Argument>
void bind_call(Class& c, char const* name, Result (Type::*function)(stream_of_call, Argument...)) {
  c.def(
      name,
      [function](Type& of, stream_numbers stream, Argument... arguments) {
        return (of.*function)({stream.first, stream.second}, std::forward<Argument>(arguments)...);
      },
      nb::arg(), (static_cast<void>(sizeof(Argument)), nb::arg().none())...);
}

template <class Space, class S>
void bind_mesh(nb::module_& m, char const* name) {
  using type = mesh<Space, S>;
  nb::class_<type> c(m, name);
  auto const def = [&](char const* call, auto const function) { bind_call(c, call, function); };
  c.def(nb::init<int, int>(), nb::arg("threads"), nb::arg("device")).def("__len__", &type::size);
  def("take", &type::take);
  def("search", &type::search);
  def("count", &type::count);
  def("any", &type::any);
  def("pairs", &type::pairs);
  def("csr", &type::csr);
  def("contacts", &type::contacts);
  def("impacts", &type::impacts);
  def("closest", &type::closest);
  def("earliest", &type::earliest);
}

template <class Space, class S>
void bind_simulation(nb::module_& m, char const* name) {
  using type = simulation<Space, S>;
  nb::class_<type> c(m, name);
  auto const def = [&](char const* call, auto const function) { bind_call(c, call, function); };
  c.def(nb::init<std::string, int, int>())
      .def("__len__", &type::size)
      .def("time", &type::time)
      .def("largest_time_step", &type::largest_time_step)
      .def("columns", &type::columns);
  def("set_parameter", &type::set_parameter);
  def("set_mesh", &type::set_mesh);
  def("set", &type::set);
  def("steps", &type::steps);
  def("energy", &type::energy);
  def("column", &type::column_of);
  def("assign", &type::assign);
  def("save", &type::save);
  def("load", &type::load);
}

template <class Space>
void bind(nb::module_& m) {
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
