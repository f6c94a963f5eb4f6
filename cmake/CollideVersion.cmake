# collide_read_version(RESULT): the version in include/collide/core/version.hpp, as 1.2.3.
function(collide_read_version result)
  file(STRINGS ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../include/collide/core/version.hpp lines
       REGEX "^#define COLLIDE_VERSION_(MAJOR|MINOR|PATCH) [0-9]+$")
  list(TRANSFORM lines REPLACE ".* " "")
  list(JOIN lines "." version)
  if(NOT version MATCHES "^[0-9]+\\.[0-9]+\\.[0-9]+$")
    message(FATAL_ERROR "include/collide/core/version.hpp does not give the version in three lines: ${version}")
  endif()
  set(${result} ${version} PARENT_SCOPE)
endfunction()
