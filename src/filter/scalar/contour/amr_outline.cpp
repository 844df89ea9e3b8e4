// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/contour/amr_outline.h"

#include <algorithm>

namespace sg::contouring {

// Corners on the edge of `level` that starts at `from`, its end left out.
void AmrOutline::split_edge(Place from, size_t axis, size_t level, std::vector<Place>& out) const {
  out.push_back(from);
  if (level + 1 >= leaves_.grid().levels.size()) return;
  const int64_t step = leaves_.size(level + 1)[axis], parts = leaves_.size(level)[axis] / step;
  bool finer = false;
  for (int64_t t = 0; t < parts && !finer; ++t)
    for (int q = 0; q < (flat_ ? 2 : 4) && !finer; ++q) {
      Place at = from;
      at[axis] += t * step;
      const size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      if (flat_) {
        at[axis == 0 ? 1 : 0] -= q;
      } else {
        at[u] -= q & 1, at[v] -= q >> 1;
      }
      const Leaf leaf = leaves_.at(at);
      finer = leaf.cell >= 0 && leaf.level > level;
    }
  if (!finer) return;
  out.pop_back();
  for (int64_t t = 0; t < parts; ++t) {
    Place at = from;
    at[axis] += t * step;
    split_edge(at, axis, level + 1, out);
  }
}

// The outline of a rectangle of `level` at `lo` across `axis`, counterclockwise seen from its high side.
std::vector<AmrOutline::Place> AmrOutline::rectangle(const Place& lo, size_t axis, size_t level) const {
  const size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Place& s = leaves_.size(level);
  Place right = lo, up = lo;
  right[u] += s[u], up[v] += s[v];
  std::vector<Place> r, part;
  Place far = right;
  far[v] += s[v];
  auto backwards = [&](const Place& from, size_t along, const Place& end) {
    part.clear();
    split_edge(from, along, level, part);
    part.push_back(end);
    r.insert(r.end(), part.rbegin(), part.rend() - 1);
  };
  split_edge(lo, u, level, r);
  split_edge(right, v, level, r);
  backwards(up, u, far);
  backwards(lo, v, up);
  return r;
}

// The pieces of a face of `level`: those of finer leaves behind it, if there are any.
void AmrOutline::split_face(const Place& lo, size_t axis, bool high, size_t level, std::vector<std::vector<Place>>& out) const {
  const size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  bool finer = false;
  if (level + 1 < leaves_.grid().levels.size()) {
    const Place &s = leaves_.size(level), &t = leaves_.size(level + 1);
    auto behind = [&](int64_t i, int64_t j) {
      Place at = lo;
      at[axis] -= high ? 0 : 1;
      at[u] += i * t[u], at[v] += j * t[v];
      return at;
    };
    for (int64_t j = 0; j < s[v] / t[v] && !finer; ++j)
      for (int64_t i = 0; i < s[u] / t[u] && !finer; ++i) {
        const Leaf leaf = leaves_.at(behind(i, j));
        finer = leaf.cell >= 0 && leaf.level > level;
      }
    if (finer)
      for (int64_t j = 0; j < s[v] / t[v]; ++j)
        for (int64_t i = 0; i < s[u] / t[u]; ++i) {
          Place at = lo;
          at[u] += i * t[u], at[v] += j * t[v];
          split_face(at, axis, high, level + 1, out);
        }
  }
  if (finer) return;
  out.push_back(rectangle(lo, axis, level));
  if (!high) std::reverse(out.back().begin(), out.back().end());
}

void AmrOutline::open(const Leaf& leaf) {
  faces.clear(), corners.clear();
  const Place& s = leaves_.size(leaf.level);
  if (flat_) faces.push_back(rectangle(leaf.lo, 2, leaf.level));
  for (size_t axis = 0; axis < 3 && !flat_; ++axis)
    for (int side = 0; side < 2; ++side) {
      Place lo = leaf.lo;
      if (side) lo[axis] += s[axis];
      split_face(lo, axis, side == 1, leaf.level, faces);
    }
  for (const auto& f : faces) corners.insert(corners.end(), f.begin(), f.end());
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
}

}  // namespace sg::contouring
