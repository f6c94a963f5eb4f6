// expect: collide: points have coordinates of type float or double
#include <collide/core/points.hpp>

collide::point_view<int> none;
