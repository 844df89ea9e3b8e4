// SPDX-License-Identifier: Apache-2.0
// A velocity on every kind of mesh.
#pragma once
#include "filter/cell_meshes.h"
#include "filter/flow/flow_support.h"
#include "filter/flow/trace.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/surface/surface_shapes.h"

namespace sg::test::flow {

/// The mesh with the point field "u" of a function of position.
template <class T = double, class F>
DatasetPtr with_velocity(const DatasetPtr& mesh, F&& u, int components = 3) {
  DatasetParts parts = mesh->parts();
  parts.fields.add({"u", Association::point, at_points<T>(mesh->mesh(), u, components), "m/s", Role::vectors});
  return make_dataset(std::move(parts));
}

/// Every point moved.
template <class F>
DatasetPtr moved(const DatasetPtr& mesh, F&& f) {
  DatasetParts parts = mesh->parts();
  std::get<UnstructuredMesh>(parts.mesh).points = {at_points(mesh->mesh(), f), {}};
  return make_dataset(std::move(parts));
}

inline UniformGrid uniform_cube(size_t n, double r) { return uniform({n, n, n}, {-r, -r, -r}, {r, r, r}); }

/// Two levels over [-r,r]^3: n^3 cells, and a patch of half the spacing in the middle; points carry fields.
inline DatasetPtr amr_cube(int n, double r) {
  AmrGrid g;
  g.origin = {-r, -r, -r};
  const double h = 2 * r / n;
  g.levels.resize(2);
  g.levels[0].spacing = {h, h, h}, g.levels[0].ratio = {1, 1, 1};
  g.levels[1].spacing = {h / 2, h / 2, h / 2}, g.levels[1].ratio = {2, 2, 2};
  const long long a = n / 4, b = n - n / 4 - 1;
  g.levels[0].patches.push_back({{0, 0, 0}, {n - 1, n - 1, n - 1}, 0, 0});
  const size_t m = size_t(n);
  g.levels[1].patches.push_back({{2 * a, 2 * a, 2 * a}, {2 * b + 1, 2 * b + 1, 2 * b + 1}, m * m * m, (m + 1) * (m + 1) * (m + 1)});
  std::vector<uint8_t> ghost(cell_count(Mesh(g)));
  for (long long k = a; k <= b; ++k)
    for (long long j = a; j <= b; ++j)
      for (long long i = a; i <= b; ++i) ghost[size_t(i) + m * (size_t(j) + m * size_t(k))] = ghost_refined_cell;
  DatasetParts parts;
  parts.mesh = std::move(g);
  parts.cell_ghost = Array::from_vector(std::move(ghost));
  return make_dataset(std::move(parts));
}

/// Solids about [-r,r]^3 of about n cells an axis, of every kind; fields that are linear in space are exact in them.
inline const std::vector<std::string>& kinds() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> k{"uniform", "rotated", "rectilinear", "curvilinear", "amr"};
    for (const std::string& s : solid_kinds()) k.push_back(s);
    k.insert(k.end(),
             {"bent hexahedron", "bent tetra", "quadratic tetra", "quadratic hexahedron", "lagrange hexahedron", "lagrange wedge"});
    return k;
  }();
  return all;
}

inline DatasetPtr mesh_of(const std::string& kind, int n, double r) {
  const auto s = size_t(n + 1);
  if (kind == "uniform") return make_dataset(uniform_cube(s, r));
  if (kind == "rotated") {  // and of unequal spacing
    UniformGrid g;
    g.dims = {s + 2, s, s - 1};
    const Vec3 a = normalize(Vec3(1, 2, 0.5)), b = normalize(cross(a, Vec3(0, 0, 1))), c = cross(a, b);
    for (int i = 0; i < 3; ++i) g.direction.m[i][0] = a[i], g.direction.m[i][1] = b[i], g.direction.m[i][2] = c[i];
    for (int i = 0; i < 3; ++i) g.spacing[i] = 3.2 * r / double(g.dims[size_t(i)] - 1);
    g.origin = g.direction * Vec3(-1.6 * r, -1.6 * r, -1.6 * r);
    return make_dataset(g);
  }
  if (kind == "rectilinear") {
    RectilinearGrid g;
    const auto axis = [&](double bend, bool down) {
      std::vector<double> x;
      for (size_t i = 0; i < s; ++i) {
        const double f = 2 * double(i) / double(n) - 1;
        x.push_back((down ? -r : r) * (f + bend * f * (1 - f * f)));
      }
      return Array::from_vector(std::move(x));
    };
    g.x = axis(0.3, false), g.y = axis(-0.4, true), g.z = axis(0.2, false);
    return make_dataset(g);
  }
  if (kind == "curvilinear") {
    CurvilinearGrid g;
    g.dims = {s, s, s};
    std::vector<double> xyz;
    for (size_t k = 0; k < s; ++k)
      for (size_t j = 0; j < s; ++j)
        for (size_t i = 0; i < s; ++i) {
          const Vec3 q = Vec3(double(i), double(j), double(k)) * (2 * r / n) - Vec3(r, r, r);
          const Vec3 p = q + 0.08 * r * Vec3(std::sin(2 * q.y / r), std::sin(2 * q.z / r), std::cos(2 * q.x / r));
          xyz.insert(xyz.end(), {p.x, p.y, p.z});
        }
    g.points.xyz = Array::from_vector(std::move(xyz), 3);
    return make_dataset(std::move(g));
  }
  if (kind == "amr") return amr_cube(n, r);
  const auto nothing = [](Vec3) { return 0.0; };
  if (kind == "bent hexahedron") return solid_mesh("hexahedron", n, r, nothing, 0.08 * r);
  if (kind == "bent tetra") return solid_mesh("tetra", n, r, nothing, 0.08 * r);
  const auto curved = [&](CellType type, int order) {
    return moved(meshes::solid_box(type, std::max(2, n / 2), order), [&](Vec3 p) { return (2 * p - Vec3(1, 1, 1)) * r; });
  };
  if (kind == "quadratic tetra") return curved(CellType::quadratic_tetra, 2);
  if (kind == "quadratic hexahedron") return curved(CellType::quadratic_hexahedron, 2);
  if (kind == "lagrange hexahedron") return curved(CellType::lagrange_hexahedron, 3);
  if (kind == "lagrange wedge") return curved(CellType::lagrange_wedge, 3);
  return solid_mesh(kind, n, r, nothing);
}

/// One line forward from a seed, by a scheme with fixed steps in time.
inline TracedLines line_from(const DatasetPtr& mesh, Vec3 seed, const TraceOptions& o, TraceDirection direction = TraceDirection::forward) {
  Context context;
  const FlowField field(mesh, "u", context);
  const Vec3 seeds[] = {seed};
  return trace_lines(field, seeds, direction, o, context);
}

}  // namespace sg::test::flow
