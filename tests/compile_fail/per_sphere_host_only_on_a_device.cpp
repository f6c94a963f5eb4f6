// expect: collide: this per_sphere policy is host_only: its index reads the mesh on the host, which in this space
// cannot be read there
#include <collide/broad/extend.hpp>
#include <collide/detector.hpp>

struct remote : collide::host {
  using host::host;
  static constexpr bool host_accessible = false;
};
struct nothing_near {
  template <class S>
  struct ref_type {
    template <class F>
    void for_each_candidate(collide::sphere<S> const&, F const&) const {}
  };
  template <class S>
  struct index {
    static constexpr bool host_only = true;
    template <class Space>
    void build(Space&, nothing_near const&, collide::mesh_view<S>) {}
    ref_type<S> ref() const { return {}; }
  };
};
void f(collide::detector<collide::per_sphere<nothing_near>, collide::karabassi<>, remote>& detector) {
  detector.build({});
}
