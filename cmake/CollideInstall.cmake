# What `cmake --install` installs, and what find_package(collide) finds there. Two components: `headers`, the library, and
# `compiled`, collide::compiled where COLLIDE_INSTALL_COMPILED is ON.

include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_DATADIR}/cmake/collide)
install(DIRECTORY include/collide DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT headers)
install(TARGETS collide collide_cuda EXPORT collide-targets COMPONENT headers)
install(EXPORT collide-targets NAMESPACE collide:: DESTINATION ${package_dir} COMPONENT headers)
configure_package_config_file(cmake/collide-config.cmake.in collide-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(collide-config-version.cmake COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/collide-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/collide-config-version.cmake
              cmake/CollideOpenMP.cmake cmake/CollideMpi.cmake cmake/CollideNccl.cmake cmake/CollideBuildType.cmake
        DESTINATION ${package_dir}
        COMPONENT headers)

if(COLLIDE_INSTALL_COMPILED)
  set_target_properties(collide_compiled PROPERTIES EXCLUDE_FROM_ALL OFF EXPORT_NAME compiled)
  install(TARGETS collide_compiled EXPORT collide-compiled-targets ARCHIVE COMPONENT compiled)
  install(EXPORT collide-compiled-targets NAMESPACE collide:: DESTINATION ${package_dir} COMPONENT compiled)
endif()
