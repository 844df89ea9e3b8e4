// SPDX-License-Identifier: Apache-2.0
// Files that name the steps of a series and their times: ParaView's .series (JSON) and .pvd (XML).
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace sg {

struct SeriesIndex {
  std::vector<std::pair<std::string, double>> files;  ///< relative to the index, with their times
  std::string recipe;                                 ///< see StepsPlan; "" in files of others
};
/// Throws Error(data) for what is no index.
SeriesIndex read_series_index(const std::string& path);
/// By the extension of `path`.
void write_series_index(const std::string& path, const SeriesIndex& index);

}  // namespace sg
