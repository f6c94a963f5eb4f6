# A project without a build type is compiled without optimisation, which takes many times as long. An installed package
# includes this file too.

# collide_note_build_type(): says so once, in one line.
function(collide_note_build_type)
  get_property(several GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
  get_property(said GLOBAL PROPERTY COLLIDE_NOTED_BUILD_TYPE)
  if(CMAKE_BUILD_TYPE OR several OR said OR collide_FIND_QUIETLY OR CMAKE_CXX_FLAGS MATCHES "(^| )-O")
    return()
  endif()
  set_property(GLOBAL PROPERTY COLLIDE_NOTED_BUILD_TYPE ON)
  message(STATUS "collide: CMAKE_BUILD_TYPE is empty, so nothing is optimised: configure with -DCMAKE_BUILD_TYPE=Release")
endfunction()
