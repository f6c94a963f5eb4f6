// The module for arrays in the memory of the host.
#include "module.hpp"

NB_MODULE(_host, m) { collide_python::bind<collide::host>(m); }
