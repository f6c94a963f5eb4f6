# COLLIDE_CUDA: compile tests, programs and benchmarks as CUDA. ON by default where a CUDA compiler works; a toolkit
# without a compiler, or a broken one, leaves the host build as it is.
# COLLIDE_ALL_CUDA: all of them. OFF by default in a quick build where there is no GPU, which could run none: there
# programs for host and device are compiled as C++, except some (collide_cuda_program), and unit_cuda and pairs_cuda are
# compiled to PTX and not linked, of their compositions only float with exact.

if(NOT DEFINED COLLIDE_CUDA)
  include(CheckLanguage)
  check_language(CUDA)
endif()
if(CMAKE_CUDA_COMPILER)
  set(cuda_found ON)
else()
  set(cuda_found OFF)
endif()
option(COLLIDE_CUDA "Compile tests, programs and benchmarks as CUDA" ${cuda_found})

execute_process(COMMAND nvidia-smi -L RESULT_VARIABLE no_gpu OUTPUT_QUIET ERROR_QUIET)
set(all_cuda ON)
if(COLLIDE_QUICK_BUILD AND no_gpu)
  set(all_cuda OFF)
endif()
option(COLLIDE_ALL_CUDA "Compile all that is for CUDA, where COLLIDE_CUDA is ON; OFF: some of it, as no GPU is here to run it" ${all_cuda})

if(COLLIDE_CUDA)
  if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES AND NOT DEFINED ENV{CUDAARCHS})
    if(no_gpu)
      set(CMAKE_CUDA_ARCHITECTURES 90)
    else()
      set(CMAKE_CUDA_ARCHITECTURES native)
    endif()
  endif()
  enable_language(CUDA)
  message(STATUS "CUDA: ${CMAKE_CUDA_COMPILER} for ${CMAKE_CUDA_ARCHITECTURES}")
elseif(DEFINED CMAKE_CUDA_COMPILER AND NOT CMAKE_CUDA_COMPILER)
  collide_missing("a CUDA compiler")
endif()
