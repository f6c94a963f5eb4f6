// The module for arrays in the memory of the host.
#include "fill.hpp"
#include "module.hpp"

NB_MODULE(_host, m) {
  collide_python::bind<collide::host>(m);
  m.def("fill", &collide_python::fill);
}
