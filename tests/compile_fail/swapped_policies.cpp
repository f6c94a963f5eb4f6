// expect: collide: the first parameter of a detector is a broad phase, such as bucket or all_pairs
#include <collide/all_pairs.cuh>

collide::detector<collide::karabassi<>, collide::all_pairs> detector;
