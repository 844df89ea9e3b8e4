// SPDX-License-Identifier: Apache-2.0
// Points along lines, and proximity queries. Internal to filter/glyph.
#pragma once
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "filter/glyph/points.h"

namespace sg {

/// Things at places, found by boxes of a given edge: neighbours are those in the boxes around.
class NeighbourGrid {
 public:
  explicit NeighbourGrid(double edge) : edge_(edge) {}
  void add(Vec3 p, int64_t id) { boxes_[key(cell(p.x), cell(p.y), cell(p.z))].push_back({p, id}); }
  /// Whether f(place, id) holds for any of those nearer than `edge` (and some further ones).
  template <class F>
  bool any(Vec3 p, F&& f) const {
    for (int64_t k = -1; k <= 1; ++k)
      for (int64_t j = -1; j <= 1; ++j)
        for (int64_t i = -1; i <= 1; ++i) {
          const auto found = boxes_.find(key(cell(p.x) + i, cell(p.y) + j, cell(p.z) + k));
          if (found == boxes_.end()) continue;
          for (const auto& [q, id] : found->second)
            if (f(q, id)) return true;
        }
    return false;
  }

 private:
  int64_t cell(double x) const { return int64_t(std::floor(std::clamp(x / edge_, -1e6, 1e6))); }
  static uint64_t key(int64_t i, int64_t j, int64_t k) {
    return (uint64_t(i + 1048576) & 0x1FFFFF) << 42 | (uint64_t(j + 1048576) & 0x1FFFFF) << 21 | (uint64_t(k + 1048576) & 0x1FFFFF);
  }
  double edge_;
  std::unordered_map<uint64_t, std::vector<std::pair<Vec3, int64_t>>> boxes_;
};

/// See glyph_points, mode lines.
DatasetPtr points_along_lines(const DatasetPtr& data, const GlyphPointsParams& p);

}  // namespace sg
