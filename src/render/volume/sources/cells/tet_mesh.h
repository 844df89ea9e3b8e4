// SPDX-License-Identifier: Apache-2.0
// TetMesh: the solid cells of any mesh as tetrahedra that know their neighbours; what rays walk through.
//
// Faces of more than three corners are cut by fans from their lowest point id, so that both cells of a face cut it alike: there are
// neither gaps nor overlaps. Where a fan is folded or has flat triangles (corners amid a straight side) faces of polyhedra are cut so that
// their worst triangle is as good as possible. Cells of fixed shape become tetrahedra from their lowest corner to the faces that do not
// have it (a hexahedron 6, a wedge 3, a pyramid 2); a polyhedron those from the middle of its points to all faces.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/huge_allocator.h"
#include "data/cells/cell_reader.h"
#include "index/cell_tree.h"

namespace sg::volume {

/// The way from one tetrahedron to the next: with the three corners of the face that was entered, `all` gives the fourth.
struct TetLink {
  uint32_t all;     ///< exclusive or of its four vertices
  int32_t next[4];  ///< beyond the face that lacks its k-th smallest vertex; -1: nothing
};

struct TetMesh {
  /// A face with a tetrahedron on one side only.
  struct Face {
    std::array<uint32_t, 3> v;  ///< ascending
    uint32_t apex, tet;
  };
  Vec3 origin;                             ///< middle of the bounds
  Plane<Vec3> at;                          ///< relative to it: the points of the mesh, then the middles of polyhedra
  size_t points = 0;                       ///< how many are points of the mesh
  std::vector<uint32_t> middle_of;         ///< the cell of each middle
  Plane<std::array<uint32_t, 4>> corners;  ///< ascending
  Plane<TetLink> links;
  Plane<uint32_t> cells;  ///< of each tetrahedron, ascending; empty: tetrahedron k is cell k
  std::vector<Face> boundary;
  std::optional<CellTree> tree;  ///< over `boundary`
  Box3 bounds;                   ///< world, of the tetrahedra
  double edge = 0;               ///< cube root of twice the mean volume of the cells that are in it
  bool all_tets = false;         ///< each cell is one tetrahedron

  size_t size() const { return links.size(); }
  uint32_t cell(size_t tet) const { return cells.empty() ? uint32_t(tet) : cells[tet]; }
  size_t bytes() const;
};

/// Of the solid cells for which `draws` is true (called from several threads) and that are not ghosts or blanked. Flat tetrahedra stay
/// (they have no length); those with a repeated corner are dropped. Works on linear cells and polyhedra of any mesh. O(n), parallel, the
/// same for any number of threads. Throws Error(usage) for meshes without solid cells, for curved cells and for more than 2^29 tetrahedra.
TetMesh make_tet_mesh(const DatasetPtr& dataset, const std::function<bool(const CellReader& open)>& draws, Context& context);

}  // namespace sg::volume
