// expect: collide: centres, radii and displacements of spheres have one scalar type, that of the detector
#include <collide/spheres.hpp>

auto make(float const* centres, double const* radii) { return collide::spheres_xyz(centres, 2, radii); }
