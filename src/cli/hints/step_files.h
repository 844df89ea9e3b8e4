// SPDX-License-Identifier: Apache-2.0
// Files of one name but for numbers, as a shell makes them of a pattern without quotes: most likely the steps of one series.
#pragma once
#include <string>
#include <vector>

namespace sg {

/// How to name these files as one series, for a message: "'run/flow_{n}.vtk' in quotes, or --series FILES...", without the pattern where it
/// would take other files as well. "" where fewer than three are given or their names differ by more than numbers.
std::string as_series(const std::vector<std::string>& paths);

}  // namespace sg
