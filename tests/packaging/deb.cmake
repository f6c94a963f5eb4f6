# cmake -D SOURCE=... -D BUILD=... -D FOLDER=... -D GENERATOR=... -D CXX=... -P deb.cmake
#
# Makes the package for Debian of what is built in BUILD, looks at what it says of itself, unpacks it into a folder, as dpkg would into the root, and
# compiles the README's program with it.

function(run result)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
  set(${result} "${output}" PARENT_SCOPE)
endfunction()

function(expect text pattern)
  if(NOT text MATCHES "${pattern}")
    message(FATAL_ERROR "expected ${pattern}, got\n${text}")
  endif()
endfunction()

file(REMOVE_RECURSE ${FOLDER})
cmake_path(GET CMAKE_COMMAND PARENT_PATH programs)
run(said ${programs}/cpack --config ${BUILD}/CPackConfig.cmake -B ${FOLDER})
file(GLOB package ${FOLDER}/*.deb)
include(${SOURCE}/cmake/CollideVersion.cmake)
collide_read_version(version)
run(architecture dpkg --print-architecture)
string(STRIP "${architecture}" architecture)
expect("${package}" "/libcollide-dev_${version}_${architecture}\\.deb$")

run(said dpkg-deb --field ${package})
foreach(field IN ITEMS "Package: libcollide-dev\n" "Version: ${version}\n" "Architecture: ${architecture}\n" "Depends: libeigen3-dev [^\n]*\n"
                       "Section: libdevel\n" "Maintainer: [^\n]+ <[^\n]+>\n" "Description: [a-z][^\n]*\n [^\n]*\n")
  expect("\n${said}" "\n${field}")
endforeach()

run(said dpkg-deb --extract ${package} ${FOLDER}/root)
foreach(file IN ITEMS include/collide/core/version.hpp lib/libcollide_compiled.a share/doc/libcollide-dev/copyright share/doc/libcollide-dev/changelog.gz)
  if(NOT EXISTS ${FOLDER}/root/usr/${file})
    message(FATAL_ERROR "the package has no ${file}")
  endif()
endforeach()
run(said ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/readme -B ${FOLDER}/readme -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX}
    -DCMAKE_PREFIX_PATH=${FOLDER}/root/usr -DREADME=${SOURCE}/README.md)
run(said ${CMAKE_COMMAND} --build ${FOLDER}/readme)
run(said ${FOLDER}/readme/readme)
expect("${said}" "^sphere 0 touches triangle 0\n$")
