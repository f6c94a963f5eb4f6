# What executables of tests, examples and benchmarks share is in collide_options.
# collide_program(NAME SOURCE...): its sources are .cpp files that are compiled as CUDA where COLLIDE_CUDA and
# COLLIDE_ALL_CUDA are ON and as C++ otherwise.
# collide_cuda_program(NAME SOURCE...): the same, whatever COLLIDE_ALL_CUDA says.
# collide_host_program(NAME SOURCE...): nothing in it is for CUDA.
# They link collide::compiled, those for CUDA collide::compiled_cuda too, so that they compile what is theirs alone.

set(COLLIDE_EXTRA_INCLUDE "" CACHE PATH "Folder of third-party headers that the system lacks")

find_package(Threads REQUIRED)

# Assimp, for meshes that are not OBJ, where it is: its target, else empty.
find_package(assimp QUIET)
set(COLLIDE_ASSIMP "")
if(TARGET assimp::assimp)
  set(COLLIDE_ASSIMP assimp::assimp)
else()
  collide_missing("Assimp (Debian: libassimp-dev)")
endif()

add_library(collide_options INTERFACE)
target_include_directories(collide_options SYSTEM INTERFACE ${COLLIDE_EXTRA_INCLUDE})
target_link_libraries(collide_options INTERFACE collide::collide Threads::Threads)
if(COLLIDE_CUDA)
  target_link_libraries(collide_options INTERFACE collide::cuda)
endif()

# nvcc's own output is not pedantic C++, nor free of conversions.
target_compile_options(
  collide_options
  INTERFACE $<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang,AppleClang>:-Wall -Wextra -Wpedantic -Wconversion>
            $<$<COMPILE_LANG_AND_ID:CUDA,NVIDIA>:-Xcompiler=-Wall,-Wextra>)
if(COLLIDE_WERROR)
  target_compile_options(collide_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Werror>
                                                   $<$<COMPILE_LANG_AND_ID:CUDA,NVIDIA>:-Werror=all-warnings>)
endif()

# What takes longer to compile than what it computes takes in the tests: a third less with plain inline functions.
# g++ collects its garbage from 500 MB on, which takes a sixteenth less.
set(COLLIDE_QUICK_OPTIONS -Og -DCOLLIDE_PLAIN_INLINE)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  list(APPEND COLLIDE_QUICK_OPTIONS --param=ggc-min-heapsize=500000)
endif()

# Of what most of these compile, half is Eigen, which nearly all headers of the library include: they have it precompiled.
if(COLLIDE_QUICK_BUILD)
  file(CONFIGURE OUTPUT quick_eigen.cpp CONTENT "")
  add_library(quick_eigen OBJECT EXCLUDE_FROM_ALL ${CMAKE_CURRENT_BINARY_DIR}/quick_eigen.cpp)
  target_link_libraries(quick_eigen PRIVATE collide_options)
  target_compile_options(quick_eigen PRIVATE ${COLLIDE_QUICK_OPTIONS})
  target_precompile_headers(quick_eigen PRIVATE <Eigen/Core>)
endif()

# collide_quick_build(NAME [OWN_HEADERS]): a target of that kind, which precompiles headers of its own
function(collide_quick_build name)
  if(COLLIDE_QUICK_BUILD)
    target_compile_options(${name} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:${COLLIDE_QUICK_OPTIONS}>")
    if(NOT "OWN_HEADERS" IN_LIST ARGN)
      target_precompile_headers(${name} REUSE_FROM quick_eigen)
    endif()
  endif()
endfunction()

function(collide_host_program name)
  add_executable(${name} ${ARGN})
  target_link_libraries(${name} PRIVATE collide_options collide::compiled)
  collide_quick_build(${name})
endfunction()

function(collide_cuda_program name)
  add_executable(${name} ${ARGN})
  target_link_libraries(${name} PRIVATE collide_options collide::compiled)
  if(COLLIDE_CUDA)
    target_link_libraries(${name} PRIVATE collide::compiled_cuda)
    set_source_files_properties(${ARGN} PROPERTIES LANGUAGE CUDA)
    if(COLLIDE_QUICK_BUILD)  # tests run it on the host; where nvcc has an -O of its own, that holds
      target_compile_options(${name} PRIVATE $<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=-O1>)
    endif()
  endif()
endfunction()

# collide_ptx(NAME SOURCE...): device code that no GPU is here to run: it is compiled to PTX, without its host code, and
# not linked, which takes half the time.
function(collide_ptx name)
  set_source_files_properties(${ARGN} PROPERTIES LANGUAGE CUDA)
  add_library(${name} OBJECT ${ARGN})
  set_target_properties(${name} PROPERTIES CUDA_PTX_COMPILATION ON)
  target_link_libraries(${name} PRIVATE collide_options)
endfunction()

function(collide_program name)
  if(COLLIDE_ALL_CUDA)
    collide_cuda_program(${name} ${ARGN})
  else()
    collide_host_program(${name} ${ARGN})
  endif()
endfunction()

# What programs link whose ranks can be processes: see examples/io/on_ranks.hpp.
set(COLLIDE_PROCESSES)
if(TARGET collide::mpi)
  list(APPEND COLLIDE_PROCESSES collide::mpi)
  if(TARGET collide::nccl AND COLLIDE_CUDA)
    list(APPEND COLLIDE_PROCESSES collide::nccl)
  endif()
endif()
