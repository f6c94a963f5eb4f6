// expect: collide: the second parameter of a detector is a narrow phase, such as karabassi<>
#include <collide/bucket.cuh>

struct no_narrow_phase {};
collide::detector<collide::bucket, no_narrow_phase> detector;
