// SPDX-License-Identifier: Apache-2.0
// Velocities in solid cells of every kind, mixed as they come: linear ones of all shapes, curved ones, polyhedra; of unstructured meshes
// and curvilinear grids. The last cell is asked first, from the last place in it; where that ends outside, the cell across the face through
// which it left is next. Internal to filter/flow.
#pragma once
#include <optional>
#include <vector>

#include "filter/flow/cursors/flow_access.h"
#include "filter/flow/cursors/linear_cell.h"

namespace sg {

class SolidCursor {
 public:
  SolidCursor(const FlowAccess& access, PointVectors vectors);

  enum class Found : uint8_t { here, outside, lost };
  /// Walks to x. Outside: x is outside of the mesh's box. Lost: the walk came to a border, a hidden or a broken cell: a tree search is
  /// needed.
  Found find(Vec3 x);
  /// In a cell found elsewhere; false where its map does not lead to x.
  bool set(int64_t cell, Vec3 x);

  Vec3 velocity();
  Mat3 gradient();
  int64_t cell() const { return cell_; }
  double length();
  /// Of the last place.
  std::span<const int64_t> ids();
  std::span<const double> weights();

 private:
  enum class Kind : uint8_t { linear, curved, polyhedron, none };
  struct Plane {
    Vec3 normal, at;  // unit, outward
  };
  void open(int64_t cell);
  void open_linear(size_t cell, CellType type);
  void open_polyhedron();
  // Where x lies from the open cell: exit.face -1 inside. False when that cannot be decided.
  bool look(Vec3 x, bool quick, FaceExit& exit);
  bool look_curved(Vec3 x, bool quick, FaceExit& exit);
  bool look_polyhedron(Vec3 x, FaceExit& exit);
  int64_t across(int face) const;
  void weigh();

  const FlowAccess* access_;
  PointVectors v_;
  std::optional<CellMap> map_;        // of curved cells and polyhedra
  std::optional<CellReader> faces_;   // of the open polyhedron
  std::optional<CellReader> hidden_;  // where some are
  int64_t cell_ = -1;
  Kind kind_ = Kind::none;
  CellType base_ = CellType::empty;
  LinearCell linear_;
  CellPlace place_;
  Vec3 box_, middle_;
  double tolerance_ = 0, size_ = 0;
  bool weighed_ = false, convex_ = false;
  std::vector<Plane> planes_;  // of a polyhedron's triangles
  std::vector<int> plane_face_;
  std::vector<Vec3> u_, slopes_;  // of the open cell's points
  int64_t id_[8];
  double weight_[8];
  std::vector<double> weights_;
};

}  // namespace sg
