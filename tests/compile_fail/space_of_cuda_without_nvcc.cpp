// expect: collide: the spaces cuda and cuda_shared need nvcc: compile this source as CUDA
#include <collide/bucket.cuh>

int main() { collide::cuda_shared space; }
