// SPDX-License-Identifier: Apache-2.0
// The same function on every kind of mesh: what tables of tests run over.
#pragma once
#include <functional>

#include "filter/field/sampling/point_cell.h"
#include "filter/flow/flow_meshes.h"
#include "filter/flow/topology/topology_support.h"
#include "filter/mesh/merge_points.h"

namespace sg::test {

/// The box [-r,r]^3 in n^3 blocks of cells of one type, whose nodes lie where its reference element has them; corners as in solid_mesh.
inline DatasetPtr solid_cells(CellType type, size_t nodes, int n, double r) {
  const CellShape& shape = *CellShape::find(type, nodes);
  const CellType base = shape.base();
  const char* kind = base == CellType::tetra     ? "tetra"
                     : base == CellType::wedge   ? "wedge"
                     : base == CellType::pyramid ? "pyramid"
                                                 : "hexahedron";
  const DatasetPtr blocks = solid_mesh(kind, n, r, [](Vec3) { return 0.0; });
  const auto& from = *blocks->as<UnstructuredMesh>();
  const CellsView cells = cells_view(from.cells);
  const CellShape& corners = *CellShape::find(base, cells.size(0));
  UnstructuredMesh m;
  std::vector<double> xyz, weights(corners.nodes());
  std::vector<int64_t> ids, offsets{0};
  for (size_t c = 0; c < cells.count; ++c) {
    for (size_t k = 0; k < nodes; ++k) {
      corners.values(shape.node(k), weights.data());
      Vec3 p;
      for (size_t j = 0; j < corners.nodes(); ++j) p += from.points.at(size_t(cells.point(c, j))) * weights[j];
      ids.push_back(int64_t(xyz.size() / 3));
      xyz.insert(xyz.end(), {p.x, p.y, p.z});
    }
    offsets.push_back(int64_t(ids.size()));
  }
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.cells.connectivity = Array::from_vector(std::move(ids)), m.cells.offsets = Array::from_vector(std::move(offsets));
  m.single_type = type;
  Context context;
  return merge_points(make_dataset(std::move(m)), {.tolerance = 1e-9 * r}, context);
}

/// [-r,r]^2 as a surface of n x n squares: "triangles" (two each), "quads", "polygons" (hexagons of two squares) or "strips".
inline DatasetPtr flat_surface(const std::string& kind, int n, double r) {
  shapes::Builder b;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) b.point({r * (2.0 * i / n - 1), r * (2.0 * j / n - 1), 0});
  const auto at = [n](int i, int j) { return int64_t(i + (n + 1) * j); };
  for (int j = 0; j < n; ++j) {
    std::vector<int64_t> strip;
    for (int i = 0; i < n; ++i) {
      const int64_t a = at(i, j), c = at(i, j + 1);
      if (kind == "triangles") b.polygon({a, a + 1, c + 1}), b.polygon({a, c + 1, c});
      if (kind == "quads") b.polygon({a, a + 1, c + 1, c});
      if (kind == "polygons" && i % 2 == 0)
        b.polygon(i + 2 <= n ? std::vector{a, a + 1, a + 2, c + 2, c + 1, c} : std::vector{a, a + 1, c + 1, c});
      strip.insert(strip.end(), {c, a});
    }
    if (kind == "strips") strip.insert(strip.end(), {at(n, j + 1), at(n, j)}), b.polygon(strip);
  }
  SurfaceMesh m = b.mesh();
  if (kind == "strips") std::swap(m.polygons, m.strips);
  return make_dataset(std::move(m));
}

/// Two levels over [-r,r]^2: n^2 cells, and a patch of half the spacing in the middle.
inline DatasetPtr flat_amr(int n, double r) {
  AmrGrid g;
  g.dimension = 2, g.origin = {-r, -r, 0};
  const double h = 2 * r / n;
  const long long a = n / 4, b = n - n / 4 - 1;
  const auto m = size_t(n);
  g.levels.resize(2);
  g.levels[0] = {{h, h, 1}, {1, 1, 1}, {{{0, 0, 0}, {n - 1, n - 1, 0}, 0, 0}}};
  g.levels[1] = {{h / 2, h / 2, 1}, {2, 2, 1}, {{{2 * a, 2 * a, 0}, {2 * b + 1, 2 * b + 1, 0}, m * m, (m + 1) * (m + 1)}}};
  std::vector<uint8_t> ghost(cell_count(Mesh(g)));
  for (long long j = a; j <= b; ++j)
    for (long long i = a; i <= b; ++i) ghost[size_t(i) + m * size_t(j)] = ghost_refined_cell;
  DatasetParts parts;
  parts.mesh = std::move(g), parts.cell_ghost = Array::from_vector(std::move(ghost));
  return make_dataset(std::move(parts));
}

struct MeshKind {
  std::string name;
  bool flat;
  std::function<DatasetPtr(int n, double r)> make;  ///< over [-r,r]^3, flat: [-r,r]^2 at z = 0, in about n cells an axis
};

/// Those of flow::kinds(), and all further solids of more than their corners.
inline const std::vector<MeshKind>& solid_meshes() {
  static const std::vector<MeshKind> all = [] {
    std::vector<MeshKind> k;
    for (const std::string& name : flow::kinds())
      if (name != "quadratic hexahedron") k.push_back({name, false, [name](int n, double r) { return flow::mesh_of(name, n, r); }});
    using enum CellType;
    const struct {
      const char* name;
      CellType type;
      size_t nodes;
      int finer;
    } types[] = {{"quadratic hexahedron", quadratic_hexahedron, 20, 2}, {"quadratic wedge", quadratic_wedge, 15, 2},
                 {"quadratic pyramid", quadratic_pyramid, 13, 2},       {"triquadratic hexahedron", triquadratic_hexahedron, 27, 2},
                 {"triquadratic pyramid", triquadratic_pyramid, 19, 2}, {"lagrange tetra", lagrange_tetra, 20, 3},
                 {"lagrange pyramid", lagrange_pyramid, 14, 2},         {"bezier tetra", bezier_tetra, 10, 2},
                 {"bezier hexahedron", bezier_hexahedron, 27, 2},       {"bezier wedge", bezier_wedge, 18, 2}};
    for (const auto& t : types)
      k.push_back({t.name, false, [t](int n, double r) { return solid_cells(t.type, t.nodes, std::max(2, n / t.finer), r); }});
    k.push_back({"curved hexahedron", false, [](int n, double r) {
                   return flow::moved(solid_cells(triquadratic_hexahedron, 27, std::max(2, n / 2), r), [r](Vec3 p) {
                     return p + 0.06 * r * Vec3(std::sin(2 * p.y / r), std::sin(2 * p.z / r), std::cos(2 * p.x / r));
                   });
                 }});
    return k;
  }();
  return all;
}

/// Flat meshes: grids, AMR, surfaces, cells of every type of the plane.
inline const std::vector<MeshKind>& flat_meshes() {
  static const std::vector<MeshKind> all = [] {
    std::vector<MeshKind> k;
    k.push_back({"flat uniform", true, [](int n, double r) {
                   return make_dataset(uniform({size_t(n + 1), size_t(n + 1), 1}, {-r, -r, 0}, {r, r, 0}));
                 }});
    k.push_back({"flat rectilinear", true, [](int n, double r) {
                   RectilinearGrid g;
                   std::vector<double> x, y;
                   for (int i = 0; i <= n; ++i) {
                     const double f = 2.0 * i / n - 1, bend = f * (1 - f * f);
                     x.push_back(r * (f + 0.3 * bend)), y.push_back(-r * (f - 0.3 * bend));
                   }
                   g.x = Array::from_vector(std::move(x)), g.y = Array::from_vector(std::move(y));
                   g.z = Array::from_vector(std::vector<double>{0});
                   return make_dataset(std::move(g));
                 }});
    k.push_back({"flat curvilinear", true, [](int n, double r) {  // bent inside, straight at the border
                   CurvilinearGrid g;
                   g.dims = {size_t(n + 1), size_t(n + 1), 1};
                   std::vector<double> xyz;
                   for (int j = 0; j <= n; ++j)
                     for (int i = 0; i <= n; ++i) {
                       const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1, bend = 0.15 * (1 - x * x) * (1 - y * y);
                       xyz.insert(xyz.end(), {r * (x + bend * std::sin(2 * y)), r * (y + bend * std::cos(2 * x)), 0});
                     }
                   g.points.xyz = Array::from_vector(std::move(xyz), 3);
                   return make_dataset(std::move(g));
                 }});
    k.push_back({"flat amr", true, flat_amr});
    for (const char* name : {"triangles", "quads", "polygons", "strips"})
      k.push_back({name, true, [name](int n, double r) { return flat_surface(name, n, r); }});
    using enum CellType;
    const struct {
      const char* name;
      CellType type;
      size_t nodes;
      int finer;
    } types[] = {{"triangle cells", triangle, 3, 1},
                 {"pixel cells", pixel, 4, 1},
                 {"polygon cells", polygon, 4, 1},
                 {"strip cells", triangle_strip, 4, 1},
                 {"quadratic triangle", quadratic_triangle, 6, 2},
                 {"quadratic quad", quadratic_quad, 8, 2},
                 {"biquadratic quad", biquadratic_quad, 9, 2},
                 {"biquadratic triangle", biquadratic_triangle, 7, 2},
                 {"lagrange triangle", lagrange_triangle, 10, 3},
                 {"lagrange quad", lagrange_quad, 16, 3},
                 {"bezier triangle", bezier_triangle, 6, 2},
                 {"bezier quad", bezier_quad, 9, 2}};
    for (const auto& t : types)
      k.push_back({t.name, true, [t](int n, double r) {
                     Context context;
                     const DatasetPtr apart =
                         topology::plane_cells(t.type, t.nodes, std::max(2, n / t.finer), [r](Vec3 p) { return r * p; });
                     return merge_points(apart, {.tolerance = 1e-9 * r}, context);
                   }});
    return k;
  }();
  return all;
}

inline const std::vector<MeshKind>& every_mesh() {
  static const std::vector<MeshKind> all = [] {
    std::vector<MeshKind> k = solid_meshes();
    k.insert(k.end(), flat_meshes().begin(), flat_meshes().end());
    return k;
  }();
  return all;
}

/// The mesh with a point field of f(position), which gives the `components` numbers of a place.
template <class F>
DatasetPtr with_values(const DatasetPtr& mesh, const std::string& name, int components, F&& f, Role role = Role::none) {
  const Array at = point_positions(mesh->mesh());
  std::vector<double> v(at.count() * size_t(components));
  for (size_t i = 0; i < at.count(); ++i) f(Vec3(at.get(i, 0), at.get(i, 1), at.get(i, 2)), &v[i * size_t(components)]);
  DatasetParts parts = mesh->parts();
  parts.fields.add({name, Association::point, Array::from_vector(std::move(v), components), "", role});
  return make_dataset(std::move(parts));
}

/// The point fields on the cells instead (means over their points).
inline DatasetPtr on_cells(const DatasetPtr& d) {
  Context context;
  DatasetParts parts = d->parts();
  FieldSet fields;
  const DatasetPtr both = point_to_cell(d, {}, context);
  for (const Field& f : both->fields())
    if (f.association == Association::cell) fields.add(f);
  parts.fields = std::move(fields);
  return make_dataset(std::move(parts));
}

/// Two meshes side by side as one flow: the left of [-r,r]^3 as a grid, the right as tetrahedra; flat: a grid and triangles.
inline std::vector<DatasetPtr> halves(bool flat, int n, double r) {
  const auto half = size_t(n / 2 + 1), whole = size_t(n + 1);
  const double z = flat ? 0 : r;
  const DatasetPtr left = make_dataset(uniform({half, whole, flat ? 1 : whole}, {-r, -r, -z}, {0, r, z}));
  const DatasetPtr right = flat ? flat_surface("triangles", n, r / 2) : solid_mesh("tetra", n, r / 2, [](Vec3) { return 0.0; });
  DatasetParts parts = right->parts();
  const auto place = [r](Vec3 p) { return Vec3(p.x + r / 2, 2 * p.y, 2 * p.z); };
  const Points moved{at_points(parts.mesh, place), {}};
  if (flat) std::get<SurfaceMesh>(parts.mesh).points = moved;
  else std::get<UnstructuredMesh>(parts.mesh).points = moved;
  return {left, make_dataset(std::move(parts))};
}

/// f of each half as one collection.
template <class F>
Data collection_of(const std::vector<DatasetPtr>& meshes, F&& f) {
  auto c = std::make_shared<Collection>();
  for (const DatasetPtr& d : meshes) c->parts.push_back({"part" + std::to_string(c->parts.size()), f(d)});
  return c;
}

}  // namespace sg::test
