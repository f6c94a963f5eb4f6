// expect: deleted function
#include <collide/simulation/fill.hpp>

collide::cylinder_region const inner({0, 0, 0}, {0, 0, 1}, 0.1);
auto const region = collide::between(collide::box_region{{-1, -1, 0}, {1, 1, 1}}, inner);
