// SPDX-License-Identifier: Apache-2.0
// Which level of a bricked volume is drawn where: a tree of boxes whose leaves are the bricks of a picture.
//
// Boxes are counted in samples of level 0 ("fine coordinates" u: sample i lies at u = i). A brick of level l covers 64 cells of that
// level along each axis, so bricks of finer levels nest in it:
//
//   level 1   |       0       |       1       |
//   level 0   |   0   |   1   |   2   |   3   |
//             u=0     64     128     192     256
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "data/bricked.h"
#include "render/volume/medium/stretch.h"
#include "scene/camera.h"

namespace sg::volume {

struct BrickNode {
  std::array<uint32_t, 3> at{};  ///< among the bricks of its level
  int32_t children = -1;         ///< place of the first of them; -1 for leaves
  float lo = 0, hi = 0;          ///< no value of the field lies outside
  uint8_t level = 0;
  uint8_t blend = 0;   ///< bit c: at corner c (x + 2y + 4z) the next coarser level is drawn
  bool exists = true;  ///< beyond the grid otherwise
  bool seen = false;   ///< in the view, and not invisible
};

class BrickTree {
 public:
  /// Leaves have voxels of at most `pixels` pixels. The visible leaves may take `most_bytes`: above that, coarser ones are chosen until
  /// they fit.
  BrickTree(const BrickedVolume& volume, const Projection& projection, double pixels, uint64_t most_bytes, const Invisible& invisible);

  /// The leaf at a place inside the grid.
  int find(Vec3 u) const;
  const BrickNode& node(int i) const { return nodes_[size_t(i)]; }
  size_t size() const { return nodes_.size(); }
  /// Its box in fine coordinates, cut off at the outermost samples.
  void box(const BrickNode& node, Vec3& lo, Vec3& hi) const;
  /// The brick of the next coarser level that it lies in.
  std::array<uint32_t, 3> parent(const BrickNode& node) const;
  /// Visible leaves, in an order in which none hides an earlier one.
  std::vector<int> front_to_back() const;
  double pixels() const { return pixels_; }
  uint64_t bytes() const { return bytes_; }

 private:
  void visit(int at, Vec3 eye, Vec3 along, std::vector<int>& leaves) const;
  void describe(BrickNode& node) const;
  bool in_view(const BrickNode& node, double& nearest) const;
  bool grow(double pixels, uint64_t most_bytes);
  bool too_coarse(const BrickNode& node, double nearest, double pixels) const;
  void split(int at);
  void balance();
  void blend();
  uint64_t brick_bytes(const BrickNode& node) const;
  std::array<uint32_t, 3> bricks(size_t level) const;

  const BrickedVolume& volume_;
  const Projection& projection_;
  const Invisible& invisible_;
  std::vector<std::vector<BrickedVolume::Extremes>> extremes_;  // by level; empty when not known
  std::array<uint32_t, 3> roots_{};
  std::vector<BrickNode> nodes_;
  double pixels_ = 1;
  uint64_t bytes_ = 0;
};

/// Share of the next coarser level at a place (fine coordinates) in a leaf with the box lo..hi: trilinear between its corners.
double coarser_share(const BrickNode& node, Vec3 lo, Vec3 hi, Vec3 u);

/// Ends of the grid along an axis in fine coordinates: a single layer is one cell thick.
inline double first_place(size_t n) { return n == 1 ? -0.5 : 0; }
inline double last_place(size_t n) { return n == 1 ? 0.5 : double(n) - 1; }

}  // namespace sg::volume
