// SPDX-License-Identifier: Apache-2.0
#include "filter/surface/quality.h"

#include <fmt/core.h>

#include <algorithm>
#include <numbers>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "data/cells/shape/cell_shape.h"
#include "data/fields/known_looks.h"

namespace sg {

namespace {

using std::numbers::pi;
const double nan_value = std::nan("");

double triple(Vec3 a, Vec3 b, Vec3 c) { return dot(a, cross(b, c)); }

/// A cell as its corners (in quad, hexahedron... order) and its faces.
struct Cell {
  CellType type = CellType::empty;
  int dimension = 0;
  std::vector<Vec3> at;
  std::vector<std::vector<uint32_t>> faces;  // of a solid, seen from outside counter-clockwise
  std::vector<std::array<uint32_t, 2>> edges;

  void load(CellReader& reader) {
    type = linear_type(reader.type());
    dimension = reader.dimension();
    const LinearTopology* t = linear_topology(type);
    at.assign(reader.at().begin(), reader.at().end());
    if (t && size_t(t->corners) < at.size()) at.resize(size_t(t->corners));
    if (reader.type() == CellType::quadratic_polygon) at.resize(at.size() / 2);
    if (type == CellType::pixel) type = CellType::quad, std::swap(at[2], at[3]);
    if (type == CellType::voxel) type = CellType::hexahedron, std::swap(at[2], at[3]), std::swap(at[6], at[7]);
    t = linear_topology(type);
    faces.clear(), edges.clear();
    if (type == CellType::polyhedron) {
      for (size_t f = 0; f < reader.face_count(); ++f) faces.emplace_back(reader.face(f).begin(), reader.face(f).end());
    } else if (t) {
      for (size_t f = 0; f < t->face_count(); ++f) faces.emplace_back(t->face(f).begin(), t->face(f).end());
      for (const auto& e : t->edges) edges.push_back({e[0], e[1]});
    }
    if (type == CellType::wedge && volume() < 0) {  // the other way of listing it
      for (size_t k = 0; k < 3; ++k) std::swap(at[k], at[k + 3]);
    }
    const auto n = uint32_t(at.size());
    if (dimension == 2 && !t)
      for (uint32_t k = 0; k < n; ++k) edges.push_back({k, (k + 1) % n});
    if (dimension == 1 && !t)
      for (uint32_t k = 0; k + 1 < n; ++k) edges.push_back({k, k + 1});
    if (type == CellType::polyhedron)
      for (const auto& f : faces)
        for (size_t k = 0; k < f.size(); ++k)
          if (f[k] < f[(k + 1) % f.size()]) edges.push_back({f[k], f[(k + 1) % f.size()]});
  }
  std::vector<Vec3> corners_of(const std::vector<uint32_t>& f) const {
    std::vector<Vec3> r;
    for (uint32_t k : f) r.push_back(at[k]);
    return r;
  }
  bool faces_are_edges() const { return dimension == 2 && type != CellType::triangle_strip; }
  // Solids: exact for the straight or bilinear faces of the reference map; polyhedra by the triangles of their faces.
  double volume() const {
    if (const CellShape* shape = CellShape::find(type, at.size()); shape && dimension == 3) {
      const auto& q = shape->quadrature(4);
      std::vector<Vec3> dn(at.size());
      double sum = 0;
      for (size_t i = 0; i < q.at.size(); ++i) {
        shape->derivatives(q.at[i], dn.data());
        Vec3 r, s, t;
        for (size_t k = 0; k < at.size(); ++k)
          r += (at[k] - at[0]) * dn[k].x, s += (at[k] - at[0]) * dn[k].y, t += (at[k] - at[0]) * dn[k].z;
        sum += q.weight[i] * triple(r, s, t);
      }
      return sum;
    }
    double sum = 0;
    for (const auto& f : faces) {
      const std::vector<Vec3> c = corners_of(f);
      std::vector<uint32_t> t;
      triangulate_polygon(c, t);
      for (size_t k = 0; k + 2 < t.size(); k += 3) sum += triple(c[t[k]] - at[0], c[t[k + 1]] - at[0], c[t[k + 2]] - at[0]) / 6;
    }
    return type == CellType::polyhedron ? std::abs(sum) : sum;
  }
  double area() const {
    std::vector<uint32_t> t;
    tessellate_face(type, at, t);
    double sum = 0;
    for (size_t k = 0; k + 2 < t.size(); k += 3) sum += length(cross(at[t[k + 1]] - at[t[k]], at[t[k + 2]] - at[t[k]])) / 2;
    return sum;
  }
};

// Three neighbours of each corner, so that the ideal cell has positive determinants.
std::span<const std::array<uint8_t, 4>> frames(CellType type) {
  static constexpr std::array<uint8_t, 4> tet[] = {{0, 1, 2, 3}, {1, 2, 0, 3}, {2, 0, 1, 3}, {3, 0, 2, 1}};
  static constexpr std::array<uint8_t, 4> hex[] = {{0, 1, 3, 4}, {1, 2, 0, 5}, {2, 3, 1, 6}, {3, 0, 2, 7},
                                                   {4, 7, 5, 0}, {5, 4, 6, 1}, {6, 5, 7, 2}, {7, 6, 4, 3}};
  static constexpr std::array<uint8_t, 4> wedge[] = {{0, 1, 2, 3}, {1, 2, 0, 4}, {2, 0, 1, 5}, {3, 5, 4, 0}, {4, 3, 5, 1}, {5, 4, 3, 2}};
  static constexpr std::array<uint8_t, 4> pyramid[] = {{0, 1, 3, 4}, {1, 2, 0, 4}, {2, 3, 1, 4}, {3, 0, 2, 4}};
  switch (type) {
    case CellType::tetra: return tet;
    case CellType::hexahedron: return hex;
    case CellType::wedge: return wedge;
    case CellType::pyramid: return pyramid;
    default: return {};
  }
}

// Principal axes of a quad (two) or hexahedron (three): sums of opposite edges.
std::vector<Vec3> principal_axes(const Cell& c) {
  const auto& p = c.at;
  if (c.type == CellType::quad) return {p[1] - p[0] + (p[2] - p[3]), p[2] - p[1] + (p[3] - p[0])};
  return {p[1] - p[0] + (p[2] - p[3]) + (p[5] - p[4]) + (p[6] - p[7]), p[3] - p[0] + (p[2] - p[1]) + (p[7] - p[4]) + (p[6] - p[5]),
          p[4] - p[0] + (p[5] - p[1]) + (p[6] - p[2]) + (p[7] - p[3])};
}

double scaled_jacobian(const Cell& c) {
  const auto& p = c.at;
  if (c.type == CellType::triangle) {
    const Vec3 n = cross(p[1] - p[0], p[2] - p[0]);
    double most = 0;
    for (size_t k = 0; k < 3; ++k) most = std::max(most, length(p[(k + 1) % 3] - p[k]) * length(p[(k + 2) % 3] - p[k]));
    return most > 0 ? length(n) / most * 2 / std::sqrt(3.0) : 0;
  }
  if (c.type == CellType::quad) {
    const auto axes = principal_axes(c);
    const Vec3 n = normalize(cross(axes[0], axes[1]));
    double least = 1;
    for (size_t k = 0; k < 4; ++k) {
      const Vec3 a = p[(k + 1) % 4] - p[k], b = p[(k + 3) % 4] - p[k];
      const double l = length(a) * length(b);
      least = std::min(least, l > 0 ? dot(n, cross(a, b)) / l : 0.0);
    }
    return least;
  }
  const auto corners = frames(c.type);
  if (corners.empty()) return nan_value;
  double least = HUGE_VAL;
  if (c.type == CellType::tetra) {  // one determinant, the largest product of lengths
    double most = 0;
    for (const auto& f : corners) most = std::max(most, length(p[f[1]] - p[f[0]]) * length(p[f[2]] - p[f[0]]) * length(p[f[3]] - p[f[0]]));
    return most > 0 ? triple(p[1] - p[0], p[2] - p[0], p[3] - p[0]) * std::sqrt(2.0) / most : 0;
  }
  auto unit = [](Vec3 a, Vec3 b, Vec3 d) {
    const double l = length(a) * length(b) * length(d);
    return l > 0 ? triple(a, b, d) / l : 0.0;
  };
  for (const auto& f : corners) least = std::min(least, unit(p[f[1]] - p[f[0]], p[f[2]] - p[f[0]], p[f[3]] - p[f[0]]));
  if (c.type == CellType::hexahedron) {
    const auto a = principal_axes(c);
    least = std::min(least, unit(a[0], a[1], a[2]));
  }
  return least * (c.type == CellType::wedge ? 2 / std::sqrt(3.0) : c.type == CellType::pyramid ? std::sqrt(2.0) : 1);
}

// Condition number of the map from the ideal corner (unit edges) to the corner, by Frobenius norms; 1 is ideal.
double corner_condition(Vec3 a, Vec3 b, Vec3 d, CellType type) {
  // Columns of the inverse of the ideal frame: wedge (60 degrees in the base, upright), pyramid (square base, edges of length 1).
  Vec3 u, v, w;
  if (type == CellType::wedge) {
    u = a, v = (b * 2 - a) / std::sqrt(3.0), w = d;
  } else {  // apex edge of the ideal: (1/2, 1/2, 1/sqrt 2)
    u = a, v = b, w = (d - (a + b) * 0.5) * std::sqrt(2.0);
  }
  const double det = triple(u, v, w);
  if (!(det > 0)) return HUGE_VAL;
  const double norm = dot(u, u) + dot(v, v) + dot(w, w);
  const Vec3 x = cross(v, w), y = cross(w, u), z = cross(u, v);
  return std::sqrt(norm * (dot(x, x) + dot(y, y) + dot(z, z))) / (3 * det);
}

double aspect_ratio(const Cell& c) {
  const auto& p = c.at;
  double longest = 0, sum = 0;
  for (const auto& e : c.edges) {
    const double l = length(p[e[1]] - p[e[0]]);
    longest = std::max(longest, l), sum += l;
  }
  switch (c.type) {
    case CellType::triangle: {
      const double area = length(cross(p[1] - p[0], p[2] - p[0])) / 2;
      return area > 0 ? longest * sum / (4 * std::sqrt(3.0) * area) : HUGE_VAL;
    }
    case CellType::quad: {
      const double area = length(polygon_vector_area(p)) / 2;
      return area > 0 ? longest * sum / (4 * area) : HUGE_VAL;
    }
    case CellType::tetra: {
      double faces = 0;
      for (const auto& f : c.faces) faces += length(cross(p[f[1]] - p[f[0]], p[f[2]] - p[f[0]])) / 2;
      const double volume = std::abs(triple(p[1] - p[0], p[2] - p[0], p[3] - p[0])) / 6;
      return volume > 0 ? longest * faces / (6 * std::sqrt(6.0) * volume) : HUGE_VAL;
    }
    case CellType::hexahedron: {
      const auto a = principal_axes(c);
      const double l[3] = {length(a[0]), length(a[1]), length(a[2])};
      const double least = *std::min_element(l, l + 3);
      return least > 0 ? *std::max_element(l, l + 3) / least : HUGE_VAL;
    }
    case CellType::wedge:
    case CellType::pyramid: {
      double worst = 0;
      for (const auto& f : frames(c.type)) {
        Vec3 a = p[f[1]] - p[f[0]], b = p[f[2]] - p[f[0]];
        worst = std::max(worst, corner_condition(a, b, p[f[3]] - p[f[0]], c.type));
      }
      return worst;
    }
    default: return nan_value;
  }
}

double edge_ratio(const Cell& c) {
  double most = 0, least = HUGE_VAL;
  for (const auto& e : c.edges) {
    const double l = length(c.at[e[1]] - c.at[e[0]]);
    most = std::max(most, l), least = std::min(least, l);
  }
  return c.edges.empty() ? nan_value : least > 0 ? most / least : HUGE_VAL;
}

std::pair<double, double> corner_angles(const std::vector<Vec3>& p) {
  std::pair<double, double> r{HUGE_VAL, -HUGE_VAL};
  const size_t n = p.size();
  const Vec3 normal = polygon_vector_area(p);
  for (size_t k = 0; k < n; ++k) {
    const Vec3 a = p[(k + 1) % n] - p[k], b = p[(k + n - 1) % n] - p[k], x = cross(a, b);
    double angle = std::atan2(length(x), dot(a, b)) * 180 / pi;
    if (dot(x, normal) < 0) angle = 360 - angle;
    r.first = std::min(r.first, angle), r.second = std::max(r.second, angle);
  }
  return r;
}

// Smallest and largest angle: of corners, or between faces.
std::pair<double, double> angles(const Cell& c) {
  if (c.faces_are_edges() && c.at.size() > 2) return corner_angles(c.at);
  if (c.dimension != 3) return {nan_value, nan_value};
  std::pair<double, double> r{HUGE_VAL, -HUGE_VAL};
  const double sign = c.type != CellType::polyhedron && c.volume() < 0 ? -1 : 1;
  for (size_t f = 0; f < c.faces.size(); ++f)
    for (size_t g = 0; g < c.faces.size(); ++g)
      for (size_t k = 0; k < c.faces[f].size(); ++k) {
        // An edge from a to b of face f runs from b to a in face g.
        const uint32_t a = c.faces[f][k], b = c.faces[f][(k + 1) % c.faces[f].size()];
        const auto& other = c.faces[g];
        const auto at = size_t(std::find(other.begin(), other.end(), b) - other.begin());
        if (g == f || at == other.size() || other[(at + 1) % other.size()] != a) continue;
        const Vec3 m = polygon_vector_area(c.corners_of(c.faces[f])) * sign, n = polygon_vector_area(c.corners_of(other)) * sign;
        const Vec3 along = normalize(c.at[b] - c.at[a]) * sign;
        const double turn = std::atan2(dot(cross(m, n), along), dot(m, n)) * 180 / pi;
        r.first = std::min(r.first, 180 - turn), r.second = std::max(r.second, 180 - turn);
      }
  return r.second < 0 ? std::pair{nan_value, nan_value} : r;
}

double skew(const Cell& c) {
  if (c.type != CellType::quad && c.type != CellType::hexahedron) return nan_value;
  const auto a = principal_axes(c);
  double worst = 0;
  for (size_t i = 0; i < a.size(); ++i)
    for (size_t k = i + 1; k < a.size(); ++k) worst = std::max(worst, std::abs(dot(normalize(a[i]), normalize(a[k]))));
  return worst;
}

double equiangle_skew(const Cell& c) {
  auto of = [](const std::vector<Vec3>& p) {
    const auto [lo, hi] = corner_angles(p);
    const double ideal = 180 - 360.0 / double(p.size());
    return std::max((hi - ideal) / (180 - ideal), (ideal - lo) / ideal);
  };
  if (c.faces_are_edges() && c.at.size() > 2) return of(c.at);
  if (c.faces.empty()) return nan_value;
  double worst = 0;
  for (const auto& f : c.faces) worst = std::max(worst, of(c.corners_of(f)));
  return worst;
}

double size_of(const Cell& c) {
  if (c.dimension == 3) return c.volume();
  if (c.dimension == 2) return c.area();
  double sum = 0;
  for (const auto& e : c.edges) sum += length(c.at[e[1]] - c.at[e[0]]);
  return c.dimension == 1 ? sum : 0;
}

double measure(const Cell& c, CellMeasure m) {
  switch (m) {
    case CellMeasure::scaled_jacobian: return scaled_jacobian(c);
    case CellMeasure::aspect_ratio: return aspect_ratio(c);
    case CellMeasure::edge_ratio: return edge_ratio(c);
    case CellMeasure::min_angle: return angles(c).first;
    case CellMeasure::max_angle: return angles(c).second;
    case CellMeasure::skew: return skew(c);
    case CellMeasure::equiangle_skew: return equiangle_skew(c);
    case CellMeasure::size: return size_of(c);
  }
  return nan_value;
}

}  // namespace

DatasetPtr quality(const DatasetPtr& in, const QualityParams& p, Context& ctx) {
  if (p.measures.empty()) fail_usage("no measure is requested", "quality measures", "write e.g. measures=scaled_jacobian,aspect_ratio");
  if (in->as<PointCloud>()) fail_usage("a point cloud has no cells to measure", "quality");
  const CellReader first(in);
  const size_t n = first.count();
  std::vector<std::vector<double>> values(p.measures.size(), std::vector<double>(n, nan_value));
  const size_t grain = 2048;
  std::vector<size_t> curved((n + grain - 1) / grain, 0);
  parallel_for(
      n, grain,
      [&](size_t begin, size_t end) {
        CellReader reader = first;
        Cell cell;
        for (size_t c = begin; c < end; ++c) {
          reader.open(c);
          if (reader.ids().empty()) continue;
          curved[begin / grain] += is_high_order(reader.type());
          cell.load(reader);
          for (size_t m = 0; m < values.size(); ++m) values[m][c] = measure(cell, p.measures[m]);
        }
      },
      &ctx);
  if (const size_t bent = std::accumulate(curved.begin(), curved.end(), size_t(0)); bent > 0)
    ctx.info(fmt::format("quality: {} curved cells were assessed by their corners", bent));
  DatasetParts out = in->parts();
  for (size_t m = 0; m < values.size(); ++m) {
    const CellMeasure of = p.measures[m];
    const bool angle = of == CellMeasure::min_angle || of == CellMeasure::max_angle;
    out.fields.add({std::string(word_of(of)), Association::cell, Array::from_vector(std::move(values[m])), angle ? "deg" : "", Role::none});
  }
  if (!p.measures.empty()) mark_result(out.fields, word_of(p.measures[0]), Association::cell);
  return make_dataset(std::move(out));
}

}  // namespace sg
