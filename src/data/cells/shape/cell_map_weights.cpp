// SPDX-License-Identifier: Apache-2.0
// Interpolation weights, gradients and integrals of the open cell.
#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "data/cells/shape/cell_map.h"
#include "data/cells/shape/cell_map_geometry.h"
#include "data/cells/shape/mean_value.h"

namespace sg {

void CellMap::weights(const CellPlace& place, std::span<double> out) {
  if (out.size() != reader_.ids().size())
    fail_internal(fmt::format("room for {} weights, but the cell has {} points", out.size(), reader_.ids().size()));
  if (!shape_) return pieces_weights(place, out);
  CellGeometry g = Geometry(*this);
  g.n = out.data();
  g.values(place.rst);
}

void CellMap::pieces_weights(const CellPlace& place, std::span<double> out) {
  std::fill(out.begin(), out.end(), 0.0);
  const auto at = reader_.at();
  const auto piece = size_t(std::max(place.rst.z, 0.0));
  switch (reader_.type()) {
    case CellType::poly_vertex:
      if (piece < out.size()) out[piece] = 1;
      return;
    case CellType::poly_line:
      if (piece + 1 < out.size()) out[piece] = 1 - place.rst.x, out[piece + 1] = place.rst.x;
      else if (!out.empty()) out[0] = 1;
      return;
    case CellType::triangle_strip: {
      const auto& t = triangles();
      if (3 * piece + 2 >= t.size()) return;
      out[t[3 * piece]] += 1 - place.rst.x - place.rst.y;
      out[t[3 * piece + 1]] += place.rst.x;
      out[t[3 * piece + 2]] += place.rst.y;
      return;
    }
    case CellType::polygon:
    case CellType::quadratic_polygon: {
      face_outline(reader_.type(), at.size(), ring_);
      ring_at_.clear();
      for (uint32_t i : ring_) ring_at_.push_back(at[i]);
      ring_weights_.resize(ring_.size());
      polygon_weights(ring_at_, place.nearest, ring_weights_);
      for (size_t i = 0; i < ring_.size(); ++i) out[ring_[i]] = ring_weights_[i];
      return;
    }
    default:
      if (dimension() == 3) solid_weights(at, triangles(), place.nearest, out);
  }
}

// ---- gradients ------------------------------------------------------------------------------------------------------------------

void CellMap::gradient_weights(const CellPlace& place, std::span<Vec3> out) {
  std::fill(out.begin(), out.end(), Vec3());
  const auto at = reader_.at();
  if (shape_) {
    const Geometry g(*this);
    Vec3 column[3];
    g.frame(place.rst, column);
    // Rows of the (pseudo-)inverse Jacobian: gradients of r, s and t.
    Vec3 row[3];
    if (dimension() == 3) {
      const double volume = dot(column[0], cross(column[1], column[2]));
      for (int a = 0; a < 3; ++a) row[a] = cross(column[(a + 1) % 3], column[(a + 2) % 3]) / volume;
    } else if (dimension() == 2) {
      const Vec3 normal = cross(column[0], column[1]);
      const double area2 = dot(normal, normal);
      row[0] = cross(column[1], normal) / area2, row[1] = cross(normal, column[0]) / area2;
    } else if (dimension() == 1) {
      row[0] = column[0] / dot(column[0], column[0]);
    }
    for (size_t k = 0; k < at.size(); ++k) out[k] = row[0] * g.dn[k].x + row[1] * g.dn[k].y + row[2] * g.dn[k].z;
    return;
  }
  const auto piece = size_t(std::max(place.rst.z, 0.0));
  if (dimension() == 1) {
    if (piece + 1 >= at.size()) return;
    const Vec3 d = at[piece + 1] - at[piece];
    if (!(dot(d, d) > 0)) return;
    out[piece + 1] = d / dot(d, d), out[piece] = -out[piece + 1];
  } else if (reader_.type() == CellType::triangle_strip) {
    const auto& t = triangles();
    if (3 * piece + 2 >= t.size()) return;
    const Vec3 a = at[t[3 * piece]], u = at[t[3 * piece + 1]] - a, v = at[t[3 * piece + 2]] - a, normal = cross(u, v);
    const double area2 = dot(normal, normal);
    out[t[3 * piece + 1]] = cross(v, normal) / area2, out[t[3 * piece + 2]] = cross(normal, u) / area2;
    out[t[3 * piece]] = -(out[t[3 * piece + 1]] + out[t[3 * piece + 2]]);
  } else if (dimension() > 0) {
    fitted_gradient(place.nearest, out);
  }
}

// The plane or linear function through the node values with the least squares.
void CellMap::fitted_gradient(Vec3, std::span<Vec3> out) const {
  const auto at = reader_.at();
  Vec3 middle;
  for (Vec3 p : at) middle += p / double(at.size());
  Vec3 column[3];
  double trace = 0;
  for (Vec3 p : at) {
    const Vec3 d = p - middle;
    for (int a = 0; a < 3; ++a) column[a] += d * d[a];
    trace += dot(d, d);
  }
  Vec3 normal;
  if (dimension() == 2) {
    // Nothing varies across the plane: make that direction solvable, then take it out.
    std::vector<uint32_t> ring;
    face_outline(reader_.type(), at.size(), ring);
    std::vector<Vec3> p;
    for (uint32_t i : ring) p.push_back(at[i]);
    normal = normalize(polygon_vector_area(p));
    for (int a = 0; a < 3; ++a) column[a] += normal * (normal[a] * trace);
  }
  for (size_t k = 0; k < at.size(); ++k) {
    Vec3 g;
    if (!solve_columns(column, at[k] - middle, g)) g = {};
    out[k] = g - normal * dot(normal, g);
  }
  // The fit's constant takes up the mean: the weights sum to zero by themselves.
}

Vec3 CellMap::gradient(const CellPlace& place, std::span<const double> node_values) {
  std::vector<Vec3> g(node_values.size());
  gradient_weights(place, g);
  Vec3 sum;
  for (size_t k = 0; k < g.size(); ++k) sum += g[k] * node_values[k];
  return sum;
}

// ---- integrals ------------------------------------------------------------------------------------------------------------------

// The integral of |dx| over the cell (signed for solids), and of each node's weight when asked for.
double CellMap::integrate(double* weights) {
  const Geometry g(*this);
  const auto o = shape_->orders();
  const int n = std::max({o[0], o[1], o[2]}), d = dimension();
  const bool linear = shape_->type() == shape_->base();
  // The Jacobian determinant of a solid is a polynomial; lengths and areas of bent cells and rational ones are not.
  int degree = d == 3 ? (shape_->base() == CellType::tetra ? 3 * (n - 1) : 3 * n - (linear ? 0 : 1)) : d == 2 ? 2 * n : 0;
  if (shape_->base() == CellType::pyramid) degree = linear ? 3 : 12;
  if (reader_.type() == CellType::lagrange_tetra && g.at.size() == 15) degree = 9;  // bubbles of degree 3 and 4
  if (reader_.type() == CellType::lagrange_wedge && g.at.size() == 21) degree = 8;
  if (d == 2 && shape_->base() != CellType::triangle) degree += 6;
  if (d < 3 && !linear) degree += 12;
  if (!g.weight.empty()) degree += 10;
  if (weights) degree += n;
  const CellShape::Quadrature& q = shape_->quadrature(degree);
  double sum = 0;
  for (size_t i = 0; i < q.at.size(); ++i) {
    Vec3 column[3];
    g.frame(q.at[i], column);
    const double jacobian = d == 3   ? dot(column[0], cross(column[1], column[2]))
                            : d == 2 ? length(cross(column[0], column[1]))
                            : d == 1 ? length(column[0])
                                     : 1;
    const double w = q.weight[i] * jacobian;
    sum += w;
    for (size_t k = 0; weights && k < g.at.size(); ++k) weights[k] += w * g.n[k];
  }
  return sum;
}

// Polygons, polyhedra, strips, poly-lines: simplices from the middle of the nodes, whose value is their mean. Exact for linear
// fields, whatever the shape.
double CellMap::integrate_pieces(double* weights) {
  const auto at = reader_.at();
  const size_t n = at.size();
  double sum = 0, middle_weight = 0;
  if (dimension() == 0) {
    for (size_t k = 0; weights && k < n; ++k) weights[k] = 1;
    return double(n);
  }
  if (dimension() == 1) {
    for (size_t i = 0; i + 1 < n; ++i) {
      const double l = length(at[i + 1] - at[i]);
      sum += l;
      if (weights) weights[i] += l / 2, weights[i + 1] += l / 2;
    }
    return sum;
  }
  const auto& t = triangles();
  if (dimension() == 2) {
    for (size_t i = 0; i + 2 < t.size(); i += 3) {
      const double area = length(cross(at[t[i + 1]] - at[t[i]], at[t[i + 2]] - at[t[i]])) / 2;
      sum += area;
      for (size_t c = 0; weights && c < 3; ++c) weights[t[i + c]] += area / 3;
    }
    return sum;
  }
  Vec3 middle;
  for (Vec3 p : at) middle += p / double(n);
  for (size_t i = 0; i + 2 < t.size(); i += 3) {
    const double v = dot(at[t[i]] - middle, cross(at[t[i + 1]] - middle, at[t[i + 2]] - middle)) / 6;
    sum += v;
    for (size_t c = 0; weights && c < 3; ++c) weights[t[i + c]] += v / 4;
    middle_weight += v / 4;
  }
  for (size_t k = 0; weights && k < n; ++k) weights[k] += middle_weight / double(n);
  return sum;
}

double CellMap::measure() {
  const auto at = reader_.at();
  if (!shape_) return integrate_pieces(nullptr);
  switch (reader_.type()) {
    case CellType::vertex: return 1;
    case CellType::line: return length(at[1] - at[0]);
    case CellType::triangle: return length(cross(at[1] - at[0], at[2] - at[0])) / 2;
    case CellType::tetra: return dot(at[1] - at[0], cross(at[2] - at[0], at[3] - at[0])) / 6;
    default: return integrate(nullptr);
  }
}

void CellMap::integration_weights(std::span<double> out) {
  std::fill(out.begin(), out.end(), 0.0);
  if (!shape_) {
    integrate_pieces(out.data());
    return;
  }
  if (integrate(out.data()) < 0)
    for (double& w : out) w = -w;
}

}  // namespace sg
