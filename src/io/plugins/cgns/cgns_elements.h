// SPDX-License-Identifier: Apache-2.0
// The elements of an unstructured CGNS zone. Source: the CGNS Standard Interface Data Structures (SIDS), "Elements_t".
#pragma once
#include "data/mesh.h"
#include "io/plugins/cgns/cg_file.h"

namespace sg::cg {

/// Cells of the highest dimension up to `cell_dimension` of all sections, in the order of their element numbers. Faces that are
/// not there throw Error(data); point ids are left to validate(). `version` is that of the file (3.0 numbers the types otherwise).
/// Empty when the zone has no sections.
UnstructuredMesh zone_cells(const CgFile& file, const std::vector<Node>& zone, int cell_dimension, double version);

}  // namespace sg::cg
