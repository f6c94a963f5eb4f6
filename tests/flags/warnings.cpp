/// \file
/// Uses what there is, so that its templates are made and a compiler can warn of them: nothing is run.
#include <collide/automatic.cuh>
#include <collide/broad/extend.hpp>
#include <collide/checks/self_intersections.hpp>
#include <collide/checks/validate.hpp>
#include <collide/core/moving_spheres.hpp>
#include <collide/detectors/in_passes.hpp>
#include <collide/detectors/streamed.cuh>
#include <collide/effects/absorb.hpp>
#include <collide/effects/adhesion.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/drag.hpp>
#include <collide/effects/emit.hpp>
#include <collide/effects/friction.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/lost_motion.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/effects/sleep.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/effects/spin.hpp>
#include <collide/effects/wind.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/ranks/distributed.hpp>
#include <collide/ranks/distributed_checkpoint.hpp>
#include <collide/ranks/distributed_clumps.hpp>
#include <collide/ranks/thread_ranks.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/checkpoint.hpp>
#include <collide/sinks/earliest.hpp>
#include <collide/sinks/impacts.hpp>
#include <collide/spaces/atomic_add.hpp>
#include <collide/spaces/upload.hpp>

using namespace collide;

template <class BroadPhase, class NarrowPhase, class S>
void ask(mesh_view<S> mesh, typename detector<BroadPhase, NarrowPhase, host, S>::spheres_type const& spheres) {
  detector<BroadPhase, NarrowPhase, host, S> one;
  one.build(mesh, S(1));
  one.query(spheres, count());
  one.query(spheres, any_hit()).to_host();
  one.query(spheres, pairs(order::canonical)).to_host();
  one.query(spheres, contacts<S>(order::canonical)).to_host();
  one.query(spheres, visit([](auto const& hit) { (void)hit.contact(); }));
  streamed<detector<BroadPhase, NarrowPhase, host, S>> parts(one);
  in_passes<detector<BroadPhase, NarrowPhase, host, S>> passes;
  passes.build(mesh, 2);
  passes.query(spheres, contacts<S>(order::canonical)).to_host();
  count total;
  parts.query(spheres, total, [](id, count const&) {});
  if constexpr (detail::is_discrete<NarrowPhase, S>) {
    one.query(spheres, closest<S>()).to_host();
    one.query(spheres, closest_contact<S>()).to_host();
  } else {
    one.query(spheres, impacts<S>()).to_host();
    one.query(spheres, earliest<S>()).to_host();
    one.query(spheres, earliest_impact<S>()).to_host();
  }
}

template <class NarrowPhase, class S>
void move(mesh_view<S> mesh, sphere_view<S> const& spheres) {
  using scene = simulation<detector<bucket, NarrowPhase, host, S>, velocity_verlet, collide::sleep, sphere_contact,
                           gravity, drag, wind<>, bounce, friction, spin, adhesion, emit, absorb, absorbing_box,
                           box_walls, periodic_box, polydisperse, lost_motion>;
  scene one;
  one.set(spheres, static_cast<S const*>(nullptr), 100);
  one.set_mesh(mesh);
  one.steps(2, S(0.1));
  one.template to_host<position>();
  one.spheres();
  save(one, "file");
  load(one, "file");
}

template <class S>
void use_all() {
  S const numbers[12] = {};
  unsigned const corners[3] = {};
  Eigen::Matrix<S, 3, 3> matrix;
  Eigen::Matrix3i faces;
  auto const mesh = indexed_mesh(numbers, 3, corners, 1);
  auto const spheres = spheres_xyz(numbers, 3, S(1));
  host space;
  upload(space, mesh);
  upload(space, spheres);
  validate(mesh);
  validate(spheres);
  self_intersections(mesh);
  ask<bucket, karabassi<>, S>(indexed_mesh(matrix, faces), spheres_xyz(numbers, 3, numbers));
  ask<automatic, karabassi<single_precision>, S>(triangle_soup(numbers, 1),
                                                 spheres_soa(numbers, numbers, numbers, 3, S(1)));
  ask<all_pairs, karabassi<double_precision>, S>(mesh, spheres_xyzr(numbers, 3));
  ask<bucket, karabassi<baseline>, S>(mesh, spheres);
  ask<bucket, karabassi_swept<>, S>(mesh, with_displacements(spheres, numbers));
  thread_ranks::run(1, [&](thread_ranks const& ranks) {
    distributed<detector<bucket, karabassi<>, host, S>, thread_ranks> all(ranks);
    all.build(mesh, divided);
    all.query(spheres, contacts<S>());
    distributed<simulation<detector<bucket, karabassi<>, host, S>, emit, sphere_contact, bounce>, thread_ranks> parts(
        ranks);
    parts.set_mesh(mesh);
    parts.set(spheres, nullptr, 10);
    parts.step(S(0.1));
    parts.template to_host<velocity>();
    save(parts, "checkpoint");
    load(parts, "checkpoint");
  });
  move<karabassi<>, S>(mesh, spheres);
  move<karabassi_swept<>, S>(mesh, spheres);
}

int main() {
  use_all<float>();
  use_all<double>();
}
