// SPDX-License-Identifier: Apache-2.0
// One zone of a CGNS file as a dataset. Source: CGNS SIDS, "Zone_t", "GridCoordinates_t", "FlowSolution_t", "Rind_t".
#pragma once
#include "base/context.h"
#include "io/io.h"
#include "io/plugins/cgns/cg_file.h"

namespace sg::cg {

struct Base {
  Node node;
  int cell_dimension = 3, physical_dimension = 3;
  double version = 0;  ///< of the file
  size_t step = 0;
  std::optional<double> time;
  bool has_steps = false;
  std::vector<std::pair<std::string, std::string>> notes;
};

/// Structured zones become curvilinear grids, others unstructured meshes. Rind planes are cut away. Fields of all solutions, or of the
/// one that ZoneIterativeData names for the step; components X Y Z become vectors.
DatasetPtr read_zone(const CgFile& file, const Base& base, const Node& zone, const ReadOptions& options, Context& context);

}  // namespace sg::cg
