# SPDX-License-Identifier: Apache-2.0
# cmake -DFILE=MODULE.so -P beside.cmake: the module looks for its libraries in its own folder instead of where it was built.
file(READ_ELF ${FILE} RUNPATH runpath RPATH rpath)
file(RPATH_CHANGE FILE ${FILE} OLD_RPATH "${runpath}${rpath}" NEW_RPATH "$ORIGIN")
