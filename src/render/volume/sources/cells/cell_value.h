// SPDX-License-Identifier: Apache-2.0
// CellCurve: the field of one cell that is not a tetrahedron, along a ray, as cubics.
#pragma once
#include <memory>
#include <vector>

#include "data/cells/shape/cell_map.h"
#include "render/volume/medium/stretch.h"
#include "render/volume/sources/cells/cell_volume.h"
#include "render/volume/sources/cells/leaf_lattice.h"

namespace sg::volume {

/// Hexahedra that are parallelepipeds, voxels, and leaves of AMR grids: exact. Others: the cell's own functions (mean value coordinates in
/// polyhedra) through the inverse map at thirds, halved until the cubic departs at 1/6, 1/2 and 5/6 by less than CellVolume::fit_error (at
/// most 5 times). Not thread-safe: one per walker.
class CellCurve {
 public:
  explicit CellCurve(const CellVolume& volume);
  /// Opens a cell (of CellVolume::curved, if there is one); no value lies outside [lowest, highest].
  void open(uint32_t cell, float& lowest, float& highest);
  /// Appends stretches over [from, to] of the ray x + t d (x relative to TetMesh::origin) that carry `mark`.
  void add(Vec3 x, Vec3 d, double from, double to, uint64_t mark, std::vector<Stretch>& out);

 private:
  enum class Kind { box, hexahedron, shape, polyhedron, leaf };
  float value(Vec3 at);
  bool invert(Vec3 at);
  bool open_affine();
  void fit(Vec3 x, Vec3 d, double from, double to, const float ends[2], int depth, uint64_t mark, std::vector<Stretch>& out);

  const CellVolume& volume_;
  CellMap map_;
  CellReader reader_;  // of faces
  LeafLattice leaf_;
  std::vector<double> cuts_;
  uint32_t cell_ = uint32_t(-1);
  Kind kind_ = Kind::box;
  const CellShape* shape_ = nullptr;
  std::vector<Vec3> at_, dn_;  // of the open cell's points, relative to the mesh's origin; in the order of hexahedra
  std::vector<double> f_, n_, weights_;
  float lowest_ = 0, highest_ = 0;
  Vec3 rows_[3], first_;                 // box, and affine shapes: reference coordinates = first + rows . (x - at_[0])
  bool affine_ = false, cubic_ = false;  // shapes: straight; and no more than cubic along a line
  Vec3 guess_;
  double size_ = 1;
};

}  // namespace sg::volume
