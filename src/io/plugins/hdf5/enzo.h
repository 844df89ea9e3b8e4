// SPDX-License-Identifier: Apache-2.0
// ENZO output: the text files that describe grids (NAME.hierarchy) and parameters (NAME). Format: ENZO user guide, "Enzo output formats".
#pragma once
#include <map>

#include "data/dataset.h"

namespace sg {

/// One grid of the hierarchy.
struct EnzoGrid {
  int number = 0;  ///< as the file counts, from 1
  int level = 0;
  std::array<long long, 3> dims{1, 1, 1}, start{0, 0, 0}, end{0, 0, 0};  ///< with ghost zones; the grid's own cells are start..end
  Vec3 left, right;
  std::string file;  ///< name of its HDF5 file, without folder; "" when it has no fields

  std::array<size_t, 3> cells() const {
    return {size_t(end[0] - start[0] + 1), size_t(end[1] - start[1] + 1), size_t(end[2] - start[2] + 1)};
  }
};

struct EnzoHierarchy {
  int rank = 3;
  std::optional<double> time;
  std::vector<EnzoGrid> grids;  ///< level by level, in the file's order within a level
  size_t particles = 0;
};

/// Throws Error(data) naming line or grid: missing entries, levels that run in circles.
EnzoHierarchy parse_enzo_hierarchy(std::string_view text, const std::string& path);

/// Factors to CGS units that the parameter file (in text) gives, by field name.
std::map<std::string, double> enzo_factors(std::string_view text);

Data read_enzo(const std::string& path, const struct ReadOptions& options, class Context& context);
std::vector<double> times_of_enzo(const std::string& path, const struct ReadOptions& options, class Context& context);

}  // namespace sg
