/// \file
/// Headers of others that the library includes, to be precompiled for tests that are many compilations of a few lines.
/// It must have nothing of the library itself. Where it has not been precompiled, compilers read it as it is.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <memory_resource>
#include <numeric>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>
