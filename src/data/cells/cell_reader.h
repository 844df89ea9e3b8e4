// SPDX-License-Identifier: Apache-2.0
// CellReader: the cells of any mesh kind, one at a time, in one form: type, point ids, positions, rational weights.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "data/cells/cell_topology.h"
#include "data/dataset.h"

namespace sg {

/// Opens cells of any mesh. Grids give Vertex, Line, Pixel/Quad, Voxel/Hexahedron cells (Pixel and Voxel for uniform and rectilinear
/// ones) in VTK's node order; a point cloud gives one Vertex a point; AMR the Voxels (2D: Pixels) of all patches. Not thread-safe:
/// one per thread; copies are cheap. Keeps the dataset alive.
class CellReader {
 public:
  explicit CellReader(DatasetPtr dataset);

  size_t count() const { return count_; }
  /// Selects a cell. References returned before become invalid.
  void open(size_t cell);
  size_t cell() const { return cell_; }
  CellType type() const { return type_; }
  int dimension() const;
  /// Point ids of the open cell, in the order of its type. A polyhedron: its distinct points.
  std::span<const int64_t> ids() const { return ids_; }
  /// Their positions, in double.
  std::span<const Vec3> at() const { return at_; }
  /// Rational weights of the nodes (Bezier); empty = all 1.
  std::span<const double> weights() const { return weights_; }
  /// Orders along the axes of a Lagrange or Bezier cell (from UnstructuredMesh::degrees, else the same along all); 0 for others.
  std::array<int, 3> orders() const { return orders_; }
  /// What the cell lies in: the box of its nodes, grown by 15 % (above order 2: 25 %) of its size for Lagrange-like curved cells,
  /// which bulge beyond their nodes.
  Box3 box() const;
  /// Not to be located, drawn or integrated: ghost_hidden_cell, ghost_refined_cell or ghost_duplicate are set, or one of its points
  /// is hidden (ghost_hidden_point).
  bool hidden(size_t cell) const;
  /// Polyhedra: faces as lists of places in ids() (not point ids), as the file orders them; others: from cell_faces(). Throws
  /// Error(data) when a face has a point that the cell does not list.
  size_t face_count();
  std::span<const uint32_t> face(size_t f);

 private:
  struct Source;
  void open_unstructured(size_t cell);
  std::shared_ptr<const Source> source_;
  size_t count_ = 0, cell_ = 0;
  CellType type_ = CellType::empty;
  std::array<int, 3> orders_{0, 0, 0};
  std::vector<int64_t> ids_;
  std::vector<Vec3> at_;
  std::vector<double> weights_;
  std::vector<uint32_t> face_begin_, face_nodes_;
};

}  // namespace sg
