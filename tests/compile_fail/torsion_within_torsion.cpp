// expect: collide: torsion and marshall contain a law of rolling, and not a second law of torsion
#include <collide/effects/granular/torsion.hpp>

collide::torsion<collide::marshall<>> law;
