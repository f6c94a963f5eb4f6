// expect: collide: a mesh has coordinates of type float or double
#include <collide/mesh.hpp>

int const corners[9] = {};
auto const mesh = collide::triangle_soup(corners, 1);
