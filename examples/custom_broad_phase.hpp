/// \file
/// The broad phase of custom_broad_phase.cpp, which the tests run in all spaces.
#pragma once

#include <collide/broad/extend.hpp>

/// The policy has no options.
struct bounding_spheres {
  template <class S>
  struct ref_type {
    collide::bounding_sphere<S> const* bounds;
    collide::id count;

    template <class F>
    COLLIDE_HD void for_each_candidate(collide::sphere<S> const& sphere, F const& f) const {
      for (collide::id t = 0; t < count; ++t) {
        if (bounds[t].is_reached_by(sphere)) f(t);
      }
    }
  };

  template <class S>
  struct bound_triangle {
    collide::mesh_view<S> mesh;
    collide::bounding_sphere<S>* bounds;
    COLLIDE_HD void operator()(std::size_t i) const { bounds[i] = collide::bounding_sphere<S>(mesh[i]); }
  };

  template <class S>
  class index {
   public:
    template <class Space>
    void build(Space& space, bounding_spheres const&, collide::mesh_view<S> mesh) {
      count_ = static_cast<collide::id>(mesh.size());
      bounds_.reserve(space.resource(), mesh.size());
      space.for_each(mesh.size(), bound_triangle<S>{mesh, bounds_.data()});
    }
    ref_type<S> ref() const { return {bounds_.data(), count_}; }

   private:
    collide::buffer<collide::bounding_sphere<S>> bounds_;
    collide::id count_ = 0;
  };
};
