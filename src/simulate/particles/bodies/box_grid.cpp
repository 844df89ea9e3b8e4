// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/bodies/box_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sg::swarm {

BoxGrid::BoxGrid(std::vector<Box3> boxes) : boxes_(std::move(boxes)) {
  for (const Box3& b : boxes_) all_.add(b.lo), all_.add(b.hi);
  if (boxes_.empty()) return;
  // About as many cells as boxes, of equal sides.
  const Vec3 size = all_.size();
  const double longest = std::max({size.x, size.y, size.z}), along = std::clamp(std::cbrt(double(boxes_.size())) * 2, 1.0, 128.0);
  for (int a = 0; a < 3; ++a) {
    n_[size_t(a)] = longest > 0 ? std::max(1, int(std::ceil(along * size[a] / longest))) : 1;
    scale_[a] = size[a] > 0 ? n_[size_t(a)] / size[a] : 0;
  }
  const auto each_cell = [&](auto&& f) {
    std::array<int, 3> lo, hi;
    for (uint32_t b = 0; b < boxes_.size(); ++b) {
      cells_of(boxes_[b], lo, hi);
      for (int k = lo[2]; k <= hi[2]; ++k)
        for (int j = lo[1]; j <= hi[1]; ++j)
          for (int i = lo[0]; i <= hi[0]; ++i) f(cell(i, j, k), b);
    }
  };
  begin_.assign(size_t(n_[0]) * size_t(n_[1]) * size_t(n_[2]) + 1, 0);
  each_cell([&](size_t c, uint32_t) { ++begin_[c + 1]; });
  for (size_t c = 0; c + 1 < begin_.size(); ++c) begin_[c + 1] += begin_[c];
  items_.resize(begin_.back());
  std::vector<uint32_t> next(begin_.begin(), begin_.end() - 1);
  each_cell([&](size_t c, uint32_t b) { items_[next[c]++] = b; });
}

bool BoxGrid::cells_of(const Box3& box, std::array<int, 3>& lo, std::array<int, 3>& hi) const {
  for (int a = 0; a < 3; ++a) {
    if (!(box.lo[a] <= all_.hi[a] && box.hi[a] >= all_.lo[a])) return false;
    const double last = n_[size_t(a)] - 1;
    lo[size_t(a)] = int(std::clamp((box.lo[a] - all_.lo[a]) * scale_[a], 0.0, last));
    hi[size_t(a)] = int(std::clamp((box.hi[a] - all_.lo[a]) * scale_[a], 0.0, last));
  }
  return true;
}

void BoxGrid::find(const Box3& box, std::vector<uint32_t>& out) const {
  out.clear();
  std::array<int, 3> lo, hi;
  if (boxes_.empty() || !cells_of(box, lo, hi)) return;
  for (int k = lo[2]; k <= hi[2]; ++k)
    for (int j = lo[1]; j <= hi[1]; ++j)
      for (int i = lo[0]; i <= hi[0]; ++i)
        for (uint32_t e = begin_[cell(i, j, k)]; e < begin_[cell(i, j, k) + 1]; ++e) {
          const Box3& b = boxes_[items_[e]];
          bool meets = true;
          for (int a = 0; a < 3; ++a) meets = meets && b.lo[a] <= box.hi[a] && b.hi[a] >= box.lo[a];
          if (meets) out.push_back(items_[e]);
        }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

}  // namespace sg::swarm
