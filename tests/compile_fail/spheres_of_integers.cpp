// expect: collide: spheres have coordinates of type float or double
#include <collide/spheres.hpp>

int const centres[4] = {};
auto const spheres = collide::spheres_xyzr(centres, 1);
