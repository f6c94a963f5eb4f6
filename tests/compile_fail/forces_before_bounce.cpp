// expect: collide: an effect comes after those whose result it uses
#include <collide/bounce.hpp>
#include <collide/bucket.cuh>
#include <collide/contact_forces.hpp>
#include <collide/simulation.cuh>

collide::simulation<collide::detector<collide::bucket>, collide::mesh_forces, collide::bounce> forces_too_early;
