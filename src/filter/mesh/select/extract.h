// SPDX-License-Identifier: Apache-2.0
// Some cells of a mesh as a mesh of their own.
#pragma once
#include <span>
#include <string_view>

#include "base/huge_allocator.h"
#include "data/dataset.h"

namespace sg {

/// The cells of the list (ascending), their points in input order, all fields and ghosts. A SurfaceMesh stays one and a PointCloud
/// stays one (its "cells" are its points); every other kind becomes an UnstructuredMesh: lattices of voxels, pixels (hexahedra, quads
/// where they are curvilinear or turned), lines, vertices, AMR of voxels or pixels; polyhedra keep their faces. `who` names the operation
/// in errors.
DatasetPtr extract_cells(const DatasetPtr& in, std::span<const int64_t> cells, std::string_view who);

/// The same for cells whose byte is not zero: one byte a cell.
DatasetPtr extract_marked(const DatasetPtr& in, const std::vector<uint8_t>& keep, std::string_view who);
/// The same for a lattice of three axes with a bit a cell, in rows as lattice_cells.h has them.
DatasetPtr extract_lattice_cells(const DatasetPtr& in, const Plane<uint64_t>& cells, std::string_view who);

}  // namespace sg
