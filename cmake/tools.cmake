# SPDX-License-Identifier: Apache-2.0
# ccache and mold where they are installed; neither is needed.
find_program(SG_CCACHE ccache)
if(SG_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
      CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 CCACHE_PCH_EXTSUM=1 ${SG_CCACHE})
  # The precompiled header differs in every build folder, though its content does not: ccache is told what it stands for.
  file(SHA256 ${CMAKE_SOURCE_DIR}/src/base/pch.h pch_sum)
  file(WRITE ${CMAKE_BINARY_DIR}/CMakeFiles/sg_base.dir/cmake_pch.hxx.gch.sum
       "${pch_sum} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_BUILD_TYPE} ${SG_SANITIZE}\n")
  add_compile_options($<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endif()
find_program(SG_MOLD mold)
if(SG_MOLD)
  add_link_options(-fuse-ld=mold)
endif()
