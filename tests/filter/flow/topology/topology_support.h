// SPDX-License-Identifier: Apache-2.0
// Meshes with velocities for the tests of flow topology.
#pragma once
#include <vector>

#include "data/cells/shape/cell_shape.h"
#include "filter/flow/flow_support.h"
#include "filter/flow/topology/critical_points.h"
#include "filter/mesh/mesh_meshes.h"

namespace sg::test::topology {

/// The mesh with the point field "velocity" = f(position).
template <class F>
DatasetPtr with_velocity(const DatasetPtr& d, F&& f) {
  return velocity_on(d->mesh(), f);
}

/// [x0,x1] x [y0,y1] as nx*ny points.
template <class F>
DatasetPtr plane_grid(size_t nx, size_t ny, double x0, double x1, double y0, double y1, F&& f) {
  UniformGrid g;
  g.dims = {nx, ny, 1};
  g.origin = {x0, y0, 0};
  g.spacing = {(x1 - x0) / double(nx - 1), (y1 - y0) / double(ny - 1), 1};
  return with_velocity(make_dataset(g), f);
}

/// [-1,1]^2 in n*n blocks of flat cells of one type, each with points of its own; triangles: two a block. `place` moves the points.
template <class P>
DatasetPtr plane_cells(CellType type, size_t nodes, int n, P&& place) {
  const bool polygon = type == CellType::polygon, strip = type == CellType::triangle_strip;
  const CellShape* shape = polygon || strip ? CellShape::find(CellType::quad, 4) : CellShape::find(type, nodes);
  const bool simplex = shape->base() == CellType::triangle;
  std::vector<double> xyz;
  std::vector<int64_t> ids, offsets{0};
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      for (int half = 0; half < (simplex ? 2 : 1); ++half) {
        for (size_t k = 0; k < shape->nodes(); ++k) {
          const size_t node = strip && k >= 2 ? 5 - k : k;
          const Vec3 r = shape->node(node), u = half ? Vec3(1 - r.x, 1 - r.y, 0) : r;
          const Vec3 p = place(Vec3(-1 + 2 * (i + u.x) / n, -1 + 2 * (j + u.y) / n, 0));
          ids.push_back(int64_t(xyz.size() / 3));
          xyz.insert(xyz.end(), {p.x, p.y, p.z});
        }
        offsets.push_back(int64_t(ids.size()));
      }
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.cells.connectivity = Array::from_vector(std::move(ids));
  m.cells.offsets = Array::from_vector(std::move(offsets));
  m.single_type = type;
  return make_dataset(std::move(m));
}

/// The cube [lo, hi]^3 with n points a side.
template <class F>
DatasetPtr cube_grid(size_t n, double lo, double hi, F&& f) {
  return cube_flow(n, lo, hi, f);
}

inline Vec3 taylor_green(Vec3 x) { return {std::cos(x.x) * std::sin(x.y), -std::sin(x.x) * std::cos(x.y), 0}; }
/// Arnold, Beltrami, Childress with A = B = C = 1.
inline Vec3 abc(Vec3 x) { return {std::sin(x.z) + std::cos(x.y), std::sin(x.x) + std::cos(x.z), std::sin(x.y) + std::cos(x.x)}; }
/// Shadden, Lekien, Marsden 2005; `swing` = eps sin(omega t).
inline Vec3 double_gyre(Vec3 x, double swing) {
  const double f = swing * x.x * x.x + (1 - 2 * swing) * x.x, slope = 2 * swing * x.x + 1 - 2 * swing;
  return {-0.1 * M_PI * std::sin(M_PI * f) * std::cos(M_PI * x.y), 0.1 * M_PI * std::cos(M_PI * f) * std::sin(M_PI * x.y) * slope, 0};
}

inline CriticalPoints zeros_of(const DatasetPtr& d, double centre = 1e-3) {
  Context context;
  const FlowField flow(d, "", context);
  return find_critical_points(flow, {.centre = centre}, context);
}
inline int index_sum(const CriticalPoints& p) {
  int sum = 0;
  for (const auto& c : p.points) sum += c.index;
  return sum;
}
inline size_t count_of(const CriticalPoints& p, CriticalType type) {
  size_t n = 0;
  for (const auto& c : p.points) n += c.flow.type == type;
  return n;
}

inline Mat3 matrix(double a, double b, double c, double d, double e, double f, double g, double h, double i) {
  Mat3 m;
  const double v[9] = {a, b, c, d, e, f, g, h, i};
  for (int k = 0; k < 9; ++k) m.m[k / 3][k % 3] = v[k];
  return m;
}

}  // namespace sg::test::topology
