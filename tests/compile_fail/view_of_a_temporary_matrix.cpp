// expect: collide: a temporary matrix is gone when the view of it is read: keep it in a variable
#include <collide/mesh.hpp>

Eigen::MatrixXi const faces(1, 3);
auto const mesh = collide::indexed_mesh(Eigen::MatrixXd(3, 3), faces);
