// expect: collide: the parameter of karabassi_swept is exact
#include <collide/karabassi_swept.hpp>

bool f(collide::triangle<float> t, collide::moving_sphere<float> s) {
  return collide::karabassi_swept<collide::baseline>::intersects(t, s);
}
