// expect: collide: an effect comes after those whose result it uses
#include <collide/bucket.cuh>
#include <collide/effects/contact_forces.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/simulation.cuh>

collide::simulation<collide::detector<collide::bucket>, collide::pair_forces, collide::granular_contact<collide::hertz>>
    forces_too_early;
