// expect: collide: the fourth parameter of a detector is the type of the coordinates, float or double
#include <collide/all_pairs.cuh>

collide::detector<collide::all_pairs, collide::karabassi<>, collide::host, int> detector;
