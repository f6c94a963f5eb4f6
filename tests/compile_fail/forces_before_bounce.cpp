// expect: collide: an effect comes after those whose result it uses
#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/contact_forces.hpp>
#include <collide/simulation.cuh>

collide::simulation<collide::detector<collide::bucket>, collide::mesh_forces, collide::bounce> forces_too_early;
