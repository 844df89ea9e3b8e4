// SPDX-License-Identifier: Apache-2.0
// Operations, ways to show and settings as C++ structs, for programs that use the library.
#pragma once
#include <string>

namespace sg {

/// The text of sightglass/operations.h: a struct per source and operation (sightglass::ops), per way to show (sightglass::shows), and for
/// camera, picture and film (sightglass::settings), each with its parameters as members and what is not the default as Params.
std::string cpp_header();

}  // namespace sg
