// expect: collide: what ref() of a per_sphere policy returns has a const member for_each_candidate(sphere<S>, f)
#include <collide/broad/extend.hpp>
#include <collide/detector.hpp>

struct blind {
  struct ref_type {};
  template <class S>
  struct index {
    template <class Space>
    void build(Space&, blind const&, collide::mesh_view<S>) {}
    ref_type ref() const { return {}; }
  };
};
void f(collide::detector<collide::per_sphere<blind>>& detector) { detector.build({}); }
