/// \file
/// The version of the library. It is written here only: CMake and the package files read it from this header.
#pragma once

/// The major version.
#define COLLIDE_VERSION_MAJOR 0
/// The minor version. Before 1.0.0 a new one may change or remove public names.
#define COLLIDE_VERSION_MINOR 1
/// The patch version.
#define COLLIDE_VERSION_PATCH 0
/// The version as one number, for the preprocessor to compare: 10000 MAJOR + 100 MINOR + PATCH, so 100 for 0.1.0.
#define COLLIDE_VERSION (COLLIDE_VERSION_MAJOR * 10000 + COLLIDE_VERSION_MINOR * 100 + COLLIDE_VERSION_PATCH)
