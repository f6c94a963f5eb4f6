/// \file
/// Arrays of Python as views of the library: nothing is converted or copied, and what does not fit is an error that
/// names the argument.
#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <collide/core/moving_spheres.hpp>
#include <collide/mesh.hpp>

namespace collide_python {

namespace nb = nanobind;

using array = nb::ndarray<nb::ro>;

template <nb::builtin_exception (*error)(char const*) = nb::value_error>
[[noreturn]] void refuse(char const* name, std::string const& why) {
  throw error((std::string(name) + ": " + why).c_str());
}

/// A dtype as numpy names it.
inline std::string name_of(nb::dlpack::dtype const& type) {
  static char const* const names[] = {"int", "uint", "float", "opaque", "bfloat", "complex", "bool"};  // of DLPack
  if (type.code >= std::size(names)) return "another type";
  return names[type.code] + (type == nb::dtype<bool>() ? "" : std::to_string(type.bits));
}

inline constexpr std::size_t any_number = static_cast<std::size_t>(-1);  ///< of rows
inline constexpr std::size_t most_rows = 0x7fffffff;

/// A shape as Python shows it; a length that may be any has a name.
inline std::string text_of(std::vector<std::size_t> const& shape, char const* any = "") {
  std::string text = "(";
  for (std::size_t k = 0; k < shape.size(); ++k)
    text += (k != 0 ? ", " : "") + (shape[k] == any_number ? any : std::to_string(shape[k]));
  return text + (shape.size() == 1 ? ",)" : ")");
}
template <class Array>
std::string shape_of(Array const& a) {
  return text_of({a.shape_ptr(), a.shape_ptr() + a.ndim()});
}

template <class Array, class Shape = std::initializer_list<std::size_t>>
bool has_shape(Array const& a, Shape const& shape) {
  std::size_t k = 0;
  auto const fits = [&](std::size_t n) { return a.shape(k++) == n || n == any_number; };
  return a.ndim() == shape.size() && std::all_of(shape.begin(), shape.end(), fits);
}

/// Whether an array has no gaps, in C's order.
template <class Array>
bool is_packed(Array const& a) {
  std::int64_t step = 1;
  bool packed = true;
  for (std::size_t k = a.ndim(); k-- > 0; step *= static_cast<std::int64_t>(a.shape(k)))
    packed = packed && (a.shape(k) <= 1 || a.stride(k) == step);
  return packed || a.size() == 0;
}

/// Where the arrays of a call are. `given` is the stream that DLPack is told of: -1 where the producer works on the
/// stream of the call anyway.
struct place {
  int device_type = nb::device::cpu::value;
  int device = 0;
  std::int64_t given = -1;
};

inline bool is_on_host(int device_type) {
  return device_type == nb::device::cpu::value || device_type == nb::device::cuda_host::value;
}
inline std::string name_of_device(int type, int number) {
  if (is_on_host(type)) return "the host";
  return (type == nb::device::cuda::value ? "GPU " : "device " + std::to_string(type) + ":") + std::to_string(number);
}

/// What the `__dlpack__` of an array exports.
inline nb::object exported(nb::handle from, char const* name, place const& at) {
  try {
    auto const is_here = [&] {
      nb::object const type = from.attr("__dlpack_device__")()[0];
      return is_on_host(nb::cast<int>(nb::int_(nb::getattr(type, "value", type))));  // Open3D's is no int
    };
    bool const has_stream = !is_on_host(at.device_type) && !is_here();  // that it is here is told by who asks
    return has_stream ? from.attr("__dlpack__")(nb::arg("stream") = at.given) : from.attr("__dlpack__")();
  } catch (nb::python_error& e) {
    if (!e.matches(PyExc_Exception)) throw;  // Ctrl-C
    refuse<nb::type_error>(name, std::string("cannot be shared without a copy: ") + nb::str(e.value()).c_str());
  }
}

/// The array that a Python object is. `Array` without nb::ro is one to write to.
template <class Array = array>
Array import_array(nb::handle from, char const* name, place const& at) {
  Array a;
  if ((is_on_host(at.device_type) || PyCapsule_CheckExact(from.ptr())) && nb::try_cast(from, a, false)) {
    // an array of the host, or one that its library has exported
  } else if (!nb::hasattr(from, "__dlpack__")) {
    refuse<nb::type_error>(name, "expected an array (numpy, torch, cupy, jax, warp: with __dlpack__), got " +
                                     std::string(nb::type_name(from.type()).c_str()));
  } else if (!nb::try_cast(exported(from, name, at), a, false)) {
    refuse<nb::type_error>(name, "is read-only, or no array that can be shared");
  }
  bool const same = is_on_host(at.device_type) ? is_on_host(a.device_type())
                                               : a.device_type() == at.device_type && a.device_id() == at.device;
  if (!same)
    refuse(name, "is on " + name_of_device(a.device_type(), a.device_id()) + ", but the mesh is on " +
                     name_of_device(at.device_type, at.device));
  if (reinterpret_cast<std::uintptr_t>(a.data()) % std::max<std::size_t>(1, a.dtype().bits / 8) != 0)
    refuse(name, "lies at an address that is no multiple of the size of its numbers: make a copy");
  return a;
}

template <class S, class Array>
void check_type(Array const& a, char const* name, char const* what = "") {
  if (a.dtype() == nb::dtype<S>()) return;
  refuse<nb::type_error>(name, "has dtype " + name_of(a.dtype()) + ", expected " + name_of(nb::dtype<S>()) + what);
}
inline constexpr char const* as_vertices = ", that of the vertices: nothing is converted";

/// A stride in elements that the views can carry. Arrays of no or one row may have any.
inline std::size_t row_stride(array const& a, char const* name, std::size_t if_any) {
  if (a.shape(0) <= 1) return if_any;
  if (a.stride(0) < 0)
    refuse(name, "has rows in reverse order (a negative stride), which is not read without a copy: make one");
  return static_cast<std::size_t>(a.stride(0));
}

/// Points of shape (n, 3), of any strides that are not negative along the rows.
template <class S>
collide::point_view<S> points_of(array const& a, char const* name, char const* type_of = as_vertices) {
  check_type<S>(a, name, type_of);
  if (!has_shape(a, {any_number, 3})) refuse(name, "has shape " + shape_of(a) + ", expected (n, 3)");
  S const* const x = static_cast<S const*>(a.data());
  std::size_t const n = a.shape(0);
  if (n > most_rows) refuse(name, "has more than 2,147,483,647 rows");
  if (n == 0) return {nullptr, nullptr, nullptr, 3, 0};
  return {x, x + a.stride(1), x + 2 * a.stride(1), row_stride(a, name, 3), n};
}

/// Copies numbers of vertices, of which there are so many; one that does not exist becomes `other`.
template <class From>
struct copy_triangle {
  From const* from;
  std::int64_t row, column;
  std::size_t vertices;
  collide::id other;
  collide::id* to;

  COLLIDE_HD void operator()(std::size_t i) const {
    for (int k = 0; k < 3; ++k) {
      std::uint64_t const x = from[static_cast<std::int64_t>(i) * row + k * column];
      to[3 * i + static_cast<std::size_t>(k)] = x < vertices ? static_cast<collide::id>(x) : other;
    }
  }
};

/// Copies triangles of shape (m, 3), of any integers of 32 or 64 bits and any strides. As integers without a sign they
/// are the same numbers of vertices, and below 0 none.
template <class Space>
void copy_triangles(Space const& space, array const& a, std::size_t vertices, collide::id other, collide::id* to) {
  auto const copy = [&](auto const* from) {
    using integer = std::remove_const_t<std::remove_pointer_t<decltype(from)>>;
    space.for_each(a.shape(0), copy_triangle<integer>{from, a.stride(0), a.stride(1), vertices, other, to});
  };
  if (a.dtype().bits == 32) return copy(static_cast<std::uint32_t const*>(a.data()));
  copy(static_cast<std::uint64_t const*>(a.data()));
}

inline void check_triangles(array const& a, std::size_t vertices) {
  auto const code = static_cast<nb::dlpack::dtype_code>(a.dtype().code);
  bool const is_integer = code == nb::dlpack::dtype_code::Int || code == nb::dlpack::dtype_code::UInt;
  if (!is_integer || (a.dtype().bits != 32 && a.dtype().bits != 64) || a.dtype().lanes != 1)
    refuse<nb::type_error>("triangles", "has dtype " + name_of(a.dtype()) + ", expected integers of 32 or 64 bits");
  if (!has_shape(a, {any_number, 3})) refuse("triangles", "has shape " + shape_of(a) + ", expected (m, 3)");
  if (a.shape(0) > most_rows) refuse("triangles", "has more than 2,147,483,647 rows");
  if (a.shape(0) != 0 && vertices == 0) refuse("triangles", "there are some, and no vertices");
}

/// Whether a Python object is one number that the host can read.
inline bool is_number(nb::handle from, place const& at) {
  if (PyFloat_Check(from.ptr())) return true;
  if (!nb::hasattr(from, "__float__")) return false;
  if (!nb::hasattr(from, "ndim")) return true;
  int dimensions = 1;  // of a class such as numpy.ndarray it is no number
  nb::try_cast(from.attr("ndim"), dimensions);
  return dimensions == 0 && (is_on_host(at.device_type) || !nb::hasattr(from, "__dlpack__"));
}

/// A radius for all, or an array of shape (n,). `keep` holds the array.
template <class S>
collide::sphere_view<S> spheres_of(collide::point_view<S> const& centres, nb::handle radius, array& keep,
                                   place const& at) {
  if (is_number(radius, at)) {
    double const number = PyFloat_AsDouble(radius.ptr());
    if (number == -1 && PyErr_Occurred() != nullptr) {
      nb::python_error const why;
      if (!why.matches(PyExc_Exception)) throw why;
      refuse("radius", nb::str(why.value()).c_str());
    }
    return collide::spheres_at(centres, static_cast<S>(number));
  }
  keep = import_array(radius, "radius", at);
  check_type<S>(keep, "radius", as_vertices);
  if (!has_shape(keep, {centres.size()}))
    refuse("radius", "has shape " + shape_of(keep) + ", expected a number or " + text_of({centres.size()}) +
                         ", one for each centre");
  return collide::spheres_at(centres, static_cast<S const*>(keep.data()), row_stride(keep, "radius", 1));
}

/// An array of the caller to write `T`s to, which is packed and of a shape.
template <class T>
T* room_of(nb::handle from, place const& at, std::vector<std::size_t> const& shape, std::size_t* rows = nullptr) {
  auto const a = import_array<nb::ndarray<>>(from, "out", at);
  if (sizeof(T) != 1 || a.dtype() != nb::dtype<bool>()) check_type<T>(a, "out");
  if (!has_shape(a, shape)) refuse("out", "has shape " + shape_of(a) + ", expected " + text_of(shape, "capacity"));
  if (!is_packed(a)) refuse("out", "is not packed (C order)");
  if (rows != nullptr) *rows = a.shape(0);
  return static_cast<T*>(a.data());
}

}  // namespace collide_python
