// expect: collide: atomic_add adds to float, double, or an integer of 32 or 64 bits
#include <collide/spaces/atomic_add.hpp>

void add(short* sum) { collide::atomic_add(sum, 1); }
