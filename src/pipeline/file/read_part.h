// SPDX-License-Identifier: Apache-2.0
// Reading only the part of a file that a request needs.
#pragma once
#include "io/io.h"
#include "pipeline/graph/request.h"

namespace sg {

/// read_data, but: a region of space becomes an index region where the format reads one and the mesh is an axis-parallel grid;
/// pieces are cut behind formats that have none of their own.
Data read_part(const std::string& path, ReadOptions options, const Request& request, Context& context);

/// The points of a uniform (unturned) or rectilinear grid that hold every cell meeting `box`; nothing for other meshes.
std::optional<LatticeRegion> lattice_region(const Mesh& mesh, const Box3& box);

}  // namespace sg
