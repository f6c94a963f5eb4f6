#include "hits.hpp"

std::uint64_t hits_of_the_other_unit() { return hits(); }
