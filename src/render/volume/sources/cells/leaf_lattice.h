// SPDX-License-Identifier: Apache-2.0
// LeafLattice: the field in a box whose faces and edges are split by finer neighbours, as trilinear little boxes.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/vec.h"

namespace sg::volume {

/// A leaf of an AMR grid next to finer ones. On a piece of a face the field is bilinear between its corners, or follows the nodes on the
/// piece's sides (Coons 1967); so it is continuous across neighbours of any level, since both read the same nodes. Inside it blends the
/// faces (Gordon, Hall 1973). Linear fields stay linear.
class LeafLattice {
 public:
  static constexpr int most = 8;  ///< little boxes along an axis

  /// The nodes of the leaf: its corners and those that neighbours add. `faces`: pieces of the faces, rectangles with places in the
  /// nodes. False when they do not form such a box, or the smallest neighbour is more than `most` times smaller.
  bool open(std::span<const Vec3> at, std::span<const double> values, const std::function<size_t()>& face_count,
            const std::function<std::span<const uint32_t>(size_t)>& face);
  double value(Vec3 x) const;
  /// The places in (from, to) where the line x + t d passes from one little box to another, ascending.
  void cuts(Vec3 x, Vec3 d, double from, double to, std::vector<double>& out) const;

 private:
  double& node(int i, int j, int k) { return f_[size_t(i + (n_ + 1) * (j + (n_ + 1) * k))]; }
  double& node(const int p[3]) { return node(p[0], p[1], p[2]); }
  void fill_line(const int from[3], int axis, int count);
  void fill_face(const int lo[3], const int hi[3]);
  void fill_inside();

  int n_ = 1;
  Vec3 lo_, per_;  // lattice place = (x - lo) * per
  std::vector<double> f_;
};

}  // namespace sg::volume
