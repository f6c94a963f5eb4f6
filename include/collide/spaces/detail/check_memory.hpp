/// \file
/// Refuses arrays in memory that a space cannot read, so far as that can be told.
#pragma once

#include <string>

#include <collide/core/error.hpp>
#include <collide/mesh.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

template <class S, class F>
void for_each_array(mesh_view<S> const& mesh, F const& f) {
  point_view<S> vertices = mesh.vertices();
  vertices.for_each_array([&](S const* from, std::size_t) { f(from); });
  if (mesh.indices() != nullptr) f(mesh.indices());
}
template <class S, class F>
void for_each_array(sphere_view<S> spheres, F const& f) {
  spheres.for_each_array([&](S const* from, std::size_t) { f(from); });
}

/// Throws `error` if a `Space` cannot read what a view points to. The message says so between `what` and `advice`.
template <class Space, class View>
void check_memory(View const& view, char const* what, char const* advice) {
  if (view.size() == 0) return;
  for_each_array(view, [&](void const* p) {
    if (Space::reads(p)) return;
    throw error(std::string("collide: ") + what + " in " + (Space::host_accessible ? "device" : "host") +
                " memory, which the space `" + Space::name() + "` cannot read: " + advice);
  });
}

}  // namespace collide::detail
