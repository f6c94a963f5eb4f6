// expect: collide: the parameter of karabassi is a precision
#include <collide/karabassi.hpp>

struct precision {};
bool f(collide::triangle<float> t, collide::sphere<float> s) { return collide::karabassi<precision>::intersects(t, s); }
