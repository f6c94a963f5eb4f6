// The one place where tinyobjloader is compiled.
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>
