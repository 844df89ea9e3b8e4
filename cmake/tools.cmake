# SPDX-License-Identifier: Apache-2.0
# ccache and mold where they are installed; neither is needed, -DSG_CCACHE=OFF does without.
find_program(SG_CCACHE ccache)
if(SG_CCACHE)
  # CCACHE_DEPEND: results are found by the text of the headers, never by the preprocessed text. GCC knows a header of "#pragma once" again by
  # a sum of its text, which a precompiled header holds: one from before a comment was changed has the same preprocessed text, another sum.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
      CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 CCACHE_PCH_EXTSUM=1 CCACHE_DEPEND=1 ${SG_CCACHE})
  # The precompiled headers differ in every build folder, though their content does not: ccache is told what they stand for, which is the
  # text of all headers that they may include. CMake runs again when one of them changes, before anything is compiled.
  foreach(target IN ITEMS sg_base sg_data sg_plain_pch sg_quick_pch sg_test_support sg_bare_test)
    set(queue ${CMAKE_SOURCE_DIR}/src/base/pch.h)
    if(target MATCHES "sg_data|_pch")
      set(queue ${CMAKE_SOURCE_DIR}/cmake/data_pch.h)
    elseif(target MATCHES "test")
      set(queue ${CMAKE_SOURCE_DIR}/cmake/test_pch.h)
    endif()
    set(pch_text)
    while(queue)
      list(POP_FRONT queue header)
      if(NOT header IN_LIST pch_text AND EXISTS ${header})
        list(APPEND pch_text ${header})
        file(STRINGS ${header} includes REGEX "^#include \"")
        foreach(include IN LISTS includes)
          string(REGEX REPLACE ".*\"(.*)\".*" "\\1" include "${include}")
          list(APPEND queue ${CMAKE_SOURCE_DIR}/src/${include} ${CMAKE_SOURCE_DIR}/tests/${include} ${CMAKE_SOURCE_DIR}/cmake/${include})
        endforeach()
      endif()
    endwhile()
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${pch_text})
    set(pch_sum "${target} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_BUILD_TYPE} ${SG_SANITIZE}\n")
    foreach(header IN LISTS pch_text)
      file(SHA256 ${header} sum)
      string(APPEND pch_sum "${sum}\n")
    endforeach()
    file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/CMakeFiles/${target}.dir/cmake_pch.hxx.gch.sum CONTENT "${pch_sum}" @ONLY)
  endforeach()
  add_compile_options($<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endif()
find_program(SG_MOLD mold)
if(SG_MOLD)
  add_link_options(-fuse-ld=mold)
endif()
