// The module for arrays in the memory of the host.
#include "clump_shape.hpp"
#include "fill.hpp"
#include "module.hpp"

NB_MODULE(_host, m) {
  collide_python::bind<collide::host>(m);
  m.def("fill", &collide_python::fill);
  m.def("shape_of_clump", &collide_python::shape_of_clump);
  m.def("random_rotations", &collide_python::random_rotations);
}
