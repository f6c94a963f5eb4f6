# collide::compiled: queries, and what simulations do without their effects, compiled once, for programs that link it; see
# include/collide/compiled.hpp. With COLLIDE_CUDA there is collide::compiled_cuda, which has those of the CUDA spaces, too.
# Both are built where something links them, and collide::compiled by default if this is the project that is built.

# compiled_source(RESULT TEMPLATE NAME): a source made of src/TEMPLATE.cpp.in, appended to the list RESULT
function(compiled_source result template name)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/compiled/${name}.cpp)
  configure_file(src/${template}.cpp.in ${source} @ONLY)
  set(${result} ${${result}} ${source} PARENT_SCOPE)
endfunction()

set(compiled_spaces host)
if(COLLIDE_CUDA)
  list(APPEND compiled_spaces cuda cuda_shared)
endif()
foreach(space IN LISTS compiled_spaces)
  set(of host_sources)
  if(NOT space STREQUAL "host")
    set(of cuda_sources)
  endif()
  foreach(scalar IN ITEMS float double)
    set(queries COLLIDE_ALL_AT_REST)
    compiled_source(${of} queries at_rest_${space}_${scalar})
    set(queries COLLIDE_ALL_IN_MOTION)
    compiled_source(${of} queries in_motion_${space}_${scalar})
    compiled_source(${of} lookups lookups_${space}_${scalar})
    if(space STREQUAL "host")  # on a device a step is one kernel
      compiled_source(${of} searches searches_${scalar})
    endif()
  endforeach()
endforeach()

add_library(collide_compiled STATIC EXCLUDE_FROM_ALL ${host_sources})
add_library(collide::compiled ALIAS collide_compiled)
set_target_properties(collide_compiled PROPERTIES EXPORT_NAME compiled)
target_link_libraries(collide_compiled PUBLIC collide)
target_compile_definitions(collide_compiled INTERFACE COLLIDE_COMPILED)
if(COLLIDE_QUICK_BUILD)
  target_compile_options(collide_compiled PRIVATE -O2)  # two thirds of the time that -O3 takes
endif()

if(COLLIDE_CUDA)
  set_source_files_properties(${cuda_sources} PROPERTIES LANGUAGE CUDA)
  add_library(collide_compiled_cuda STATIC EXCLUDE_FROM_ALL ${cuda_sources})
  add_library(collide::compiled_cuda ALIAS collide_compiled_cuda)
  set_target_properties(collide_compiled_cuda PROPERTIES EXPORT_NAME compiled_cuda)
  target_link_libraries(collide_compiled_cuda PUBLIC collide_cuda INTERFACE collide_compiled)
  target_compile_definitions(collide_compiled_cuda INTERFACE COLLIDE_COMPILED_CUDA)
endif()
