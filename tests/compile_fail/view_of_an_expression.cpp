// expect: collide: an expression of Eigen has no memory that a view can read: keep it in a matrix
#include <collide/spheres.hpp>

Eigen::MatrixXf const centres(2, 3);
auto const spheres = collide::spheres_at(collide::points(centres.cast<double>()), 1);
