# SPDX-License-Identifier: Apache-2.0
# The built files of the window inside the program: the assembler takes their bytes as they are, so that nothing but CMake is needed.

# sg_page(TARGET): adds embedded_files() of src/serve/page/page_files.h to TARGET.
function(sg_page target)
  set(folder ${CMAKE_SOURCE_DIR}/web/dist/window)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS ${folder}/*)
  list(FILTER files EXCLUDE REGEX "\\.map$")  # for debuggers, larger than all else
  if(NOT EXISTS ${folder}/index.html)
    set(folder ${CMAKE_SOURCE_DIR}/src/serve/page)
    set(files ${folder}/missing.html)
  endif()
  list(SORT files)
  set(bytes)
  set(sums)
  set(declared)
  set(rows)
  set(number 0)
  foreach(file IN LISTS files)
    file(RELATIVE_PATH name ${folder} ${file})
    string(REPLACE "missing.html" "index.html" name ${name})
    string(APPEND bytes "    \"sg_page_${number}: .incbin \\\"${file}\\\"\\nsg_page_${number}_end: .byte 0\\n\"\n")
    file(SHA256 ${file} sum)
    string(APPEND sums "// ${sum}\n")
    string(APPEND declared "extern const char sg_page_${number}[], sg_page_${number}_end[];\n")
    string(APPEND rows "      {\"${name}\", {sg_page_${number}, size_t(sg_page_${number}_end - sg_page_${number})}},\n")
    math(EXPR number "${number} + 1")
  endforeach()
  set(made ${CMAKE_BINARY_DIR}/page/embedded_files.cpp)
  file(CONFIGURE OUTPUT ${made} @ONLY CONTENT "// SPDX-License-Identifier: Apache-2.0
// Made by cmake/page.cmake, of files with these sums:
@sums@#include \"serve/page/page_files.h\"

asm(\".pushsection .rodata\\n\"
@bytes@    \".popsection\\n\");
extern \"C\" {
@declared@}

namespace sg::serve {

std::span<const EmbeddedFile> embedded_files() {
  static const EmbeddedFile files[] = {
@rows@  };
  return files;
}

}  // namespace sg::serve
")
  # The files are no headers: nothing else tells that they are needed. ccache knows them by their sums in the text.
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${files})
  set_source_files_properties(${made} PROPERTIES OBJECT_DEPENDS "${files}" SKIP_PRECOMPILE_HEADERS ON
                              TARGET_DIRECTORY ${target})
  target_sources(${target} PRIVATE ${made})
endfunction()
