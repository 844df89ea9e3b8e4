# SPDX-License-Identifier: Apache-2.0
# The packets of rays hold most of the compile time of rendering: each file is compiled once for floats and once for small integers, as an object library.

# sg_packets(TARGET): takes the files out of the fast sources of TARGET and links their objects into it.
function(sg_packets target)
  set(files)
  foreach(name IN ITEMS tolerance uneven detail march)
    list(APPEND files ${CMAKE_SOURCE_DIR}/src/render/volume/engines/packets/packets_${name}.cpp)
  endforeach()
  get_target_property(sources ${target}_fast SOURCES)
  list(REMOVE_ITEM sources ${files})
  set_target_properties(${target}_fast PROPERTIES SOURCES "${sources}")
  foreach(samples IN ITEMS SmallInteger float)
    set(name ${target}_${samples})
    add_library(${name} OBJECT ${files})
    target_compile_definitions(${name} PRIVATE SG_SAMPLES=${samples})
    target_link_libraries(${name} PRIVATE sg_scene sg_image sg_index PkgConfig::libhwy)
    sg_use_pch(${name})
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:${name}>)
  endforeach()
endfunction()
