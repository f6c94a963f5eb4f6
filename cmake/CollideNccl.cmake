# collide::nccl: what collide/ranks/nccl.hpp needs, for programs whose ranks send by NCCL. An installed package includes
# this file too, for find_package(collide COMPONENTS nccl), as what is found is a matter of the machine that compiles.

# collide_find_nccl(): makes the target collide::nccl where CUDA's runtime and NCCL are found.
function(collide_find_nccl)
  if(TARGET collide::nccl)
    return()
  endif()
  set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)
  find_package(CUDAToolkit QUIET)
  find_path(COLLIDE_NCCL_INCLUDE nccl.h HINTS ${CUDAToolkit_INCLUDE_DIRS})
  find_library(COLLIDE_NCCL_LIBRARY nccl HINTS ${CUDAToolkit_LIBRARY_DIR})
  mark_as_advanced(COLLIDE_NCCL_INCLUDE COLLIDE_NCCL_LIBRARY)
  if(NOT CUDAToolkit_FOUND OR NOT COLLIDE_NCCL_INCLUDE OR NOT COLLIDE_NCCL_LIBRARY)
    return()
  endif()
  add_library(collide::nccl INTERFACE IMPORTED GLOBAL)
  target_link_libraries(collide::nccl INTERFACE collide::collide CUDA::cudart ${COLLIDE_NCCL_LIBRARY})
  target_include_directories(collide::nccl SYSTEM INTERFACE ${COLLIDE_NCCL_INCLUDE})
  target_compile_definitions(collide::nccl INTERFACE COLLIDE_HAS_NCCL)  # for programs that run with NCCL and without
endfunction()
