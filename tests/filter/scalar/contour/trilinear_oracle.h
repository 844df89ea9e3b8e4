// SPDX-License-Identifier: Apache-2.0
// The topology of {trilinear function = 0} in a cell in closed form, by a sweep. Written without a look at the code under test.
//
// In a plane w = const the surface is a hyperbola in a square: no, one or two arcs, known from the signs of the four corner columns and,
// where they alternate, from the sign of the determinant q(w) = AC - BD. The arcs change only at events: a column crosses zero (an arc
// is born, dies, or its end slides from one side of the square to the next), or q crosses zero with the centre of the hyperbola in the
// square (the two arcs meet in a cross and part the other way). Hence the Euler characteristic (sum over events of that of the slice, minus
// the arcs of each open interval) and the components (arcs joined from interval to interval). The sweep runs along each axis; all three
// must agree.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace sg::test {

struct UnionFind {
  std::vector<int> parent;
  explicit UnionFind(size_t n) : parent(n) { std::iota(parent.begin(), parent.end(), 0); }
  int root(int i) {
    while (parent[size_t(i)] != i) i = parent[size_t(i)] = parent[size_t(parent[size_t(i)])];
    return i;
  }
  void join(int a, int b) { parent[size_t(root(a))] = root(b); }
};

/// What the sweep finds. `part[e]`: the lowest cut edge in the same component as cut edge e, -1 for edges that are not cut. Edges as in
/// lattice_cases(): 0-3 along u, 4-7 along v, 8-11 along w, each in order of their lower corner.
struct CellTopology {
  int euler = 0, components = 0;
  std::array<int, 12> part;
  bool operator==(const CellTopology&) const = default;
};

inline int edge_of(int axis, int low) { return axis == 0 ? low >> 1 : axis == 1 ? 4 + (low & 1) + (low >> 2 << 1) : 8 + low; }

/// Values that are no ties (see break_ties); corner c at (c&1, c>>1&1, c>>2).
inline CellTopology sweep(const std::array<double, 8>& f, int axis) {
  const int s = (axis + 1) % 3, t = (axis + 2) % 3;
  const int base[4] = {0, 1 << s, 1 << s | 1 << t, 1 << t};  // round the square: sides k between column k and k+1
  double low[4], high[4];
  for (int c = 0; c < 4; ++c) low[c] = f[size_t(base[c])], high[c] = f[size_t(base[c] | 1 << axis)];
  auto column = [&](int c, double w) { return low[c] + (high[c] - low[c]) * w; };
  struct Event {
    double at;
    int column;  // -1: saddle
  };
  std::vector<Event> events;
  for (int c = 0; c < 4; ++c)
    if ((low[c] > 0) != (high[c] > 0)) events.push_back({low[c] / (low[c] - high[c]), c});
  const double d[4] = {high[0] - low[0], high[1] - low[1], high[2] - low[2], high[3] - low[3]};
  const double q2 = d[0] * d[2] - d[1] * d[3], q1 = low[0] * d[2] + low[2] * d[0] - low[1] * d[3] - low[3] * d[1],
               q0 = low[0] * low[2] - low[1] * low[3];
  const double square = q1 * q1 - 4 * q0 * q2;
  std::vector<double> roots;
  if (std::abs(q2) < 1e-14) {
    if (q1 != 0) roots = {-q0 / q1};
  } else if (square > 0) {
    const double big = -0.5 * (q1 + (q1 < 0 ? -1 : 1) * std::sqrt(square));
    roots = {big / q2, q0 / big};
  }
  for (double w : roots) {
    if (!(w > 0 && w < 1)) continue;
    const double a = column(0, w), b = column(1, w), c = column(2, w), e = column(3, w), sum = a - b + c - e;
    const double x = (a - e) / sum, y = (a - b) / sum;
    if (x > 0 && x < 1 && y > 0 && y < 1) events.push_back({w, -1});
  }
  std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.at < b.at; });

  // The arcs of an interval as pairs of sides.
  using Arcs = std::vector<std::array<int, 2>>;
  bool positive[4];
  for (int c = 0; c < 4; ++c) positive[c] = low[c] > 0;
  auto arcs_at = [&](double w) -> Arcs {
    std::vector<int> sides;
    for (int k = 0; k < 4; ++k)
      if (positive[k] != positive[(k + 1) % 4]) sides.push_back(k);
    if (sides.size() == 2) return {{sides[0], sides[1]}};
    if (sides.empty()) return {};
    const bool q_positive = column(0, w) * column(2, w) > column(1, w) * column(3, w);
    // q > 0: columns 0 and 2 are joined, so arcs cut off columns 1 (sides 0, 1) and 3 (sides 2, 3).
    return q_positive ? Arcs{{0, 1}, {2, 3}} : Arcs{{3, 0}, {1, 2}};
  };
  std::vector<Arcs> intervals;
  std::vector<int> first{0};
  for (size_t i = 0; i <= events.size(); ++i) {
    const double from = i ? events[i - 1].at : 0, to = i < events.size() ? events[i].at : 1;
    if (i && events[i - 1].column >= 0) positive[events[i - 1].column] ^= true;
    intervals.push_back(arcs_at(0.5 * (from + to)));
    first.push_back(first.back() + int(intervals.back().size()));
  }
  UnionFind joined(size_t(first.back()));
  auto arc_with = [&](size_t i, int side) {
    for (size_t a = 0; a < intervals[i].size(); ++a)
      if (intervals[i][a][0] == side || intervals[i][a][1] == side) return first[i] + int(a);
    return -1;
  };
  CellTopology r;
  r.part.fill(-1);
  std::array<int, 12> arc_of;
  arc_of.fill(-1);
  r.euler = int(intervals.front().size() + intervals.back().size());
  for (const Arcs& a : intervals) r.euler -= int(a.size());
  for (size_t i = 0; i < events.size(); ++i) {
    const auto &before = intervals[i], &after = intervals[i + 1];
    if (events[i].column < 0) {
      if (before.size() != 2 || after.size() != 2 || before == after) throw std::logic_error("sweep: no saddle");
      r.euler += 1;
      joined.join(first[i], first[i] + 1), joined.join(first[i], first[i + 1]), joined.join(first[i], first[i + 1] + 1);
      continue;
    }
    const int c = events[i].column, one = (c + 3) % 4, two = c;  // the sides that meet at the column
    r.euler += int(std::max(before.size(), after.size()));
    for (int side = 0; side < 4; ++side) {
      if (side == one || side == two) continue;
      const int a = arc_with(i, side), b = arc_with(i + 1, side);
      if ((a < 0) != (b < 0)) throw std::logic_error("sweep: an arc jumps");
      if (a >= 0) joined.join(a, b);
    }
    const int a1 = arc_with(i, one), a2 = arc_with(i, two), b1 = arc_with(i + 1, one), b2 = arc_with(i + 1, two);
    const int a = std::max(a1, a2), b = std::max(b1, b2);
    if (a1 >= 0 && a2 >= 0 && a1 != a2) throw std::logic_error("sweep: two arcs die at once");
    if (b1 >= 0 && b2 >= 0 && b1 != b2) throw std::logic_error("sweep: two arcs are born at once");
    if (a >= 0 && b >= 0) joined.join(a, b);
    arc_of[size_t(edge_of(axis, base[c]))] = std::max(a, b);
  }
  for (int k = 0; k < 4; ++k) {
    const int low_corner = std::min(base[k], base[(k + 1) % 4]), along = k % 2 ? t : s;
    arc_of[size_t(edge_of(along, low_corner))] = arc_with(0, k);
    arc_of[size_t(edge_of(along, low_corner | 1 << axis))] = arc_with(intervals.size() - 1, k);
  }
  for (int i = 0; i < first.back(); ++i) r.components += joined.root(i) == i;
  for (int e = 0; e < 12; ++e) {
    if (arc_of[size_t(e)] < 0) continue;
    for (int o = e; o >= 0; --o)
      if (arc_of[size_t(o)] >= 0 && joined.root(arc_of[size_t(o)]) == joined.root(arc_of[size_t(e)])) r.part[size_t(e)] = o;
  }
  return r;
}

/// The rule for ties: zeros count as a little more than zero. The second term only separates events that would coincide.
inline std::array<double, 8> break_ties(const std::array<double, 8>& f, int variant) {
  std::array<double, 8> r;
  for (size_t c = 0; c < 8; ++c) r[c] = f[c] + 3e-5 + 1e-7 * std::sin(12.9898 * double(c + 1) + double(variant));
  return r;
}

inline CellTopology generic_topology(const std::array<double, 8>& f) {
  const CellTopology r = sweep(f, 0);
  if (!(r == sweep(f, 1)) || !(r == sweep(f, 2))) throw std::logic_error("sweep: the axes disagree");
  return r;
}

/// With `ties`, for small whole numbers; where rounding spoils a sweep, the events are separated in another way.
inline CellTopology cell_topology(const std::array<double, 8>& f, bool ties = false) {
  if (!ties) return generic_topology(f);
  for (int variant = 0; variant < 9; ++variant) try {
      return generic_topology(break_ties(f, variant));
    } catch (const std::logic_error&) {
    }
  return generic_topology(break_ties(f, 9));
}

}  // namespace sg::test
