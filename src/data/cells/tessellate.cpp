// SPDX-License-Identifier: Apache-2.0
// Curved and many-sided 2D cells as triangles, curves as segments.
#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "data/cells/cell_topology.h"

namespace sg {

Vec3 polygon_vector_area(std::span<const Vec3> at) {
  Vec3 sum;
  for (size_t i = 1; i + 1 < at.size(); ++i) sum += cross(at[i] - at[0], at[i + 1] - at[0]);
  return sum;
}

namespace {

void add(std::vector<uint32_t>& out, uint32_t a, uint32_t b, uint32_t c) { out.insert(out.end(), {a, b, c}); }

// Split along the diagonal that keeps both triangles on the quad's side; of two that do, along 0-2.
void split_quad(std::span<const Vec3> at, uint32_t a, uint32_t b, uint32_t c, uint32_t d, std::vector<uint32_t>& out) {
  if (first_diagonal_fits(at[a], at[b], at[c], at[d])) add(out, a, b, c), add(out, a, c, d);
  else add(out, a, b, d), add(out, b, c, d);
}

struct Ear {
  double x, y;
};
double turn(Ear a, Ear b, Ear c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

// The corners of an outline from which ears are cut, as a ring. Those near a triangle are found by a grid of about one corner a cell, so
// that an outline of many corners takes about as long as its corners are many, not their square.
constexpr uint32_t many_corners = 64;

class Outline {
 public:
  explicit Outline(const std::vector<Ear>& p) : p_(p), next_(p.size()), before_(p.size()), size_(p.size()) {
    const auto n = uint32_t(p.size());
    for (uint32_t i = 0; i < n; ++i) next_[i] = (i + 1) % n, before_[i] = (i + n - 1) % n;
    if (n >= many_corners) make_grid();
  }

  size_t size() const { return size_; }
  uint32_t next(uint32_t i) const { return next_[i]; }
  uint32_t before(uint32_t i) const { return before_[i]; }

  void remove(uint32_t i) {
    next_[before_[i]] = next_[i], before_[next_[i]] = before_[i];
    --size_;
    if (!grid_.empty()) std::erase(grid_[cell(p_[i])], i);
  }

  // The corner sticks out and no other corner lies inside the triangle that it makes with its neighbours.
  bool is_ear(uint32_t i) const {
    const Ear a = p_[before_[i]], b = p_[i], c = p_[next_[i]];
    if (turn(a, b, c) <= 0) return false;
    const auto blocks = [&](uint32_t k) {
      if (k == before_[i] || k == i || k == next_[i]) return false;
      const Ear q = p_[k];
      if ((q.x == a.x && q.y == a.y) || (q.x == b.x && q.y == b.y) || (q.x == c.x && q.y == c.y)) return false;
      return turn(a, b, q) >= 0 && turn(b, c, q) >= 0 && turn(c, a, q) >= 0;
    };
    if (grid_.empty()) {
      for (uint32_t k = next_[next_[i]]; k != before_[i]; k = next_[k])
        if (blocks(k)) return false;
      return true;
    }
    // Large triangles have one in their middle, more often than not.
    const auto& middle = grid_[cell({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3})];
    if (std::any_of(middle.begin(), middle.end(), blocks)) return false;
    // What is inside by rounding lies next to the triangle: one more cell on each side.
    const auto [x0, x1] = std::minmax({a.x, b.x, c.x});
    const auto [y0, y1] = std::minmax({a.y, b.y, c.y});
    const size_t i1 = std::min(column(x1) + 1, columns_ - 1), j1 = std::min(row(y1) + 1, rows_ - 1);
    for (size_t j = std::max<size_t>(row(y0), 1) - 1; j <= j1; ++j)
      for (size_t k = std::max<size_t>(column(x0), 1) - 1; k <= i1; ++k)
        if (std::any_of(grid_[j * columns_ + k].begin(), grid_[j * columns_ + k].end(), blocks)) return false;
    return true;
  }

 private:
  void make_grid() {
    lo_ = {HUGE_VAL, HUGE_VAL};
    Ear hi{-HUGE_VAL, -HUGE_VAL};
    for (const Ear& e : p_) {
      if (!std::isfinite(e.x) || !std::isfinite(e.y)) return;
      lo_ = {std::min(lo_.x, e.x), std::min(lo_.y, e.y)}, hi = {std::max(hi.x, e.x), std::max(hi.y, e.y)};
    }
    const double w = hi.x - lo_.x, h = hi.y - lo_.y, n = double(p_.size());
    if (!(w > 0) || !(h > 0) || !std::isfinite(w) || !std::isfinite(h)) return;
    columns_ = size_t(std::clamp(std::sqrt(n * (w / h)), 1.0, n)), rows_ = std::max<size_t>(p_.size() / columns_, 1);
    per_x_ = double(columns_) / w, per_y_ = double(rows_) / h;
    if (!std::isfinite(per_x_) || !std::isfinite(per_y_)) return;
    grid_.resize(columns_ * rows_);
    for (uint32_t i = 0; i < p_.size(); ++i) grid_[cell(p_[i])].push_back(i);
  }
  size_t column(double x) const { return std::min(size_t(std::max((x - lo_.x) * per_x_, 0.0)), columns_ - 1); }
  size_t row(double y) const { return std::min(size_t(std::max((y - lo_.y) * per_y_, 0.0)), rows_ - 1); }
  size_t cell(Ear e) const { return row(e.y) * columns_ + column(e.x); }

  const std::vector<Ear>& p_;
  std::vector<uint32_t> next_, before_;
  size_t size_, columns_ = 1, rows_ = 1;
  Ear lo_{0, 0};
  double per_x_ = 0, per_y_ = 0;
  std::vector<std::vector<uint32_t>> grid_;  // empty: all corners are looked at
};

}  // namespace

void triangulate_polygon(std::span<const Vec3> at, std::vector<uint32_t>& triangles) {
  const size_t n = at.size();
  if (n < 3) return;
  if (n == 3) return add(triangles, 0, 1, 2);
  if (n == 4) return split_quad(at, 0, 1, 2, 3, triangles);
  // Project along the largest part of the normal, mirrored so that the polygon turns left.
  const Vec3 normal = polygon_vector_area(at);
  const Vec3 size{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
  const int drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int u = (drop + 1) % 3, v = (drop + 2) % 3;
  std::vector<Ear> flat(n);
  for (size_t i = 0; i < n; ++i) flat[i] = {at[i][u] - at[0][u], normal[drop] < 0 ? at[0][v] - at[i][v] : at[i][v] - at[0][v]};
  bool convex = true;
  for (size_t i = 0; i < n && convex; ++i) convex = turn(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) > 0;
  // A star also turns left at every corner; its fan would overlap, so the fan must turn left as well.
  for (size_t i = 1; i + 1 < n && convex; ++i) convex = turn(flat[0], flat[i], flat[i + 1]) > 0;
  if (convex) {
    for (uint32_t i = 1; i + 1 < n; ++i) add(triangles, 0, i, i + 1);
    return;
  }
  Outline ring(flat);
  uint32_t i = 0;
  size_t misses = 0, forced = 0;
  while (ring.size() > 3) {
    const uint32_t after = ring.next(i);
    // Folded or self-crossing outlines have no ear: cut anyway, so that every corner is used. With many corners a round for each such cut
    // would take the square of their number.
    const bool ear = ring.is_ear(i);
    if (ear || misses > (n < many_corners ? ring.size() : ring.size() / (1 + forced))) {
      forced += !ear;
      add(triangles, ring.before(i), i, after);
      ring.remove(i);
      misses = 0;
    } else {
      ++misses;
    }
    i = after;
  }
  // From the first corner that is left, as they were numbered.
  const std::array<uint32_t, 3> rest{i, ring.next(i), ring.before(i)};
  const auto first = size_t(std::min_element(rest.begin(), rest.end()) - rest.begin());
  add(triangles, rest[first], rest[(first + 1) % 3], rest[(first + 2) % 3]);
}

namespace {

using Orders = std::array<int, 3>;

void split_lattice_triangle(CellType type, int n, std::vector<uint32_t>& out) {
  auto node = [&](int i, int j) { return lattice_node(type, n, i, j); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i + j < n; ++i) {
      add(out, node(i, j), node(i + 1, j), node(i, j + 1));
      if (i + j + 1 < n) add(out, node(i + 1, j), node(i + 1, j + 1), node(i, j + 1));
    }
}

void split_lattice_quad(CellType type, Orders n, std::span<const Vec3> at, std::vector<uint32_t>& out) {
  auto node = [&](int i, int j) { return lattice_node(type, n, i, j); };
  for (int j = 0; j < n[1]; ++j)
    for (int i = 0; i < n[0]; ++i) split_quad(at, node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1), out);
}

// Orders along both sides of a Lagrange or Bezier quad: the given ones if they fit, else as the node count implies; 0 = none.
Orders quad_orders(CellType type, size_t nodes, Orders given) {
  if (given[0] > 0 && given[1] > 0 && lattice_nodes(type, given) == nodes) return given;
  const int n = high_order_of(type, nodes);
  return {n, n, n};
}

void split_strip(size_t n, std::vector<uint32_t>& out) {
  for (uint32_t i = 0; i + 2 < n; ++i) i % 2 ? add(out, i + 1, i, i + 2) : add(out, i, i + 1, i + 2);
}

}  // namespace

void tessellate_face(CellType type, std::span<const Vec3> at, std::vector<uint32_t>& out, std::array<int, 3> orders) {
  using enum CellType;
  const size_t n = at.size();
  const CellType shape = linear_type(type);
  if (type == triangle_strip) return split_strip(n, out);
  if (type == polygon) return triangulate_polygon(at, out);
  if (type == pixel) return split_quad(at, 0, 1, 3, 2, out);
  if (type == quadratic_polygon) {
    std::vector<uint32_t> ring, local;
    face_outline(type, n, ring);
    std::vector<Vec3> p;
    for (uint32_t i : ring) p.push_back(at[i]);
    triangulate_polygon(p, local);
    for (uint32_t i : local) out.push_back(ring[i]);
    return;
  }
  if (shape == triangle) {
    if (n == 3) return add(out, 0, 1, 2);
    if (n == 7) {  // six triangles around the node in the middle
      constexpr uint32_t ring[7] = {0, 3, 1, 4, 2, 5, 0};
      for (int i = 0; i < 6; ++i) add(out, ring[i], ring[i + 1], 6);
      return;
    }
    if (const int order = high_order_of(type, n); order > 0) return split_lattice_triangle(type, order, out);
    if (n > 3) return add(out, 0, 1, 2);
  }
  if (shape == quad) {
    if (n == 4) return split_quad(at, 0, 1, 2, 3, out);
    if (type == quadratic_linear_quad) return split_quad(at, 0, 4, 5, 3, out), split_quad(at, 4, 1, 2, 5, out);
    if (type == quadratic_quad) {
      add(out, 0, 4, 7), add(out, 1, 5, 4), add(out, 2, 6, 5), add(out, 3, 7, 6);
      return split_quad(at, 4, 5, 6, 7, out);
    }
    if (const Orders o = quad_orders(type, n, orders); o[0] > 0) return split_lattice_quad(type, o, at, out);
    if (n > 4) return split_quad(at, 0, 1, 2, 3, out);
  }
  if (cell_type_info(type).dimension != 2) fail_internal(fmt::format("{} is not a 2D cell", cell_type_info(type).name));
}

void curve_order(CellType type, size_t nodes, std::vector<uint32_t>& order) {
  order.clear();
  const bool curved = is_high_order(type) && nodes > 2;
  if (!curved) {
    for (uint32_t i = 0; i < nodes; ++i) order.push_back(i);
    return;
  }
  order.push_back(0);
  for (uint32_t i = 2; i < nodes; ++i) order.push_back(i);
  order.push_back(1);
}

void face_outline(CellType type, size_t nodes, std::vector<uint32_t>& ring, std::array<int, 3> orders) {
  using enum CellType;
  ring.clear();
  const CellType shape = linear_type(type);
  if (type == pixel) {
    ring = {0, 1, 3, 2};
  } else if (type == quadratic_polygon) {
    for (uint32_t i = 0; i < nodes / 2; ++i) ring.push_back(i), ring.push_back(i + uint32_t(nodes / 2));
  } else if (type == polygon) {
    for (uint32_t i = 0; i < nodes; ++i) ring.push_back(i);
  } else if (type == quadratic_linear_quad) {
    ring = {0, 4, 1, 2, 5, 3};
  } else if (type == quadratic_quad || type == biquadratic_quad) {
    ring = {0, 4, 1, 5, 2, 6, 3, 7};
  } else if (shape == triangle && (nodes == 6 || nodes == 7)) {
    ring = {0, 3, 1, 4, 2, 5};
  } else if (shape == triangle || shape == quad) {
    Orders n{1, 1, 1};
    if (shape == quad && is_high_order(type)) n = quad_orders(type, nodes, orders);
    else if (is_high_order(type)) n.fill(high_order_of(type, nodes));
    for (int& o : n) o = std::max(o, 1);
    auto add_side = [&](int i, int j, int di, int dj) {
      for (int s = 0; s < (di != 0 ? n[0] : n[1]); ++s) ring.push_back(lattice_node(shape, n, i + s * di, j + s * dj));
    };
    add_side(0, 0, 1, 0);
    if (shape == triangle) add_side(n[0], 0, -1, 1), add_side(0, n[0], 0, -1);
    else add_side(n[0], 0, 0, 1), add_side(n[0], n[1], -1, 0), add_side(0, n[1], 0, -1);
  }
}

}  // namespace sg
