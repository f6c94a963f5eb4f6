# collide::mpi: what collide/ranks/mpi.hpp needs, for programs whose ranks are processes of MPI. An installed package includes this
# file too, for find_package(collide COMPONENTS mpi), as what is found is a matter of the machine that compiles.

# collide_find_mpi(): makes the target collide::mpi where CMake finds MPI.
function(collide_find_mpi)
  set(MPI_CXX_SKIP_MPICXX ON)  # the C interface is all that it takes
  set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)
  find_package(MPI QUIET COMPONENTS CXX)
  if(MPI_CXX_FOUND AND NOT TARGET collide::mpi)
    add_library(collide::mpi INTERFACE IMPORTED GLOBAL)
    target_link_libraries(collide::mpi INTERFACE collide::collide MPI::MPI_CXX)
    target_compile_definitions(collide::mpi INTERFACE COLLIDE_HAS_MPI)  # for programs that run with MPI and without
  endif()
endfunction()
