// SPDX-License-Identifier: Apache-2.0
// A file for each step, and an index that names them with their times: "flow_{n}.vtu" gets "flow.vtu.series", as ParaView reads it; a .pvd
// has its files in a folder beside.
#pragma once
#include "io/steps/steps.h"

namespace sg {

/// Whether {n} is in the file's name.
bool is_numbered(const std::string& path);
/// The name of the index of numbered files.
std::string index_of_numbered(const std::string& path);
std::unique_ptr<StepsWriter> write_numbered_steps(const std::string& path, StepsPlan plan, const WriteOptions& options, Context& context);

}  // namespace sg
