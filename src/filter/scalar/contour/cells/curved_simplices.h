// SPDX-License-Identifier: Apache-2.0
// Curved cells near an isosurface as small triangles and tetrahedra in reference space. Inside filter/scalar only.
#pragma once
#include <array>
#include <unordered_map>
#include <vector>

#include "base/context.h"
#include "data/cells/shape/cell_map.h"

namespace sg::contouring {

/// A triangle or tetrahedron inside a cell.
struct Simplex {
  std::array<uint32_t, 4> v{};  ///< numbers in CurvedSimplices::points()
  std::array<Vec3, 4> rst;      ///< where they lie in this cell
  uint32_t cell = 0;
  uint8_t corners = 4;   ///< 3: a triangle
  bool flipped = false;  ///< the cell is turned inside out
};

/// Values of a field at reference places of the cells of one mesh. Not thread-safe: one per thread.
class CellField {
 public:
  CellField(DatasetPtr dataset, View<double> values) : map_(std::move(dataset)), f_(values) {}
  CellMap& open(size_t cell);
  double value(Vec3 rst);
  Vec3 gradient(Vec3 rst);
  Vec3 position(Vec3 rst) const { return map_.position(rst); }
  const std::vector<double>& weights(Vec3 rst);
  /// Of the nodes of the open cell.
  std::span<const double> nodes() const { return node_values_; }

 private:
  CellMap map_;
  View<double> f_;
  size_t cell_ = SIZE_MAX;
  std::vector<double> node_values_, weights_;
};

/// Simplices on which field and geometry are straight enough for the surface at `value` to lie within the tolerance (a length) of
/// its true place, wherever it may pass.
///
/// Each cell is cut at its corners (by the lowest point number, so that neighbours agree on diagonals) and its edges are halved as
/// long as the field or the map bends too far along one of them, the longest first. An edge is halved in all simplices around it or
/// in none; which child of a face remains depends only on the face. So neighbours stay joined however differently they are
/// divided. Edges shorter than the tolerance stay whole, and nothing is divided where the field, by its bend, cannot reach the value.
class CurvedSimplices {
 public:
  struct Point {
    Vec3 x;
    double f;
  };
  /// `values`: one number a point of the mesh. Throws Error(usage) for cells without shape functions.
  CurvedSimplices(const DatasetPtr& dataset, View<double> values, double value, double tolerance, Context& context);

  const std::vector<Point>& points() const { return points_; }
  const std::vector<Simplex>& simplices() const { return simplices_; }

 private:
  static uint64_t key(uint32_t a, uint32_t b) { return a < b ? uint64_t(a) << 32 | b : uint64_t(b) << 32 | a; }
  struct Middle {
    Point at;
    uint32_t number = UINT32_MAX;  ///< its point, once the edge is to be halved
  };
  void start(size_t cell, CellField& field);
  void add_simplex(Simplex s);
  uint32_t point_of(int64_t id, Vec3 rst, CellField& field);
  void find_middles();
  size_t mark(int round);
  void halve();
  void split(const Simplex& s, std::vector<Simplex>& out) const;

  const DatasetPtr& dataset_;
  View<double> f_;
  double value_, tolerance_;
  Context& context_;
  std::vector<Point> points_;
  std::vector<Simplex> simplices_;
  std::unordered_map<int64_t, uint32_t> corner_;  ///< point of the mesh -> point
  std::unordered_map<uint32_t, uint8_t> rounds_;  ///< cell -> halvings it needs before its nodes are seen
  std::unordered_map<uint64_t, Middle> middles_;
};

}  // namespace sg::contouring
