/// \file
/// What a module of one space gives Python: the package's Python code calls it, users do not.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "mesh.hpp"

namespace collide_python {

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

template <class Space, class S>
void bind_mesh(nb::module_& m, char const* name) {
  using type = mesh<Space, S>;
  nb::class_<type> c(m, name);
  c.def(nb::init<int, int>(), nb::arg("threads"), nb::arg("device"))
      .def("take", &type::take, nb::arg(), nb::arg().none(), nb::arg())
      .def("__len__", &type::size);
  auto const def = [&](char const* call, auto const function) {
    c.def(
        call,
        [function](type& of, std::string const& precision, nb::object centres, nb::object radius,
                   nb::object displacements, bool canonical, std::optional<std::size_t> capacity, nb::object out,
                   bool numpy) {
          return (of.*function)({precision, std::move(centres), std::move(radius), std::move(displacements), canonical,
                                 capacity, std::move(out), numpy});
        },
        nb::arg(), nb::arg(), nb::arg(), nb::arg().none(), nb::arg(), nb::arg().none(), nb::arg().none(), nb::arg());
  };
  def("count", &type::count);
  def("any", &type::any);
  def("pairs", &type::pairs);
  def("csr", &type::csr);
  def("contacts", &type::contacts);
  def("impacts", &type::impacts);
  def("closest", &type::closest);
  def("earliest", &type::earliest);
  if constexpr (runtime<Space>::is_cuda) {
    c.def("use_stream",
          [](type& of, std::uintptr_t stream, std::int64_t given) { of.where().use_stream(stream, given); });
  }
}

template <class Space>
void bind(nb::module_& m) {
  register_errors();
  watch_forks();
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(&wait_for_calls));
  bind_mesh<Space, float>(m, "MeshFloat");
  bind_mesh<Space, double>(m, "MeshDouble");
}

}  // namespace collide_python
