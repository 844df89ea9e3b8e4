# SPDX-License-Identifier: Apache-2.0
# The Python package: build/python/sightglass holds the module _core and links to the sources of src/python/sightglass. Only where Python and
# pybind11 are installed (packages-python.txt).
if(NOT Python_EXECUTABLE AND EXISTS /usr/bin/python3)  # the one whose packages packages-python.txt lists, whatever else is on the path
  set(Python_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "Python that the package sightglass is built for")
endif()
find_package(Python COMPONENTS Interpreter Development.Module QUIET)
if(Python_FOUND)
  set(PYBIND11_FINDPYTHON ON)
  find_package(pybind11 CONFIG QUIET)
endif()
if(NOT pybind11_FOUND)
  return()
endif()

file(GLOB python_core CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/python/core/*.cpp)
sg_joined(python_core ${python_core})
set(python_package ${CMAKE_BINARY_DIR}/python/sightglass)
pybind11_add_module(sightglass_python MODULE NO_EXTRAS ${python_core})
target_include_directories(sightglass_python PRIVATE ${CMAKE_SOURCE_DIR}/src)
target_link_libraries(sightglass_python PRIVATE libsightglass)
target_compile_definitions(sightglass_python PRIVATE SIGHTGLASS_NO_SHORT_NAME)
sg_level(sightglass_python quick)
set_target_properties(sightglass_python PROPERTIES OUTPUT_NAME _core LIBRARY_OUTPUT_DIRECTORY ${python_package})

# Editors and type checkers read the operations from stubs.
add_custom_command(TARGET sightglass_python POST_BUILD COMMAND ${Python_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tools/python_stubs ${CMAKE_BINARY_DIR}/python
                   VERBATIM)

file(GLOB python_sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/python/sightglass/*)
file(MAKE_DIRECTORY ${python_package})
foreach(source IN LISTS python_sources)
  get_filename_component(name ${source} NAME)
  if(NOT name STREQUAL "__pycache__")
    file(CREATE_LINK ${source} ${python_package}/${name} SYMBOLIC)
  endif()
endforeach()
