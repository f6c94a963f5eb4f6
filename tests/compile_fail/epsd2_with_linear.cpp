// expect: collide: mindlin, epsd2, jkr and dmt are made for spheres that touch as hertz says
#include <collide/effects/granular_contact.hpp>

collide::granular_contact<collide::linear, collide::dashpot, collide::epsd2> law;
