/// \file
/// Arrays of Python as views of the library: nothing is converted or copied, and what does not fit is an error that
/// names the argument.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <collide/mesh.hpp>
#include <collide/moving_spheres.hpp>

namespace collide_python {

namespace nb = nanobind;

using array = nb::ndarray<nb::ro>;

[[noreturn]] inline void refuse(char const* name, std::string const& why) {
  throw nb::value_error((std::string(name) + ": " + why).c_str());
}
[[noreturn]] inline void refuse_type(char const* name, std::string const& why) {
  throw nb::type_error((std::string(name) + ": " + why).c_str());
}

inline std::string name_of(nb::dlpack::dtype const& type) {
  using code = nb::dlpack::dtype_code;
  std::string const bits = std::to_string(type.bits);
  switch (static_cast<code>(type.code)) {
    case code::Int:
      return "int" + bits;
    case code::UInt:
      return "uint" + bits;
    case code::Float:
      return "float" + bits;
    case code::Bool:
      return "bool";
    case code::Complex:
      return "complex" + bits;
    case code::Bfloat:
      return "bfloat" + bits;
    default:
      return "another type";
  }
}

template <class Array>
std::string shape_of(Array const& a) {
  std::string text = "(";
  for (std::size_t k = 0; k < a.ndim(); ++k) text += (k != 0 ? ", " : "") + std::to_string(a.shape(k));
  return text + (a.ndim() == 1 ? ",)" : ")");
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

/// The array that a Python object is. `Array` without nb::ro is one to write to.
template <class Array = array>
Array import_array(nb::handle from, char const* name, place const& at) {
  Array a;
  if (is_on_host(at.device_type) && nb::try_cast(from, a, false)) {
    // an array of the host
  } else if (nb::hasattr(from, "__dlpack__")) {
    nb::object capsule;
    try {
      nb::object const method = from.attr("__dlpack__");
      capsule = is_on_host(at.device_type) ? method() : method(nb::arg("stream") = at.given);
    } catch (nb::python_error& e) {
      refuse_type(name, std::string("cannot be shared without a copy: ") + nb::str(e.value()).c_str());
    }
    if (!nb::try_cast(capsule, a, false)) refuse_type(name, "is read-only, or no array that can be shared");
  } else {
    refuse_type(name, "expected an array (numpy, torch, cupy, jax, warp: with __dlpack__), got " +
                          std::string(nb::type_name(from.type()).c_str()));
  }
  bool const same = is_on_host(at.device_type) ? is_on_host(a.device_type())
                                               : a.device_type() == at.device_type && a.device_id() == at.device;
  if (!same)
    refuse(name, "is on " + name_of_device(a.device_type(), a.device_id()) + ", but the mesh is on " +
                     name_of_device(at.device_type, at.device));
  return a;
}

template <class S>
void check_type(array const& a, char const* name, char const* what) {
  if (a.dtype() == nb::dtype<S>()) return;
  refuse_type(name, "has dtype " + name_of(a.dtype()) + ", expected " + name_of(nb::dtype<S>()) + what);
}

/// A stride in elements that the views can carry. Arrays of no or one row may have any.
inline std::size_t row_stride(array const& a, char const* name, std::size_t if_any) {
  if (a.shape(0) <= 1) return if_any;
  if (a.stride(0) < 0)
    refuse(name, "has rows in reverse order (a negative stride), which is not read without a copy: make one");
  return static_cast<std::size_t>(a.stride(0));
}

/// Points of shape (n, 3), of any strides that are not negative along the rows.
template <class S>
collide::point_view<S> points_of(array const& a, char const* name,
                                 char const* type_of = ", that of the vertices: nothing is converted") {
  check_type<S>(a, name, type_of);
  if (a.ndim() != 2 || a.shape(1) != 3) refuse(name, "has shape " + shape_of(a) + ", expected (n, 3)");
  S const* const x = static_cast<S const*>(a.data());
  std::size_t const n = a.shape(0);
  if (n == 0) return {nullptr, nullptr, nullptr, 3, 0};
  return {x, x + a.stride(1), x + 2 * a.stride(1), row_stride(a, name, 3), n};
}

/// Triangles of shape (m, 3), int32 or uint32, of any strides that are not negative.
template <class S>
collide::mesh_view<S> mesh_of(collide::point_view<S> const& vertices, array const& a, char const* name) {
  if (a.dtype() != nb::dtype<std::int32_t>() && a.dtype() != nb::dtype<std::uint32_t>())
    refuse_type(name, "has dtype " + name_of(a.dtype()) + ", expected int32 or uint32: nothing is converted");
  if (a.ndim() != 2 || a.shape(1) != 3) refuse(name, "has shape " + shape_of(a) + ", expected (m, 3)");
  std::size_t const m = a.shape(0);
  if (m == 0) return {};
  if (a.stride(1) < 0) refuse(name, "has columns in reverse order (a negative stride), which is not read: make a copy");
  return {vertices, static_cast<collide::id const*>(a.data()), m, row_stride(a, name, 3),
          static_cast<std::size_t>(a.stride(1))};
}

/// Whether a Python object is one number that the host can read.
inline bool is_number(nb::handle from, place const& at) {
  if (PyFloat_Check(from.ptr())) return true;
  if (!nb::hasattr(from, "__float__")) return false;
  if (!nb::hasattr(from, "ndim")) return true;
  bool const is_scalar = nb::cast<int>(from.attr("ndim")) == 0;
  return is_scalar && (is_on_host(at.device_type) || !nb::hasattr(from, "__dlpack__"));
}

/// A radius for all, or an array of shape (n,). `keep` holds the array.
template <class S>
collide::sphere_view<S> spheres_of(collide::point_view<S> const& centres, nb::handle radius, array& keep,
                                   place const& at) {
  if (centres.size() > 0x7fffffff) refuse("centres", "has more than 2,147,483,647 rows");
  if (is_number(radius, at)) {
    double const number = PyFloat_AsDouble(radius.ptr());
    if (number == -1 && PyErr_Occurred() != nullptr) throw nb::python_error();
    return collide::spheres_at(centres, static_cast<S>(number));
  }
  keep = import_array(radius, "radius", at);
  check_type<S>(keep, "radius", ", that of the vertices: nothing is converted");
  if (keep.ndim() != 1 || keep.shape(0) != centres.size())
    refuse("radius", "has shape " + shape_of(keep) + ", expected a number or (" + std::to_string(centres.size()) +
                         ",), one for each centre");
  return collide::spheres_at(centres, static_cast<S const*>(keep.data()), row_stride(keep, "radius", 1));
}

inline constexpr std::size_t any_number = static_cast<std::size_t>(-1);  ///< of rows

/// An array of the caller to write `T`s to, which is packed and of a shape.
template <class T>
T* room_of(nb::ndarray<> const& a, char const* name, std::vector<std::size_t> const& shape) {
  bool const is_flag = sizeof(T) == 1 && a.dtype() == nb::dtype<bool>();
  if (a.dtype() != nb::dtype<T>() && !is_flag)
    refuse_type(name, "has dtype " + name_of(a.dtype()) + ", expected " + name_of(nb::dtype<T>()));
  bool fits = a.ndim() == shape.size(), is_packed = true;
  std::string expected;
  for (std::size_t k = 0; k < shape.size(); ++k) {
    fits = fits && (shape[k] == any_number || a.shape(k) == shape[k]);
    expected += (k != 0 ? ", " : "(") + (shape[k] == any_number ? "capacity" : std::to_string(shape[k]));
  }
  if (!fits) refuse(name, "has shape " + shape_of(a) + ", expected " + expected + (shape.size() == 1 ? ",)" : ")"));
  std::int64_t step = 1;
  for (std::size_t k = a.ndim(); k-- > 0; step *= static_cast<std::int64_t>(a.shape(k)))
    is_packed = is_packed && (a.shape(k) <= 1 || a.stride(k) == step);
  if (!is_packed && a.size() != 0) refuse(name, "is not packed (C order)");
  return static_cast<T*>(a.data());
}

}  // namespace collide_python
