# OpenMP, which gives the host threads: the library links it where CMake finds it. An installed package includes this file
# too, as what is found is a matter of the machine that compiles.

option(COLLIDE_OPENMP "Link OpenMP to collide::collide where it is found: the host has threads" ON)

# collide_link_openmp(TARGET): what links TARGET is compiled with OpenMP, as C++ and as CUDA.
function(collide_link_openmp target)
  if(COLLIDE_OPENMP)
    find_package(OpenMP QUIET COMPONENTS CXX)
    set(OpenMP_CXX_FOUND ${OpenMP_CXX_FOUND} PARENT_SCOPE)
  endif()
  if(COLLIDE_OPENMP AND OpenMP_CXX_FOUND)
    # an installed collide looks for it anew
    target_link_libraries(${target} INTERFACE $<BUILD_INTERFACE:OpenMP::OpenMP_CXX>)
    target_compile_options(
      ${target} INTERFACE $<BUILD_INTERFACE:$<$<COMPILE_LANG_AND_ID:CUDA,NVIDIA>:-Xcompiler=${OpenMP_CXX_FLAGS}>>)
  elseif(NOT collide_FIND_QUIETLY)
    message(STATUS "collide: without OpenMP the host has one thread")
  endif()
endfunction()
