// SPDX-License-Identifier: Apache-2.0
// Curved and many-sided 2D cells as triangles, curves as segments.
#include "base/error.h"
#include "data/cell_topology.h"

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

// The corner at b sticks out and no other corner lies inside the triangle a b c.
bool is_ear(const std::vector<Ear>& p, const std::vector<uint32_t>& ring, size_t i) {
  const size_t n = ring.size(), before = (i + n - 1) % n, after = (i + 1) % n;
  const Ear a = p[ring[before]], b = p[ring[i]], c = p[ring[after]];
  if (turn(a, b, c) <= 0) return false;
  for (size_t k = 0; k < n; ++k) {
    if (k == before || k == i || k == after) continue;
    const Ear q = p[ring[k]];
    if ((q.x == a.x && q.y == a.y) || (q.x == b.x && q.y == b.y) || (q.x == c.x && q.y == c.y)) continue;
    if (turn(a, b, q) >= 0 && turn(b, c, q) >= 0 && turn(c, a, q) >= 0) return false;
  }
  return true;
}

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
  std::vector<uint32_t> ring(n);
  for (uint32_t i = 0; i < n; ++i) ring[i] = i;
  size_t i = 0, misses = 0;
  while (ring.size() > 3) {
    i %= ring.size();
    // Folded or self-crossing outlines have no ear: cut anyway, so that every corner is used.
    if (is_ear(flat, ring, i) || misses > ring.size()) {
      add(triangles, ring[(i + ring.size() - 1) % ring.size()], ring[i], ring[(i + 1) % ring.size()]);
      ring.erase(ring.begin() + ptrdiff_t(i));
      misses = 0;
    } else {
      ++i, ++misses;
    }
  }
  add(triangles, ring[0], ring[1], ring[2]);
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

// Orders along both sides of a Lagrange or Bezier quad: the given ones when they fit, else what the count of nodes says; 0 = none.
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
