// SPDX-License-Identifier: Apache-2.0
#include "data/cells/triangulate_loops.h"

#include <algorithm>
#include <cmath>

namespace sg {

namespace {

struct Place {
  int64_t x, y;
  friend bool operator==(const Place&, const Place&) = default;
};

// Twice the area of a triangle; exact, as coordinates have 30 bits.
int64_t turn(Place a, Place b, Place c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

bool in_triangle(Place a, Place b, Place c, Place p) { return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0; }

using Loop = std::vector<uint32_t>;

double twice_area(const std::vector<Place>& at, const Loop& l) {
  double sum = 0;
  const Place o = at[l[0]];
  for (size_t k = 1; k + 1 < l.size(); ++k) sum += double(turn(o, at[l[k]], at[l[k + 1]]));
  return sum;
}

// 1 inside, -1 outside, 0 on the line.
int side_of_loop(const std::vector<Place>& at, const Loop& l, Place p) {
  bool inside = false;
  for (size_t k = 0, n = l.size(); k < n; ++k) {
    const Place a = at[l[k]], b = at[l[(k + 1) % n]];
    if (turn(a, b, p) == 0 && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
        p.y <= std::max(a.y, b.y))
      return 0;
    if ((a.y > p.y) != (b.y > p.y) && (turn(a, b, p) > 0) == (b.y > a.y)) inside = !inside;
  }
  return inside ? 1 : -1;
}

bool contains(const std::vector<Place>& at, const Loop& outer, const Loop& inner) {
  for (uint32_t i : inner)
    if (const int s = side_of_loop(at, outer, at[i]); s != 0) return s > 0;
  return false;
}

/// One outer loop with its holes, as a ring that grows by bridges and shrinks by ears.
class Ring {
 public:
  Ring(const std::vector<Place>& at, const Loop& outer) : at_(at) { add(outer); }

  void add_holes(std::vector<Loop> holes) {
    auto right = [&](const Loop& l) { return *std::max_element(l.begin(), l.end(), [&](uint32_t a, uint32_t b) { return less(a, b); }); };
    std::sort(holes.begin(), holes.end(), [&](const Loop& a, const Loop& b) { return less(right(b), right(a)); });
    for (const Loop& h : holes) {
      const size_t first = node_.size();
      add(h);
      size_t m = first;
      for (size_t k = first; k < node_.size(); ++k)
        if (less(node_[m].point, node_[k].point)) m = k;
      bridge(m, visible(m, first));
    }
  }

  void clip(std::vector<uint32_t>& out) {
    make_boxes();
    size_t left = node_.size(), ear = 0, since = 0;
    int strict = 0;  // 0: proper ears; 1: with points on their sides; 2: flat ones too; 3: anything
    while (left > 2) {
      const size_t a = node_[ear].before, c = node_[ear].after;
      if (left == 3 || is_ear(a, ear, c, strict)) {
        out.insert(out.end(), {node_[a].point, node_[ear].point, node_[c].point});
        node_[a].after = c, node_[c].before = a, node_[ear].gone = true;
        --left, since = 0, strict = 0;
        ear = node_[c].after;  // not the neighbour: fans are avoided
        if (left == 2) break;
      } else {
        ear = c;
        if (++since > left) ++strict, since = 0;
      }
    }
  }

 private:
  struct Node {
    uint32_t point;
    size_t before, after;
    bool gone = false;
  };

  Place at(size_t node) const { return at_[node_[node].point]; }
  bool less(uint32_t a, uint32_t b) const { return at_[a].x != at_[b].x ? at_[a].x < at_[b].x : at_[a].y < at_[b].y; }

  void add(const Loop& l) {
    const size_t first = node_.size(), n = l.size();
    for (size_t k = 0; k < n; ++k) node_.push_back({l[k], first + (k + n - 1) % n, first + (k + 1) % n});
  }

  // Whether the path from node a to p starts inside the ring.
  bool locally_inside(size_t a, Place p) const {
    const Place prev = at(node_[a].before), here = at(a), next = at(node_[a].after);
    if (turn(prev, here, next) >= 0) return turn(here, p, next) <= 0 && turn(here, prev, p) <= 0;
    return turn(here, p, prev) > 0 || turn(here, next, p) > 0;
  }

  // A ring node that node m of a hole sees: along +x to the nearest side, then the corner of least slope in the way (Eberly).
  size_t visible(size_t m, size_t ring_end) const {
    const Place p = at(m);
    double nearest = HUGE_VAL;
    size_t best = SIZE_MAX;
    for (size_t k = 0; k < ring_end; ++k) {
      const Place a = at(k), b = at(node_[k].after);
      if (a == p && locally_inside(k, at(node_[m].after))) return k;
      if (!(std::min(a.y, b.y) <= p.y && p.y <= std::max(a.y, b.y)) || a.y == b.y) continue;
      const double x = double(a.x) + double(p.y - a.y) * double(b.x - a.x) / double(b.y - a.y);
      if (x < double(p.x) || b.y < a.y) continue;  // the inside lies on the left: sides on the right go up
      if (x < nearest) nearest = x, best = a.x > b.x ? k : node_[k].after;
    }
    if (best == SIZE_MAX) {  // crossing loops: any node does
      best = 0;
      return best;
    }
    const Place corner = at(best), hit{int64_t(std::ceil(nearest)), p.y};
    const bool above = corner.y > p.y;
    double slope = corner == p ? 0 : std::abs(double(corner.y - p.y)) / std::max(double(corner.x - p.x), 1e-9);
    for (size_t k = 0; k < ring_end; ++k) {
      const Place q = at(k);
      if (k == best || q.x < p.x || (above ? q.y < p.y || q.y > corner.y : q.y > p.y || q.y < corner.y)) continue;
      const bool in = above ? in_triangle(p, hit, corner, q) : in_triangle(p, corner, hit, q);
      if (!in || !locally_inside(k, p)) continue;
      const double s = std::abs(double(q.y - p.y)) / std::max(double(q.x - p.x), 1e-9);
      const bool closer = s == slope && q.x < at(best).x;
      if (s < slope || closer || (q == at(best) && !locally_inside(best, p))) slope = s, best = k;
    }
    if (!locally_inside(best, p))  // several nodes at one place: the one that opens towards the hole
      for (size_t k = 0; k < ring_end; ++k)
        if (at(k) == at(best) && locally_inside(k, p)) return k;
    return best;
  }

  // r ... -> r, m, ... round the hole ..., m again, r again, ...
  void bridge(size_t m, size_t r) {
    const size_t m2 = node_.size(), r2 = m2 + 1, r_after = node_[r].after, m_before = node_[m].before;
    node_.push_back({node_[m].point, m_before, r2});
    node_.push_back({node_[r].point, m2, r_after});
    node_[r].after = m, node_[m].before = r;
    node_[m_before].after = m2, node_[r_after].before = r2;
  }

  // Nodes by their boxes in a grid of about as many boxes as nodes.
  void make_boxes() {
    lo_ = hi_ = at(0);
    for (size_t k = 0; k < node_.size(); ++k) {
      lo_ = {std::min(lo_.x, at(k).x), std::min(lo_.y, at(k).y)};
      hi_ = {std::max(hi_.x, at(k).x), std::max(hi_.y, at(k).y)};
    }
    n_ = std::clamp<int64_t>(int64_t(std::sqrt(double(node_.size()))), 1, 1024);
    std::vector<uint32_t> count(size_t(n_ * n_) + 1, 0);
    for (size_t k = 0; k < node_.size(); ++k) ++count[box(at(k)) + 1];
    for (size_t b = 0; b + 1 < count.size(); ++b) count[b + 1] += count[b];
    begin_ = count;
    list_.resize(node_.size());
    for (size_t k = 0; k < node_.size(); ++k) list_[count[box(at(k))]++] = uint32_t(k);
  }
  int64_t column(int64_t x) const { return hi_.x > lo_.x ? std::min(n_ - 1, (x - lo_.x) * n_ / (hi_.x - lo_.x + 1)) : 0; }
  int64_t row(int64_t y) const { return hi_.y > lo_.y ? std::min(n_ - 1, (y - lo_.y) * n_ / (hi_.y - lo_.y + 1)) : 0; }
  size_t box(Place p) const { return size_t(row(p.y) * n_ + column(p.x)); }

  bool is_ear(size_t ia, size_t ib, size_t ic, int strict) const {
    const Place a = at(ia), b = at(ib), c = at(ic);
    const int64_t size = turn(a, b, c);
    if (strict >= 3) return true;
    if (strict == 2 && size == 0) return true;
    if (size <= 0) return false;
    const int64_t x0 = column(std::min({a.x, b.x, c.x})), x1 = column(std::max({a.x, b.x, c.x}));
    const int64_t y0 = row(std::min({a.y, b.y, c.y})), y1 = row(std::max({a.y, b.y, c.y}));
    for (int64_t y = y0; y <= y1; ++y)
      for (int64_t x = x0; x <= x1; ++x)
        for (uint32_t i = begin_[size_t(y * n_ + x)]; i < begin_[size_t(y * n_ + x) + 1]; ++i) {
          const size_t k = list_[i];
          if (node_[k].gone || k == ia || k == ib || k == ic) continue;
          const Place p = at(k);
          if (p == a || p == b || p == c) continue;
          const bool in = strict == 0 ? in_triangle(a, b, c, p) : turn(a, b, p) > 0 && turn(b, c, p) > 0 && turn(c, a, p) > 0;
          if (in && turn(at(node_[k].before), p, at(node_[k].after)) <= 0) return false;
          // A corner on the new side blocks too, though it is convex: the side would run through it.
          if (in && turn(c, a, p) == 0) return false;
        }
    return true;
  }

  const std::vector<Place>& at_;
  std::vector<Node> node_;
  Place lo_{}, hi_{};
  int64_t n_ = 1;
  std::vector<uint32_t> begin_, list_;
};

}  // namespace

void triangulate_loops(const std::vector<Vec2>& points, const std::vector<std::vector<uint32_t>>& loops, std::vector<uint32_t>& triangles) {
  double lo[2] = {HUGE_VAL, HUGE_VAL}, hi[2] = {-HUGE_VAL, -HUGE_VAL};
  for (const Loop& l : loops)
    for (uint32_t i : l)
      for (int c = 0; c < 2; ++c) lo[c] = std::min(lo[c], points[i][c]), hi[c] = std::max(hi[c], points[i][c]);
  const double size = std::max(hi[0] - lo[0], hi[1] - lo[1]), scale = size > 0 ? double(1 << 29) / size : 0;
  std::vector<Place> at(points.size());
  for (const Loop& l : loops)
    for (uint32_t i : l) at[i] = {std::llround((points[i].x - lo[0]) * scale), std::llround((points[i].y - lo[1]) * scale)};

  std::vector<double> area;
  std::vector<size_t> used;
  for (size_t i = 0; i < loops.size(); ++i) {
    area.push_back(loops[i].size() < 3 ? 0 : twice_area(at, loops[i]));
    if (loops[i].size() >= 3) used.push_back(i);
  }
  // How many loops hold each one, and which of them is the smallest.
  std::vector<int> depth(loops.size(), 0);
  std::vector<size_t> parent(loops.size(), SIZE_MAX);
  for (size_t i : used)
    for (size_t k : used)
      if (i != k && std::abs(area[k]) > std::abs(area[i]) && contains(at, loops[k], loops[i])) {
        ++depth[i];
        if (parent[i] == SIZE_MAX || std::abs(area[k]) < std::abs(area[parent[i]])) parent[i] = k;
      }
  for (size_t i : used) {
    if (depth[i] % 2 == 1) continue;
    Loop outer = loops[i];
    if (area[i] < 0) std::reverse(outer.begin(), outer.end());
    std::vector<Loop> holes;
    for (size_t k : used)
      if (parent[k] == i && depth[k] == depth[i] + 1) {
        holes.push_back(loops[k]);
        if (area[k] > 0) std::reverse(holes.back().begin(), holes.back().end());
      }
    Ring ring(at, outer);
    ring.add_holes(std::move(holes));
    const size_t first = triangles.size();
    ring.clip(triangles);
    if (area[i] < 0)
      for (size_t t = first; t + 2 < triangles.size(); t += 3) std::swap(triangles[t + 1], triangles[t + 2]);
  }
}

}  // namespace sg
