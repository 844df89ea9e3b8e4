// SPDX-License-Identifier: Apache-2.0
#include "index/grid_index.h"

#include <algorithm>

#include "index/cell_probe.h"

namespace sg {

GridIndex::GridIndex(const LatticeView& view) : points_(view.dims), cells_(view.cell_dims()), origin_(view.origin) {
  for (int a = 0; a < 3; ++a) flat_[a] = points_[size_t(a)] <= 1, any_flat_ = any_flat_ || flat_[a];
  if (view.mode == LatticeView::Mode::separable) {
    separable_ = true;
    for (int a = 0; a < 3; ++a) {
      axis_[a] = view.axis[a];
      first_[a] = view.axis[a][0];
      rows_[a][a] = 1;
    }
    return;
  }
  for (int a = 0; a < 3; ++a) step_[a] = view.step[a];
  // Axes without cells get a unit step across the others, so that their coordinate is a distance.
  for (int a = 0; a < 3; ++a) {
    if (!flat_[a]) continue;
    Vec3 u = step_[(a + 1) % 3], v = step_[(a + 2) % 3];
    const bool has_u = !flat_[(a + 1) % 3] || a == 2, has_v = !flat_[(a + 2) % 3] || a > 0;  // those already set count
    auto across = [](Vec3 w) {
      const Vec3 m(std::abs(w.x), std::abs(w.y), std::abs(w.z));
      return cross(w, m.x <= m.y && m.x <= m.z ? Vec3(1, 0, 0) : m.y <= m.z ? Vec3(0, 1, 0) : Vec3(0, 0, 1));
    };
    if (!has_u && !has_v) step_[a] = Vec3(a == 0, a == 1, a == 2);
    else if (!has_v) step_[a] = normalize(across(u));
    else if (!has_u) step_[a] = normalize(across(v));
    else step_[a] = normalize(cross(u, v));
  }
  const Vec3 &u = step_[0], &v = step_[1], &w = step_[2];
  const double volume = dot(u, cross(v, w));
  rows_[0] = cross(v, w) / volume, rows_[1] = cross(w, u) / volume, rows_[2] = cross(u, v) / volume;
  auto right_angle = [](Vec3 p, Vec3 q) { return std::abs(dot(p, q)) <= 1e-12 * length(p) * length(q); };
  orthogonal_ = right_angle(u, v) && right_angle(v, w) && right_angle(w, u);
}

Vec3 GridIndex::to_world(Vec3 q) const {
  if (!separable_) return origin_ + step_[0] * q.x + step_[1] * q.y + step_[2] * q.z;
  return {flat_[0] ? first_[0] + q.x : q.x, flat_[1] ? first_[1] + q.y : q.y, flat_[2] ? first_[2] + q.z : q.z};
}

int GridIndex::cells_of(int a, double q, double slack, size_t index[3], double r[3]) const {
  if (flat_[a]) {
    index[0] = 0, r[0] = 0;
    return std::abs(q) <= slack;
  }
  const size_t n = cells_[size_t(a)];
  const double* at = axis_[a];
  size_t i = 0;
  if (!at) {
    if (!(q >= -1 && q <= double(n) + 1)) return 0;
    i = size_t(std::min(std::max(q, 0.0), double(n - 1)));
  } else {
    const bool up = at[n] > at[0];
    const double* it =
        up ? std::upper_bound(at, at + n + 1, q) : std::upper_bound(at, at + n + 1, q, [](double v, double e) { return v > e; });
    i = std::min(size_t(std::max<ptrdiff_t>(it - at - 1, 0)), n - 1);
  }
  int found = 0;
  for (size_t j = i > 0 ? i - 1 : 0; j <= std::min(i + 1, n - 1); ++j) {
    const double s = at ? (q - at[j]) / (at[j + 1] - at[j]) : q - double(j);
    const double tolerance = any_flat_ ? slack / width(a, j) : locate_tolerance;
    if (s >= -tolerance && s <= 1 + tolerance) index[found] = j, r[found++] = s;
  }
  return found;
}

bool GridIndex::close(Vec3 q, const std::array<size_t, 3>& cell, double r[3], double slack) const {
  double d2 = 0;
  for (int a = 0; a < 3; ++a) {
    const double d = flat_[a] ? q[a] : std::max({-r[a], r[a] - 1, 0.0}) * width(a, cell[size_t(a)]);
    d2 += d * d;
    r[a] = std::clamp(r[a], 0.0, 1.0);
  }
  return d2 <= slack * slack;
}

Vec3 GridIndex::position(int64_t cell, const CellPlace& place) const {
  const size_t c = size_t(cell), at[3] = {c % cells_[0], c / cells_[0] % cells_[1], c / cells_[0] / cells_[1]};
  Vec3 q;
  for (int a = 0, axis = 0; a < 3; ++a) {
    if (flat_[a]) continue;
    const double r = place.rst[axis++];
    q[a] = plane(a, at[a]) * (1 - r) + plane(a, at[a] + 1) * r;
  }
  return to_world(q);
}

int GridIndex::weights(int64_t cell, const CellPlace& place, int64_t ids[8], double out[8]) const {
  const size_t c = size_t(cell), i = c % cells_[0], j = c / cells_[0] % cells_[1], k = c / cells_[0] / cells_[1];
  const size_t step[3] = {1, points_[0], points_[0] * points_[1]};
  ids[0] = int64_t(i + points_[0] * (j + points_[1] * k)), out[0] = 1;
  int n = 1;
  for (int a = 0, axis = 0; a < 3; ++a) {
    if (flat_[a]) continue;
    const double r = place.rst[axis++];
    for (int m = 0; m < n; ++m) {
      ids[n + m] = ids[m] + int64_t(step[a]);
      out[n + m] = out[m] * r;
      out[m] *= 1 - r;
    }
    n *= 2;
  }
  return n;
}

Vec3 GridIndex::nearest(Vec3 x, int64_t& cell) const {
  Vec3 q = to_grid(x);
  for (int a = 0; a < 3; ++a) {
    const double p = plane(a, 0), e = plane(a, cells_[size_t(a)] * size_t(!flat_[a]));
    q[a] = flat_[a] ? 0.0 : std::min(std::max(q[a], std::min(p, e)), std::max(p, e));
  }
  double slack = HUGE_VAL;
  for (int a = 0; a < 3; ++a)
    if (!flat_[a]) slack = std::min(slack, locate_tolerance * width(a, 0));
  CellPlace place;
  cell = find_grid(
      q, slack, [](size_t) { return false; }, place);
  return to_world(q);
}

// The cell at place t of a ray that crosses a plane of axis a there.
GridIndex::Hit GridIndex::hit_plane(double t, int a, size_t plane_number, Vec3 o, Vec3 d, double slack) const {
  Vec3 q = o + d * t;
  q[a] = flat_[a] ? 0.0 : plane(a, plane_number);
  CellPlace place;
  Hit h{t,
        find_grid(
            q, slack, [](size_t) { return false; }, place),
        normalize(rows_[a])};
  if (h.cell < 0) return {};
  const size_t c = size_t(h.cell), at[3] = {c % cells_[0], c / cells_[0] % cells_[1], c / cells_[0] / cells_[1]};
  bool low = !flat_[a] && at[a] == plane_number;
  if (axis_[a] && !flat_[a] && axis_[a][0] > axis_[a][1]) low = !low;
  if (low) h.normal = -h.normal;
  return h;
}

GridIndex::Hit GridIndex::first_hit(Vec3 x, Vec3 direction, double t0, double t1, double slack) const {
  const Vec3 o = to_grid(x), d = direction_to_grid(direction);
  const int flat = int(flat_[0]) + int(flat_[1]) + int(flat_[2]);
  if (flat > 1) return {};
  if (flat == 1) {
    const int a = flat_[0] ? 0 : flat_[1] ? 1 : 2;
    const double t = -o[a] / d[a];
    return d[a] != 0 && t >= t0 && t <= t1 ? hit_plane(t, a, 0, o, d, slack) : Hit{};
  }
  // Where the ray is in the box.
  double enter = t0, leave = t1;
  int enter_axis = -1;
  for (int a = 0; a < 3; ++a) {
    const double p = plane(a, 0), e = plane(a, cells_[size_t(a)]), lo = std::min(p, e), hi = std::max(p, e);
    if (d[a] == 0) {
      if (o[a] < lo || o[a] > hi) return {};
      continue;
    }
    const double near = ((d[a] > 0 ? lo : hi) - o[a]) / d[a], far = ((d[a] > 0 ? hi : lo) - o[a]) / d[a];
    if (near > enter) enter = near, enter_axis = a;
    leave = std::min(leave, far);
  }
  if (enter > leave * (1 + 1e-14) + 1e-300) return {};
  if (enter_axis >= 0) {
    const int a = enter_axis;
    const bool from_first = (d[a] > 0) == (plane(a, 0) < plane(a, cells_[size_t(a)]));
    return enter <= t1 ? hit_plane(enter, a, from_first ? 0 : cells_[size_t(a)], o, d, slack) : Hit{};
  }
  // From inside: the next plane along each axis.
  double best = HUGE_VAL;
  int best_axis = -1;
  size_t best_plane = 0;
  for (int a = 0; a < 3; ++a) {
    if (d[a] == 0) continue;  // a ray within a plane does not meet it
    const double q = o[a] + d[a] * t0;
    size_t i[3];
    double r[3];
    const int found = cells_of(a, q, slack, i, r);
    for (int m = 0; m < found; ++m)
      for (size_t p = i[m]; p <= i[m] + 1; ++p) {
        const double gap = plane(a, p) - q;
        const double t = gap == 0 ? t0 : t0 + gap / d[a];
        if (t >= t0 && t < best) best = t, best_axis = a, best_plane = p;
      }
  }
  return best_axis >= 0 && best <= t1 ? hit_plane(best, best_axis, best_plane, o, d, slack) : Hit{};
}

}  // namespace sg
