// expect: collide: an effect comes after those whose result it uses
#include <collide/bucket.cuh>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/wear.hpp>
#include <collide/simulation.cuh>

collide::simulation<collide::detector<collide::bucket>, collide::wear<>, collide::granular_contact<collide::hertz>>
    worn_too_early;
