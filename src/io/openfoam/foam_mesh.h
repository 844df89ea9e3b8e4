// SPDX-License-Identifier: Apache-2.0
// The polyMesh of an OpenFOAM case: faces between an owner and a neighbour cell, and the cells that they make.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/context.h"
#include "data/mesh.h"

namespace sg::openfoam {

/// A run of boundary faces.
struct Patch {
  std::string name, type;
  size_t start = 0, count = 0;
  std::vector<std::string> groups;
};

struct Zone {
  std::string name;
  std::vector<int32_t> cells;
};

/// Faces point from owner to neighbour; those from neighbour.size() on lie on the boundary.
struct FoamMesh {
  Points points;
  std::vector<int64_t> face_begin;
  std::vector<int32_t> face_ids, owner, neighbour;
  size_t cells = 0;
  std::vector<Patch> patches;
  std::vector<Zone> zones;

  size_t faces() const { return owner.size(); }
  std::span<const int32_t> face(size_t f) const {
    return std::span(face_ids).subspan(size_t(face_begin[f]), size_t(face_begin[f + 1] - face_begin[f]));
  }
};

/// `find` gives the path of a file of the polyMesh ("points"), "" when there is none. Throws Error(data).
FoamMesh read_mesh(const std::function<std::string(const std::string&)>& find);

/// Hexahedra, wedges, pyramids and tetrahedra where the faces make one, else polyhedra. Parallel; the order of cells is kept.
UnstructuredMesh make_cells(const FoamMesh& mesh, Context& context);

/// The faces of a patch; `ids` gets the mesh points that its points are, ascending.
SurfaceMesh make_patch(const FoamMesh& mesh, const Patch& patch, std::vector<int64_t>& ids);

}  // namespace sg::openfoam
