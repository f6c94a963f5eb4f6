// expect: collide: a motion of moving_bodies is called as motion(body, time) const
#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/simulation.cuh>

struct mine {
  collide::pose operator()(std::size_t, double) const { return {}; }
};

collide::simulation<collide::detector<collide::bucket>, collide::bounce, collide::moving_bodies<mine>> without_twist;
