// expect: collide/cuda.cuh needs nvcc
#include <collide/cuda.cuh>
