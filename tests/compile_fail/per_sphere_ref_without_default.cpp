// expect: collide: what ref() of a per_sphere policy returns is a trivially copyable value, and has a default
// constructor
#include <collide/broad/extend.hpp>
#include <collide/detector.hpp>

struct fussy {
  struct ref_type {
    explicit ref_type(int) {}
    template <class S, class F>
    void for_each_candidate(collide::sphere<S> const&, F const&) const {}
  };
  template <class S>
  struct index {
    template <class Space>
    void build(Space&, fussy const&, collide::mesh_view<S>) {}
    ref_type ref() const { return ref_type(0); }
  };
};
void f(collide::detector<collide::per_sphere<fussy>>& detector) { detector.build({}); }
