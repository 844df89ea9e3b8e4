// SPDX-License-Identifier: Apache-2.0
#include "data/cells/shape/cell_inverse.h"

#include <algorithm>
#include <array>

#include "data/cells/cell_topology.h"
#include "data/cells/shape/multilinear_part.h"

namespace sg {

void CellGeometry::values(Vec3 rst) const {
  shape->values(rst, n);
  if (weight.empty()) return;
  double sum = 0;
  for (size_t k = 0; k < at.size(); ++k) sum += n[k] *= weight[k];
  for (size_t k = 0; k < at.size(); ++k) n[k] /= sum;
}

void CellGeometry::functions(Vec3 rst) const {
  shape->functions(rst, n, dn);
  if (weight.empty()) return;
  double sum = 0;
  Vec3 slope;
  for (size_t k = 0; k < at.size(); ++k) sum += n[k] *= weight[k], slope += dn[k] = dn[k] * weight[k];
  for (size_t k = 0; k < at.size(); ++k) {
    n[k] /= sum;
    dn[k] = (dn[k] - slope * n[k]) / sum;
  }
}

Vec3 CellGeometry::position(Vec3 rst) const {
  values(rst);
  Vec3 x;
  for (size_t k = 0; k < at.size(); ++k) x += at[k] * n[k];
  return x;
}

Vec3 CellGeometry::frame(Vec3 rst, Vec3 column[3]) const {
  functions(rst);
  // Relative to the first node: far from zero, the sum of the weights times a large number would lose digits.
  const Vec3 base = at[0];
  Vec3 x, c0, c1, c2;
  for (size_t k = 1; k < at.size(); ++k) {
    const Vec3 p = at[k] - base, d = dn[k];
    x += p * n[k];
    c0 += p * d.x, c1 += p * d.y, c2 += p * d.z;
  }
  column[0] = c0, column[1] = c1, column[2] = c2;
  return base + x;
}

namespace {

constexpr double done = 1e-9;  // a last step this small leaves an error of about its square

// Newton with steps of limited length. True when it converges, wherever that is.
bool newton(const CellGeometry& g, Vec3 x, Vec3& rst) {
  const Vec3 start = rst;
  for (int step = 0; step < 16; ++step) {
    Vec3 column[3], d;
    const Vec3 p = g.frame(rst, column);
    if (!solve_columns(column, x - p, d)) return false;
    const double l2 = dot(d, d);
    if (!(l2 < 1e30)) return false;
    if (l2 > 1) d *= 1 / std::sqrt(l2);
    rst += d;
    if (l2 < done * done) return true;
    if (const Vec3 way = rst - start; dot(way, way) > 9) return false;
  }
  return false;
}

// [0,1]^3 onto the reference element, collapsing sides.
Vec3 from_cube(CellType base, Vec3 c) {
  switch (base) {
    case CellType::triangle:
    case CellType::wedge: return {c.x, c.y * (1 - c.x), c.z};
    case CellType::tetra: return {c.x, c.y * (1 - c.x), c.z * (1 - c.x) * (1 - c.y)};
    case CellType::pyramid: return {0.5 + (c.x - 0.5) * (1 - c.z), 0.5 + (c.y - 0.5) * (1 - c.z), c.z};
    default: return c;
  }
}

// Whether a plane through the nearest face or corner found has x on one side and all nodes on the other.
bool separated(const CellGeometry& g, Vec3 x, Vec3 outside_rst) {
  Vec3 column[3];
  const Vec3 near = g.frame(g.shape->clamped(outside_rst), column);
  auto splits = [&](Vec3 d) {
    for (Vec3 p : g.at)
      if (!(dot(d, x - p) > 0)) return false;
    return true;
  };
  if (splits(x - near)) return true;
  // The face that rst violates most: its normal there is a row of the inverse Jacobian.
  const Vec3 out = outside_rst - g.shape->clamped(outside_rst);
  const double volume = dot(column[0], cross(column[1], column[2]));
  const Vec3 normal = cross(column[1], column[2]) * out.x + cross(column[2], column[0]) * out.y + cross(column[0], column[1]) * out.z;
  return splits(volume < 0 ? -normal : normal);
}

// The cell lies in the convex hull of its nodes: linear cells, and Bezier ones with positive weights.
bool in_hull_of_nodes(const CellGeometry& g) {
  if (g.shape->nodes() <= 8 && g.shape->type() == g.shape->base()) return true;
  if (!is_bezier(g.shape->type())) return g.shape->degree() == 1 && g.shape->orders()[0] == 1;
  for (double w : g.weight)
    if (!(w > 0)) return false;
  return true;
}

struct Part {
  Vec3 lo;
  double edge;
  int depth;
};
constexpr int deepest = 9;          // near a fold two solutions lie close together, one of them outside
constexpr size_t most_parts = 100;  // cells that fold over themselves would have thousands

Vec3 middle_of(const CellGeometry& g, const Part& part) { return from_cube(g.shape->base(), part.lo + Vec3(0.5, 0.5, 0.5) * part.edge); }

// Newton from the middle of a part; whether it ends in the cell.
bool inside_from(const CellGeometry& g, Vec3 x, const Part& part, double tolerance, InverseResult& best) {
  Vec3 rst = middle_of(g, part);
  if (!newton(g, x, rst)) return false;
  const double out = g.shape->outside(rst);
  if (out < best.outside) best = {rst, true, out};
  return out <= tolerance;
}

Part eighth(const Part& part, int c) {
  const double half = part.edge / 2;
  return {part.lo + Vec3(double(c & 1), double(c >> 1 & 1), double(c >> 2)) * half, half, part.depth + 1};
}

// Breadth first over the octree of the reference element: a part is tried and divided while its image may hold x.
bool search(const CellGeometry& g, Vec3 x, double tolerance, InverseResult& best) {
  const CellType base = g.shape->base();
  std::vector<Part> parts{{{0, 0, 0}, 1, 0}};
  for (size_t at = 0; at < parts.size() && at < most_parts; ++at) {
    const Part part = parts[at];
    const Vec3 middle = g.position(middle_of(g, part));
    double radius2 = 0;
    for (int c = 0; c < 8; ++c) {
      const Vec3 corner = g.position(from_cube(base, part.lo + Vec3(double(c & 1), double(c >> 1 & 1), double(c >> 2)) * part.edge));
      radius2 = std::max(radius2, dot(corner - middle, corner - middle));
    }
    const double slack = part.depth == 0 ? 4 : 1.7;  // squared: a curved part bulges beyond its corners
    if (!(dot(x - middle, x - middle) <= slack * radius2)) continue;
    if (inside_from(g, x, part, tolerance, best)) return true;
    if (part.depth < deepest)
      for (int c = 0; c < 8; ++c) parts.push_back(eighth(part, c));
  }
  return false;
}

// The same for linear cells, whose parts tell for sure that they do not hold x.
bool search_linear(const CellGeometry& g, Vec3 x, double tolerance, InverseResult& best) {
  struct LinearPart : Part {
    MultilinearPart image;
  };
  const CellType base = g.shape->base();
  // Of reference units across a part that the collapse of a side has made narrower.
  const auto margin = [&](double edge) { return 4 * tolerance / (edge * edge); };
  std::vector<LinearPart> parts(1);
  parts[0] = {{{0, 0, 0}, 1, 0}, {}};
  for (size_t c = 0; c < 8; ++c)
    parts[0].image.corner[c] = g.position(from_cube(base, Vec3(double(c & 1), double(c >> 1 & 1), double(c >> 2))));
  if (parts[0].image.excludes(x, margin(1))) return false;
  std::array<MultilinearPart, 8> eighths;
  for (size_t at = 0; at < parts.size() && at < most_parts; ++at) {
    const Part part = parts[at];
    if (inside_from(g, x, part, tolerance, best)) return true;
    if (part.depth == deepest) continue;
    parts[at].image.divide(eighths);
    for (int c = 0; c < 8; ++c)
      if (const MultilinearPart& image = eighths[size_t(c)]; !image.excludes(x, margin(part.edge / 2)))
        parts.push_back({eighth(part, c), image});
  }
  return false;
}

bool is_linear(const CellGeometry& g) { return g.shape->type() == g.shape->base() && g.shape->nodes() <= 8 && g.weight.empty(); }

}  // namespace

InverseResult invert_solid(const CellGeometry& g, Vec3 x, double tolerance) {
  InverseResult r;
  r.rst = g.shape->center();
  Box3 box;
  for (Vec3 p : g.at) box.add(p);
  const Vec3 size = box.size();
  const double volume = size.x * size.y * size.z;
  if (!(volume > 0 && volume < HUGE_VAL)) return r;  // none, or beyond what doubles multiply: the Jacobian is singular all over
  const bool hull = in_hull_of_nodes(g);
  // Linear cells stay in the box of their nodes; curved ones may bulge a little.
  const Vec3 margin = size * (hull ? tolerance : 0.5);
  bool possible = true;
  for (int a = 0; a < 3; ++a) possible = possible && x[a] >= box.lo[a] - margin[a] && x[a] <= box.hi[a] + margin[a];
  if (!possible) {
    // One step gives the direction, for walking from cell to cell.
    Vec3 column[3], d;
    const Vec3 p = g.frame(r.rst, column);
    if (solve_columns(column, x - p, d)) r = {r.rst + d, true, 0};
    r.outside = r.found ? std::max(g.shape->outside(r.rst), 2 * tolerance + 1e-9) : r.outside;
    return r;
  }
  if (newton(g, x, r.rst)) {
    r.found = true;
    r.outside = g.shape->outside(r.rst);
    if (r.outside <= tolerance) return r;
    // A second solution may be inside, unless a plane between x and the nodes excludes it.
    if (hull && separated(g, x, r.rst)) return r;
  } else {
    r = {};
    r.rst = g.shape->center();
  }
  if (is_linear(g)) search_linear(g, x, tolerance, r);
  else search(g, x, tolerance, r);
  return r;
}

// ---- curves and surfaces ------------------------------------------------------------------------------------------------------

Vec3 nearest_on_segment(Vec3 a, Vec3 b, Vec3 x, double& t) {
  const Vec3 d = b - a;
  const double l2 = dot(d, d);
  t = l2 > 0 ? std::clamp(dot(x - a, d) / l2, 0.0, 1.0) : 0;
  return t == 1 ? b : a + d * t;
}

Vec3 nearest_on_triangle(Vec3 a, Vec3 b, Vec3 c, Vec3 x, Vec3& l) {
  // The projection onto the plane when it falls inside, else the nearest point of the three sides.
  const Vec3 u = b - a, v = c - a, w = x - a, n = cross(u, v);
  const double n2 = dot(n, n);
  if (n2 > 0) {
    const double lb = dot(cross(w, v), n) / n2, lc = dot(cross(u, w), n) / n2;
    if (lb >= 0 && lc >= 0 && lb + lc <= 1) {
      l = {1 - lb - lc, lb, lc};
      return a + u * lb + v * lc;
    }
  }
  const Vec3 corner[3] = {a, b, c};
  double best = HUGE_VAL;
  Vec3 at = a;
  l = {1, 0, 0};
  for (int e = 0; e < 3; ++e) {
    double t;
    const Vec3 p = nearest_on_segment(corner[e], corner[(e + 1) % 3], x, t);
    const double d2 = dot(x - p, x - p);
    if (!(d2 < best)) continue;
    best = d2, at = p, l = {0, 0, 0};
    l[e] = 1 - t, l[(e + 1) % 3] = t;
  }
  return at;
}

namespace {

// p + r u + s v + r s w, 0 <= r, s <= 1: a quadrilateral of four corners.
struct BilinearPatch {
  Vec3 p, u, v, w;

  Vec3 position(Vec3 rst) const { return p + u * rst.x + v * rst.y + w * (rst.x * rst.y); }
  Vec3 frame(Vec3 rst, Vec3 column[3]) const {
    column[0] = u + w * rst.y, column[1] = v + w * rst.x, column[2] = Vec3();
    return position(rst);
  }
};

Vec3 clamped(const CellGeometry& g, Vec3 rst) { return g.shape->clamped(rst); }
Vec3 clamped(const BilinearPatch&, Vec3 rst) { return {std::clamp(rst.x, 0.0, 1.0), std::clamp(rst.y, 0.0, 1.0), 0}; }

template <class Shape>
double distance2(const Shape& g, Vec3 rst, Vec3 x) {
  const Vec3 d = g.position(rst) - x;
  return dot(d, d);
}

// Gauss-Newton by steps from step_of(rst, columns, miss), clamped to the element; steps that do not help are halved.
template <class Shape, class Move>
Vec3 descend(const Shape& g, Vec3 x, Vec3 rst, Move step_of) {
  double have = distance2(g, rst, x);
  for (int i = 0; i < 60; ++i) {
    Vec3 column[3];
    const Vec3 p = g.frame(rst, column);
    const Vec3 step = step_of(rst, column, x - p);
    double scale = 1;
    bool better = false;
    Vec3 next = rst;
    for (int half = 0; half < 12 && !better; ++half, scale /= 2) {
      next = clamped(g, rst + step * scale);
      if (next == rst) break;  // held by the rim, and shorter steps are held too
      const double d2 = distance2(g, next, x);
      better = d2 < have;
      if (better) have = d2;
    }
    if (!better) break;
    const Vec3 moved = next - rst;
    rst = next;
    if (dot(moved, moved) < 1e-23) break;
  }
  return rst;
}

Vec3 along(Vec3 direction, const Vec3 column[3], Vec3 miss) {
  const Vec3 tangent = column[0] * direction.x + column[1] * direction.y;
  const double l2 = dot(tangent, tangent);
  return l2 > 0 ? direction * (dot(tangent, miss) / l2) : Vec3();
}

Vec3 in_plane(const Vec3 column[3], Vec3 miss) {
  const double a = dot(column[0], column[0]), b = dot(column[0], column[1]), c = dot(column[1], column[1]);
  const double det = a * c - b * b, p = dot(column[0], miss), q = dot(column[1], miss);
  if (!(det > 1e-14 * a * c)) return a > c ? Vec3(p / a, 0, 0) : c > 0 ? Vec3(0, q / c, 0) : Vec3();
  return {(c * p - b * q) / det, (a * q - b * p) / det, 0};
}

Vec3 nearest_on_curve(const CellGeometry& g, Vec3 x, Vec3 from, Vec3 to, int pieces) {
  double best = HUGE_VAL;
  Vec3 start = from, last = g.position(from);
  for (int i = 1; i <= pieces; ++i) {
    const Vec3 here = g.position(lerp(from, to, double(i) / pieces));
    double t;
    const Vec3 d = nearest_on_segment(last, here, x, t) - x;
    if (dot(d, d) < best) best = dot(d, d), start = lerp(from, to, (i - 1 + t) / pieces);
    last = here;
  }
  const Vec3 direction = to - from;
  return descend(g, x, start, [&](Vec3, const Vec3* column, Vec3 miss) { return along(direction, column, miss); });
}

// The quick way for points that lie on the cell: a few plain steps from the centre. False when they do not end on x.
bool on_cell(const CellGeometry& g, Vec3 x, Vec3& rst) {
  const bool curve = g.shape->dimension() == 1;
  rst = g.shape->center();
  for (int i = 0; i < 8; ++i) {
    Vec3 column[3];
    const Vec3 miss = x - g.frame(rst, column);
    const Vec3 step = curve ? along({1, 0, 0}, column, miss) : in_plane(column, miss);
    const double l2 = dot(step, step);
    if (!(l2 < 4)) return false;
    if (l2 > 1e-24) {
      rst += step;
      continue;
    }
    const double extent2 = dot(column[0], column[0]) + dot(column[1], column[1]);
    return g.shape->outside(rst) <= 0 && dot(miss, miss) <= 1e-24 * extent2;
  }
  return false;
}

// The place nearest to x on the triangles between (pieces + 1)^2 samples of a surface over [0,1]^2, folded onto its element by `place`.
template <class Shape, class Place>
Vec3 nearest_of_samples(const Shape& g, Vec3 x, int pieces, Place&& place) {
  std::array<Vec3, 21 * 21> sample;  // curved cells have at most order 10
  for (int j = 0, n = 0; j <= pieces; ++j)
    for (int i = 0; i <= pieces; ++i) sample[size_t(n++)] = g.position(place(i, j));
  double best = HUGE_VAL;
  Vec3 start;
  for (int j = 0; j < pieces; ++j)
    for (int i = 0; i < pieces; ++i)
      for (int half = 0; half < 2; ++half) {
        const int ij[3][2] = {{i, j}, {i + 1, j + half}, {i + 1 - half, j + 1}};
        auto at = [&](int c) { return sample[size_t(ij[c][0] + (pieces + 1) * ij[c][1])]; };
        Vec3 l;
        const Vec3 d = nearest_on_triangle(at(0), at(1), at(2), x, l) - x;
        if (!(dot(d, d) < best)) continue;
        best = dot(d, d);
        start = place(ij[0][0], ij[0][1]) * l.x + place(ij[1][0], ij[1][1]) * l.y + place(ij[2][0], ij[2][1]) * l.z;
      }
  return start;
}

Vec3 step_in_plane(Vec3, const Vec3* column, Vec3 miss) { return in_plane(column, miss); }

Vec3 nearest_on_bilinear(const BilinearPatch& b, Vec3 x) {
  constexpr int pieces = 2;
  const Vec3 start = nearest_of_samples(b, x, pieces, [](int i, int j) { return Vec3(double(i) / pieces, double(j) / pieces, 0); });
  Vec3 rst = descend(b, x, start, step_in_plane);
  if (std::min(std::min(rst.x, 1 - rst.x), std::min(rst.y, 1 - rst.y)) > 1e-12) return rst;
  // It ended on the rim, where steps across are cut off: the sides themselves decide.
  double have = distance2(b, rst, x), t;
  const auto side = [&](Vec3 from, Vec3 to) {
    const Vec3 d = nearest_on_segment(b.position(from), b.position(to), x, t) - x;
    if (dot(d, d) < have) have = dot(d, d), rst = lerp(from, to, t);
  };
  side({0, 0, 0}, {1, 0, 0}), side({0, 1, 0}, {1, 1, 0}), side({0, 0, 0}, {0, 1, 0}), side({1, 0, 0}, {1, 1, 0});
  return descend(b, x, rst, step_in_plane);
}

}  // namespace

Vec3 nearest_reference(const CellGeometry& g, Vec3 x) {
  const CellType base = g.shape->base();
  if (base == CellType::vertex) return {0, 0, 0};
  if (base == CellType::line && g.at.size() == 2) {
    double t;
    nearest_on_segment(g.at[0], g.at[1], x, t);
    return {t, 0, 0};
  }
  if (base == CellType::triangle && g.at.size() == 3) {
    Vec3 l;
    nearest_on_triangle(g.at[0], g.at[1], g.at[2], x, l);
    return {l.y, l.z, 0};
  }
  if (g.at.size() == 4 && linear_topology(g.shape->type()) && g.shape->dimension() == 2) {
    const bool in_rows = g.shape->type() == CellType::pixel;
    const Vec3 p = g.at[0], u = g.at[1] - p, v = g.at[in_rows ? 2 : 3] - p;
    return nearest_on_bilinear({p, u, v, g.at[in_rows ? 3 : 2] - (p + u + v)}, x);
  }
  if (Vec3 rst; on_cell(g, x, rst)) return rst;
  const int order = std::max({g.shape->orders()[0], g.shape->orders()[1], 1});
  const int pieces = 2 * order;
  if (base == CellType::line) return nearest_on_curve(g, x, {0, 0, 0}, {1, 0, 0}, pieces);
  const Vec3 start = nearest_of_samples(g, x, pieces, [&](int i, int j) {
    return from_cube(base, {double(i) / pieces, double(j) / pieces, 0});
  });
  Vec3 rst = descend(g, x, start, step_in_plane);
  if (g.shape->outside(rst) < -1e-12) return rst;
  // It ended on the rim, where steps across are cut off: the rim's own curves decide.
  double have = distance2(g, rst, x);
  for (const auto& e : linear_topology(base)->edges) {
    const Vec3 q = nearest_on_curve(g, x, g.shape->node(e[0]), g.shape->node(e[1]), pieces);
    if (const double d2 = distance2(g, q, x); d2 < have) have = d2, rst = q;
  }
  return descend(g, x, rst, step_in_plane);
}

}  // namespace sg
