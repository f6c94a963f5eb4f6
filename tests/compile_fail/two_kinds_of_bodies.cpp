// expect: collide: a simulation has one effect moving_bodies
#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/simulation.cuh>

collide::simulation<collide::detector<collide::bucket>, collide::bounce, collide::moving_bodies<>,
                    collide::moving_bodies<collide::driven>>
    two_kinds;
