// SPDX-License-Identifier: Apache-2.0
// Nearest points and rays. Of several answers at the same distance the smallest cell is given, so that the order of the search does not
// matter.
#include "index/cell_locator_index.h"

namespace sg {

NearestPlace LocatorCursor::nearest(Vec3 x, double radius) {
  State& s = *state_;
  NearestPlace best;
  best.distance2 = HUGE_VAL;
  const double limit2 = radius * radius;
  if (!std::isfinite(x.x + x.y + x.z) || !(radius >= 0)) return {};
  auto take = [&](int64_t cell, Vec3 at, double d2) {
    if (d2 <= limit2 && (d2 < best.distance2 || (d2 == best.distance2 && cell < best.cell))) best = {cell, at, d2};
  };
  const auto& index = *s.index;
  if (index.kind == CellLocator::Index::Kind::grid && !index.any_hidden && index.grid && index.grid->orthogonal()) {
    int64_t cell = -1;
    Vec3 at = index.grid->nearest(x, cell);
    take(cell, at, dot(x - at, x - at));
  } else {
    if (s.cell >= 0 && index.kind == CellLocator::Index::Kind::tree) {  // the last answer is often near: a bound for the search
      Vec3 at;
      const double d2 = s.probe.nearest(size_t(s.cell), x, at);
      take(s.cell, at, d2);
    }
    index.tree().nearest(x, std::min(limit2, best.distance2), [&](uint32_t c) {
      const double limit = std::min(limit2, best.distance2);
      if (int64_t(c) == best.cell) return limit;
      Vec3 at;
      const double d2 = s.probe.nearest(c, x, at, limit);
      take(int64_t(c), at, d2);
      return std::min(limit2, best.distance2);
    });
  }
  return best.cell < 0 ? NearestPlace{} : best;
}

namespace {

bool proper(Vec3 x, Vec3 d) {
  const double size2 = dot(d, d);
  return size2 > 0 && std::isfinite(size2) && std::isfinite(x.x + x.y + x.z);
}

// Takes the cell's hit where it is the first so far.
void take_hit(CellProbe& probe, uint32_t cell, Vec3 x, Vec3 d, double t0, RayHit& best) {
  Vec3 normal;
  const double t = probe.hit(cell, x, d, t0, best.t, normal);
  if (t < best.t || (t == best.t && (best.cell < 0 || int64_t(cell) < best.cell))) best = {int64_t(cell), t, normal};
}

}  // namespace

std::optional<RayHit> LocatorCursor::first_hit(Vec3 x, Vec3 d, double t0, double t1) {
  if (!proper(x, d)) return {};
  State& s = *state_;
  RayHit best;
  best.t = t1;
  const auto& index = *s.index;
  if (index.kind == CellLocator::Index::Kind::grid && !index.any_hidden && index.grid) {
    const GridIndex::Hit h = index.grid->first_hit(x, d, t0, t1, index.slack);
    best = {h.cell, h.t, h.normal};
  } else {
    index.tree().along_ray(x, d, t0, t1, [&](uint32_t c) {
      take_hit(s.probe, c, x, d, t0, best);
      return best.t;
    });
  }
  if (best.cell < 0) return {};
  return best;
}

std::optional<RayHit> LocatorCursor::first_hit_among(std::span<const uint32_t> cells, Vec3 x, Vec3 d, double t0, double t1) {
  if (!proper(x, d)) return {};
  RayHit best;
  best.t = t1;
  for (const uint32_t c : cells) take_hit(state_->probe, c, x, d, t0, best);
  if (best.cell < 0) return {};
  return best;
}

}  // namespace sg
