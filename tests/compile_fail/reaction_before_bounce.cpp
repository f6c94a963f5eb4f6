// expect: collide: an effect comes after those whose result it uses
#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/simulation.cuh>

collide::simulation<collide::detector<collide::bucket>, collide::reaction, collide::bounce, collide::moving_bodies<>>
    sums_too_early;
