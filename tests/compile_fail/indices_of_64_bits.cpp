// expect: collide: the indices of an indexed mesh are 32-bit integers
#include <collide/mesh.hpp>

float const vertices[9] = {};
long const corners[3] = {};
auto const mesh = collide::indexed_mesh(vertices, 3, corners, 1);
