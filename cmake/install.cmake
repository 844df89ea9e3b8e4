# SPDX-License-Identifier: Apache-2.0
# The library for C++ programs, and what `cmake --install` puts where: program, plug-ins, library, headers, packages for CMake and
# pkg-config, man page, completions. Everything finds everything else relative to itself, so an installed tree may be moved.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# One shared library with the facade alone to see. Before version 1 every minor version has an ABI of its own.
add_library(libsightglass SHARED $<TARGET_OBJECTS:sg_api>)
target_link_libraries(libsightglass PRIVATE sg_api)
target_link_options(libsightglass PRIVATE -Wl,--as-needed -Wl,--gc-sections -Wl,--exclude-libs,ALL -Wl,--no-undefined
                    -Wl,--version-script=${CMAKE_SOURCE_DIR}/src/api/exports.map)
set_target_properties(libsightglass PROPERTIES OUTPUT_NAME sightglass VERSION ${PROJECT_VERSION}
                      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} LINK_DEPENDS ${CMAKE_SOURCE_DIR}/src/api/exports.map)
get_property(plugins GLOBAL PROPERTY SG_PLUGINS)
if(plugins)
  add_dependencies(libsightglass ${plugins})
endif()

# What the program tells of itself: never older than the program. sg_told(FILE WORDS...)
function(sg_told file)
  set(made ${CMAKE_BINARY_DIR}/told/${file})
  get_filename_component(folder ${made} DIRECTORY)
  file(MAKE_DIRECTORY ${folder})
  add_custom_command(OUTPUT ${made} COMMAND sightglass ${ARGN} > ${made} DEPENDS sightglass VERBATIM)
  set_property(GLOBAL APPEND PROPERTY SG_TOLD ${made})
endfunction()
sg_told(sightglass.1 man)
sg_told(operations.h ops --cpp)
sg_told(completions/sightglass completions bash)
sg_told(completions/_sightglass completions zsh)
sg_told(completions/sightglass.fish completions fish)
get_property(told GLOBAL PROPERTY SG_TOLD)
add_custom_target(sightglass_told ALL DEPENDS ${told})

install(TARGETS sightglass RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS libsightglass LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(plugins)
  install(TARGETS ${plugins} LIBRARY DESTINATION lib/sightglass)  # where src/io/plugin.cpp looks
endif()
install(FILES src/api/sightglass.h ${CMAKE_BINARY_DIR}/told/operations.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sightglass)

# The packages for CMake and pkg-config, with paths relative to themselves.
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/sightglass)
configure_package_config_file(cmake/sightglassConfig.cmake.in ${CMAKE_BINARY_DIR}/package/sightglassConfig.cmake
                              INSTALL_DESTINATION ${package_dir} PATH_VARS CMAKE_INSTALL_LIBDIR CMAKE_INSTALL_INCLUDEDIR)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/sightglassConfigVersion.cmake COMPATIBILITY SameMinorVersion)
file(RELATIVE_PATH pc_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" pc_prefix ${pc_prefix})
configure_file(cmake/sightglass.pc.in ${CMAKE_BINARY_DIR}/package/sightglass.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/package/sightglassConfig.cmake ${CMAKE_BINARY_DIR}/package/sightglassConfigVersion.cmake
        DESTINATION ${package_dir})
install(FILES ${CMAKE_BINARY_DIR}/package/sightglass.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

install(FILES ${CMAKE_BINARY_DIR}/told/sightglass.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${CMAKE_BINARY_DIR}/told/completions/sightglass DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${CMAKE_BINARY_DIR}/told/completions/_sightglass DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
install(FILES ${CMAKE_BINARY_DIR}/told/completions/sightglass.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
# The README of the program alone: nothing of building, and commands as they are typed where it is installed.
file(READ README.md readme)
string(REGEX REPLACE "!\\[[^\n]*\n\n" "" readme "${readme}")
string(REGEX REPLACE "## Quick start.*## Examples" "## Examples" readme "${readme}")
string(REGEX REPLACE "`\\./run package`[^:]*contain the program" "The package contains the program" readme "${readme}")
string(REGEX REPLACE "## Speed.*## Licence" "## Licence" readme "${readme}")
string(REGEX REPLACE "## Python\n.*## Install, and use from C\\+\\+" "## Use from C++" readme "${readme}")
string(REGEX REPLACE "\\| Python \\|[^\n]*\n" "" readme "${readme}")
string(REGEX REPLACE " `HACKING.md`[^\n]*" "" readme "${readme}")
string(REGEX REPLACE "; those in `examples/real/`[^)]*" "" readme "${readme}")
string(REPLACE "./run " "sightglass " readme "${readme}")
file(WRITE ${CMAKE_BINARY_DIR}/package/README.md "${readme}")
install(FILES ${CMAKE_BINARY_DIR}/package/README.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES docs/coming_from.md docs/security.md docs/limits.md docs/words.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs)  # the README names them
file(GLOB example_files CONFIGURE_DEPENDS examples/*.yaml)
install(FILES ${example_files} DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)
install(DIRECTORY examples/cpp DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)
