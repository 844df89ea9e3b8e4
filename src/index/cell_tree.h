// SPDX-License-Identifier: Apache-2.0
// CellTree: a bounding-volume hierarchy over the cells of any mesh. Binned surface-area heuristic (Wald 2007), built in parallel,
// the same tree for any number of threads. Boxes are f32, rounded outward, relative to the mesh's centre (double).
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// 32 bytes. Inner: children at `first` and `first`+1. Leaf: count > 0, cells order[first .. first+count).
struct TreeNode {
  float lo[3], hi[3];
  uint32_t first;
  uint32_t count;
};

class CellTree {
 public:
  /// Over all cells that are not hidden. O(n log n); under 60 bytes a cell at its peak beside the mesh.
  CellTree(DatasetPtr dataset, Context& context);
  /// Over boxes given by the caller.
  CellTree(std::span<const Box3> boxes, Context& context);

  std::span<const TreeNode> nodes() const { return nodes_; }
  std::span<const uint32_t> order() const { return order_; }
  Vec3 center() const { return center_; }
  size_t bytes() const { return nodes_.size() * sizeof(TreeNode) + order_.size() * 4; }

  /// Calls f(cell) for each cell whose box holds x (grown by `slack`); f returns true to stop.
  template <class F>
  bool cells_at(Vec3 x, double slack, F&& f) const;
  /// Calls f(cell) in order of growing box distance while it is below `limit2`; f returns the new limit (squared distance).
  template <class F>
  void nearest(Vec3 x, double limit2, F&& f) const;
  /// Calls f(cell) for boxes that the ray x + t d, t in [t0, t1], meets, near ones first; f returns the new t1.
  template <class F>
  void along_ray(Vec3 x, Vec3 d, double t0, double t1, F&& f) const;
  /// Calls f(cell) for each cell whose box meets `box`.
  template <class F>
  void overlapping(const Box3& box, F&& f) const;

 private:
  std::vector<TreeNode> nodes_;
  std::vector<uint32_t> order_;
  Vec3 center_{0, 0, 0};
};

}  // namespace sg
