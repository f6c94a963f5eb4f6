#include "detect.hpp"

template detection::findings<double> detection::detect(options const&, scene<double> const&);
