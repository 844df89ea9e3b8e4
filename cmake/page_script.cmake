# SPDX-License-Identifier: Apache-2.0
# What pages run, compiled in from the built file web/dist/offline.js: a build needs no Node.
function(sg_page_script target)
  set(script ${CMAKE_SOURCE_DIR}/web/dist/offline.js)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${script})
  file(READ ${script} text HEX)
  string(LENGTH "${text}" digits)
  math(EXPR count "${digits} / 2")
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${text}")
  string(REGEX REPLACE "(................................................................................)" "\\1\n" bytes "${bytes}")
  file(WRITE ${CMAKE_BINARY_DIR}/page_script.new
       "#include \"pipeline/offline/page_script.h\"\nnamespace sg::offline {\nnamespace {\nconst unsigned char script[] = {\n${bytes}0};\n}\n"
       "const char* page_script() { return reinterpret_cast<const char*>(script); }\n}\n")
  configure_file(${CMAKE_BINARY_DIR}/page_script.new ${CMAKE_BINARY_DIR}/page_script.cpp COPYONLY)
  target_sources(${target} PRIVATE ${CMAKE_BINARY_DIR}/page_script.cpp)
endfunction()
