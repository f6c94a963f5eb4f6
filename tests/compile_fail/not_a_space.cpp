// expect: collide: the third parameter of a detector is an execution space: host, cuda or cuda_shared
#include <collide/bucket.cuh>

struct nowhere {};
collide::detector<collide::bucket, collide::karabassi<>, nowhere> detector;
