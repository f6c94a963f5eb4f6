# `cpack` in the build folder makes libcollide-dev_VERSION_ARCHITECTURE.deb: the headers, collide::compiled, and the package files of CMake.

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME libcollide-dev)
file(READ packaging/identity.json identity)
foreach(part IN ITEMS authors contact documentation)
  string(JSON identity_${part} GET "${identity}" ${part})
endforeach()
set(CPACK_PACKAGE_VENDOR "${identity_authors}")
set(CPACK_PACKAGE_CONTACT "${identity_authors} <${identity_contact}>")
set(CPACK_PACKAGE_HOMEPAGE_URL "${identity_documentation}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "collision detection between a triangle mesh and very many spheres")
set(CPACK_PACKAGE_DESCRIPTION
    "A C++17 library of headers, and some of it compiled. It finds every pair of a sphere and a
triangle that touch, on CPUs and NVIDIA GPUs, with the results of
exact arithmetic, and simulates particles that collide with a mesh.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES OFF)

set(CPACK_COMPONENTS_ALL headers debian_doc)
if(COLLIDE_INSTALL_COMPILED)
  list(APPEND CPACK_COMPONENTS_ALL compiled)
endif()
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
if(NOT COLLIDE_INSTALL_COMPILED)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE all)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4)")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "cmake (>= 3.25), nvidia-cuda-toolkit (>= 12), libassimp-dev, nlohmann-json3-dev")

# Debian wants these of every package; no other install has them.
set(debian_doc ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_PACKAGE_NAME})
install(FILES LICENSE DESTINATION ${debian_doc} RENAME copyright COMPONENT debian_doc EXCLUDE_FROM_ALL)
install(FILES CHANGELOG.md DESTINATION ${debian_doc} COMPONENT debian_doc EXCLUDE_FROM_ALL)
find_program(COLLIDE_GZIP gzip)
mark_as_advanced(COLLIDE_GZIP)
if(COLLIDE_GZIP)
  string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
  file(CONFIGURE OUTPUT changelog @ONLY NEWLINE_STYLE UNIX CONTENT
       "@CPACK_PACKAGE_NAME@ (@PROJECT_VERSION@) unstable; urgency=medium

  * CHANGELOG.md says what is new.

 -- @CPACK_PACKAGE_CONTACT@  @date@
")
  execute_process(COMMAND ${COLLIDE_GZIP} -9nkf ${CMAKE_CURRENT_BINARY_DIR}/changelog COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz DESTINATION ${debian_doc} COMPONENT debian_doc EXCLUDE_FROM_ALL)
endif()

include(CPack)
