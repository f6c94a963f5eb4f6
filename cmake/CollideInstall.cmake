# What `cmake --install` installs, and what find_package(collide) finds there. Three components: `headers`, the library, and
# where COLLIDE_INSTALL_COMPILED is ON `compiled`, collide::compiled, and with COLLIDE_CUDA `compiled_cuda`.

include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_DATADIR}/cmake/collide)
install(DIRECTORY include/collide DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT headers)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/licenses/collide COMPONENT headers)
install(TARGETS collide collide_cuda EXPORT collide-targets COMPONENT headers)
install(EXPORT collide-targets NAMESPACE collide:: DESTINATION ${package_dir} COMPONENT headers)
set(collide_with_openmp OFF)
if(COLLIDE_OPENMP AND OpenMP_CXX_FOUND)
  set(collide_with_openmp ON)
endif()
configure_package_config_file(cmake/collide-config.cmake.in collide-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(collide-config-version.cmake COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/collide-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/collide-config-version.cmake
              cmake/CollideOpenMP.cmake cmake/CollideMpi.cmake cmake/CollideNccl.cmake cmake/CollideBuildType.cmake
        DESTINATION ${package_dir}
        COMPONENT headers)

if(COLLIDE_INSTALL_COMPILED AND NOT COLLIDE_COMPILED_LIBRARY)
  set(compiled_parts compiled)
  if(COLLIDE_CUDA)
    list(APPEND compiled_parts compiled_cuda)
  endif()
  foreach(part IN LISTS compiled_parts)
    set_target_properties(collide_${part} PROPERTIES EXCLUDE_FROM_ALL OFF)
    install(TARGETS collide_${part} EXPORT collide-${part}-targets ARCHIVE COMPONENT ${part})
    install(EXPORT collide-${part}-targets FILE collide-${part}-targets.cmake NAMESPACE collide:: DESTINATION ${package_dir} COMPONENT ${part})
  endforeach()
endif()
