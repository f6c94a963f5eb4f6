# collide::mpi: what collide/ranks/mpi.hpp needs, for programs whose ranks are processes of MPI. An installed package includes this
# file too, for find_package(collide COMPONENTS mpi), as what is found is a matter of the machine that compiles.

# collide_try_mpi(RESULT): whether CMake finds an MPI with which a program compiles and links. A CMake of its own tries: FindMPI
# stops the build where it finds the commands of an MPI without its headers, or a wrapper that prints nonsense.
function(collide_try_mpi result)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/collide_mpi)
  file(REMOVE_RECURSE ${folder})
  file(WRITE ${folder}/main.cpp "#include <mpi.h>\nint main(int n, char** a) { return MPI_Init(&n, &a); }\n")
  file(WRITE ${folder}/CMakeLists.txt
       "cmake_minimum_required(VERSION 3.25)\nproject(collide_mpi LANGUAGES CXX)\nset(MPI_CXX_SKIP_MPICXX ON)\n"
       "find_package(MPI REQUIRED COMPONENTS CXX)\nadd_executable(main main.cpp)\ntarget_link_libraries(main PRIVATE MPI::MPI_CXX)\n")
  set(names CMAKE_CXX_COMPILER CMAKE_CXX_FLAGS CMAKE_EXE_LINKER_FLAGS CMAKE_PREFIX_PATH CMAKE_FIND_ROOT_PATH CMAKE_SYSROOT
            CMAKE_MAKE_PROGRAM CMAKE_TOOLCHAIN_FILE)
  get_cmake_property(hints CACHE_VARIABLES)
  list(FILTER hints INCLUDE REGEX "^MPI_|^MPIEXEC_")
  foreach(name IN LISTS names hints)
    if(NOT "${${name}}" STREQUAL "")
      file(APPEND ${folder}/cache.cmake "set(${name} [==[${${name}}]==] CACHE STRING \"\")\n")
    endif()
  endforeach()
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${folder} -B ${folder}/build -G ${CMAKE_GENERATOR} -C ${folder}/cache.cmake
                  RESULT_VARIABLE failed TIMEOUT 120 OUTPUT_FILE ${folder}/log ERROR_FILE ${folder}/log)
  if(NOT failed)
    execute_process(COMMAND ${CMAKE_COMMAND} --build ${folder}/build
                    RESULT_VARIABLE failed TIMEOUT 120 OUTPUT_FILE ${folder}/log ERROR_FILE ${folder}/log)
  endif()
  set(${result} ON PARENT_SCOPE)
  if(failed)
    set(${result} OFF PARENT_SCOPE)
  endif()
endfunction()

# collide_find_mpi(): makes the target collide::mpi where CMake finds an MPI that works.
function(collide_find_mpi)
  if(TARGET collide::mpi)
    return()
  endif()
  set(works ${COLLIDE_MPI_WORKS})
  foreach(path IN LISTS COLLIDE_MPI_PATHS)
    if(NOT EXISTS ${path})  # any more
      set(works OFF)
    endif()
  endforeach()
  if(NOT works)
    collide_try_mpi(works)
    set(COLLIDE_MPI_WORKS ${works} CACHE INTERNAL "A program with MPI compiles and links")
  endif()
  if(NOT works)
    return()
  endif()
  set(MPI_CXX_SKIP_MPICXX ON)  # the C interface is all that it takes
  set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)
  find_package(MPI QUIET COMPONENTS CXX)
  if(MPI_CXX_FOUND)
    set(COLLIDE_MPI_PATHS ${MPI_CXX_INCLUDE_DIRS} ${MPI_CXX_LIBRARIES} CACHE INTERNAL "What there must be of it")
    add_library(collide::mpi INTERFACE IMPORTED GLOBAL)
    target_link_libraries(collide::mpi INTERFACE collide::collide MPI::MPI_CXX)
    target_compile_definitions(collide::mpi INTERFACE COLLIDE_HAS_MPI)  # for programs that run with MPI and without
  endif()
endfunction()
