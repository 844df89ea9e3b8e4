// SPDX-License-Identifier: Apache-2.0
// A first look at a file, in a process that may crash on it.
#pragma once
#include <string>

namespace sg::h5 {

/// Opens the objects of a file (the first 5000) with their attributes, types, shapes and layouts in a child process, once for each state of
/// the file. Throws Error(data) when the child dies: HDF5 1.10 trusts lengths in the headers of objects and attributes.
void probe(const std::string& path);

}  // namespace sg::h5
