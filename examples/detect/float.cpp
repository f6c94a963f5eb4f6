#include "detect.hpp"

template detection::findings<float> detection::detect(options const&, scene<float> const&);
