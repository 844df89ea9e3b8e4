// SPDX-License-Identifier: Apache-2.0
// Boxes filled with cells of any type, and what one measures on surfaces.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <vector>

#include "data/cells/cell_topology.h"
#include "data/dataset.h"
#include "filter/mesh/surface.h"

namespace sg::test::meshes {

/// Solid cells of more than their corners.
inline const std::vector<CellType>& curved_solids() {
  using enum CellType;
  static const std::vector<CellType> types{
      quadratic_tetra,        quadratic_hexahedron,        quadratic_wedge, triquadratic_hexahedron, biquadratic_quadratic_hexahedron,
      quadratic_linear_wedge, biquadratic_quadratic_wedge, lagrange_tetra,  lagrange_hexahedron,     lagrange_wedge,
      bezier_tetra,           bezier_hexahedron,           bezier_wedge};
  return types;
}

/// f = x + 2y + 3z - 1.
inline double linear(Vec3 p) { return p.x + 2 * p.y + 3 * p.z - 1; }

inline Field make_field(std::string name, Association a, std::vector<double> v, int components = 1) {
  return {std::move(name), a, Array::from_vector(std::move(v), components), {}, Role::none};
}

/// Point field "f" (linear) and cell field "c" (the cell's number), for lattices.
inline DatasetPtr with_fields(Mesh mesh, const std::vector<Vec3>& at) {
  FieldSet fields;
  std::vector<double> f, c(cell_count(mesh));
  for (Vec3 p : at) f.push_back(linear(p));
  for (size_t i = 0; i < c.size(); ++i) c[i] = double(i);
  fields.add(make_field("f", Association::point, f));
  fields.add(make_field("c", Association::cell, c));
  return make_dataset(std::move(mesh), std::move(fields));
}

/// The box [0,1]^3 (or a part of fewer axes) as a uniform grid of nx*ny*nz cells.
inline DatasetPtr uniform_box(size_t nx, size_t ny, size_t nz) {
  UniformGrid g;
  g.dims = {nx + 1, ny + 1, nz + 1};
  g.spacing = {1.0 / double(std::max<size_t>(nx, 1)), 1.0 / double(std::max<size_t>(ny, 1)), 1.0 / double(std::max<size_t>(nz, 1))};
  std::vector<Vec3> at;
  for (size_t k = 0; k <= nz; ++k)
    for (size_t j = 0; j <= ny; ++j)
      for (size_t i = 0; i <= nx; ++i) at.push_back(g.spacing * Vec3(double(i), double(j), double(k)));
  return with_fields(g, at);
}

/// The box [0,1]^3 of n^3 cubes, each cut into cells of a solid type; Lagrange and Bezier cells of `order`. Straight edges.
inline DatasetPtr solid_box(CellType type, int n, int order = 1) {
  const CellType shape = type == CellType::polyhedron ? CellType::hexahedron : linear_type(type);
  const bool lattice_type = type >= CellType::lagrange_curve;
  const int o = lattice_type ? order : 2;  // lattice steps per cube; mid-edge nodes need two
  const int m = n * o + 1;
  std::vector<Vec3> at;
  for (int k = 0; k < m; ++k)
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < m; ++i) at.push_back(Vec3(i, j, k) / double(m - 1));
  using I3 = std::array<int, 3>;
  std::vector<std::vector<I3>> parts;  // corners of the cells of a cube in units of the cube
  if (shape == CellType::tetra) {
    int p[3] = {0, 1, 2};
    do {
      I3 v[4] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {2, 2, 2}};
      v[1][size_t(p[0])] = 2;
      v[2] = v[1], v[2][size_t(p[1])] = 2;
      const bool odd = ((p[0] > p[1]) + (p[0] > p[2]) + (p[1] > p[2])) % 2 == 1;
      if (odd) std::swap(v[1], v[2]);
      parts.push_back({v[0], v[1], v[2], v[3]});
    } while (std::next_permutation(p, p + 3));
  } else if (shape == CellType::wedge) {
    parts = {{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}},
             {{0, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 2, 2}, {0, 2, 2}}};
  } else if (shape == CellType::pyramid) {
    for (size_t f = 0; f < 6; ++f) {
      const I3 corner[8] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}};
      const auto c = linear_topology(CellType::hexahedron)->face(f);
      parts.push_back({corner[c[3]], corner[c[2]], corner[c[1]], corner[c[0]], {1, 1, 1}});
    }
  } else if (shape == CellType::voxel) {
    parts = {{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {2, 2, 0}, {0, 0, 2}, {2, 0, 2}, {0, 2, 2}, {2, 2, 2}}};
  } else {
    parts = {{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}}};
  }
  std::vector<int64_t> ids, offsets{0}, face_ids, face_offsets{0}, cell_faces{0};
  auto id = [&](int i, int j, int k) { return int64_t(i + m * (j + m * k)); };
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (const auto& part : parts) {
          std::vector<I3> c;
          for (const I3& v : part) c.push_back({(2 * i + v[0]) * o, (2 * j + v[1]) * o, (2 * k + v[2]) * o});  // twice the lattice place
          auto node = [&](const I3& twice) { return id(twice[0] / 2, twice[1] / 2, twice[2] / 2); };
          if (lattice_type) {
            const size_t apex = shape == CellType::tetra || shape == CellType::wedge ? 3 : 4, side = shape == CellType::hexahedron ? 3 : 2;
            std::vector<int64_t> nodes;
            for (int w = 0; w <= order; ++w)
              for (int v = 0; v <= order; ++v)
                for (int u = 0; u <= order; ++u) {
                  if (shape == CellType::tetra && u + v + w > order) continue;
                  if (shape == CellType::wedge && u + v > order) continue;
                  I3 p;
                  for (size_t a = 0; a < 3; ++a)
                    p[a] = c[0][a] + (u * (c[1][a] - c[0][a]) + v * (c[side][a] - c[0][a]) + w * (c[apex][a] - c[0][a])) / order;
                  const uint32_t local = lattice_node(type, order, u, v, w);
                  if (nodes.size() <= local) nodes.resize(local + 1);
                  nodes[local] = node(p);
                }
            ids.insert(ids.end(), nodes.begin(), nodes.end());
          } else {
            for (const I3& v : c) ids.push_back(node(v));
            const LinearTopology& t = *linear_topology(shape);
            auto middle = [&](auto list) {
              I3 sum{0, 0, 0};
              for (auto l : list)
                for (size_t a = 0; a < 3; ++a) sum[a] += c[l][a] / int(list.size());
              ids.push_back(node(sum));
            };
            const bool half = type == CellType::quadratic_linear_wedge;
            if (is_high_order(type))
              for (size_t e = 0; e < (half ? 6 : t.edges.size()); ++e) middle(t.edges[e]);
            if (type == CellType::triquadratic_hexahedron || type == CellType::biquadratic_quadratic_hexahedron)
              for (size_t f = 0; f < (type == CellType::triquadratic_hexahedron ? 6 : 4); ++f) middle(t.face(f));
            if (type == CellType::triquadratic_hexahedron) middle(std::vector<int>{0, 6});
            if (type == CellType::biquadratic_quadratic_wedge)
              for (size_t f = 2; f < 5; ++f) middle(t.face(f));
            if (type == CellType::polyhedron) {
              for (size_t f = 0; f < t.face_count(); ++f) {
                for (auto l : t.face(f)) face_ids.push_back(node(c[l]));
                face_offsets.push_back(int64_t(face_ids.size()));
              }
              cell_faces.push_back(int64_t(face_offsets.size()) - 1);
            }
          }
          offsets.push_back(int64_t(ids.size()));
        }
  UnstructuredMesh mesh;
  double* xyz = nullptr;
  mesh.points.xyz = Array::make<double>(at.size(), 3, &xyz);
  for (Vec3 p : at) *xyz++ = p.x, *xyz++ = p.y, *xyz++ = p.z;
  mesh.cells.connectivity = Array::from_vector(ids);
  mesh.cells.offsets = Array::from_vector(offsets);
  mesh.single_type = type;
  if (type == CellType::polyhedron) {
    mesh.faces.connectivity = Array::from_vector(face_ids);
    mesh.faces.offsets = Array::from_vector(face_offsets);
    mesh.polyhedron_faces = Array::from_vector(cell_faces);
  }
  return with_fields(mesh, at);
}

struct SurfaceFacts {
  double area = 0, volume = 0;  ///< volume enclosed, by the divergence theorem
  bool closed = true;           ///< every directed edge has its opposite
  size_t triangles = 0;
  Vec3 vector_area;
};
inline SurfaceFacts measure(const SurfaceMesh& mesh) {
  const Triangles t = triangles_of(mesh);
  SurfaceFacts r;
  r.triangles = t.count();
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (size_t i = 0; i < t.count(); ++i) {
    const uint32_t* v = &t.indices[3 * i];
    const Vec3 a = mesh.points.at(v[0]), b = mesh.points.at(v[1]), c = mesh.points.at(v[2]);
    r.area += length(cross(b - a, c - a)) / 2;
    r.vector_area += cross(b - a, c - a) * 0.5;
    r.volume += dot(a, cross(b, c)) / 6;
    for (int k = 0; k < 3; ++k) ++edges[{v[k], v[(k + 1) % 3]}];
  }
  for (const auto& [e, n] : edges) {
    const auto back = edges.find({e.second, e.first});
    r.closed = r.closed && back != edges.end() && back->second == n;
  }
  return r;
}

/// Largest difference between point field "f" and the linear function.
inline double linear_error(const Dataset& d, const Points& points) {
  const Field& f = d.fields().require("f", Association::point);
  double worst = 0;
  for (size_t i = 0; i < points.count(); ++i) worst = std::max(worst, std::abs(f.array.get(i) - linear(points.at(i))));
  return worst;
}

/// Do two datasets hold the same surface, byte for byte?
inline bool same_bytes(const Array& a, const Array& b) {
  return a.count() == b.count() && a.type() == b.type() && a.components() == b.components() &&
         (a.bytes() == 0 || std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
}
inline bool same_surface(const Dataset& a, const Dataset& b) {
  const auto &m = *a.as<SurfaceMesh>(), &n = *b.as<SurfaceMesh>();
  bool same = same_bytes(m.points.xyz, n.points.xyz) && a.fields().size() == b.fields().size();
  for (auto part : {&SurfaceMesh::vertices, &SurfaceMesh::lines, &SurfaceMesh::polygons})
    same = same && same_bytes((m.*part).connectivity, (n.*part).connectivity) && same_bytes((m.*part).offsets, (n.*part).offsets);
  for (size_t i = 0; same && i < a.fields().size(); ++i)
    same = a.fields()[i].name == b.fields()[i].name && same_bytes(a.fields()[i].array, b.fields()[i].array);
  return same;
}

}  // namespace sg::test::meshes
