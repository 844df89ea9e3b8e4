// SPDX-License-Identifier: Apache-2.0
// A box cut into cells of every kind.
#pragma once
#include <string>
#include <vector>

#include "data/dataset.h"
#include "filter/scalar/contour/contour_support.h"

namespace sg::test {

struct CellsOf {
  std::vector<double> xyz;
  std::vector<int32_t> ids, offsets{0};
  std::vector<uint8_t> types;
  std::vector<std::vector<int>> faces;
  std::vector<int64_t> of_cell{0};
  void polyhedron(const std::vector<int>& p, const std::vector<std::vector<int>>& local) {
    cell(CellType::polyhedron, p);
    for (const auto& f : local) {
      auto& face = faces.emplace_back();
      for (int k : f) face.push_back(p[size_t(k)]);
    }
    of_cell.back() = int64_t(faces.size());
  }
  void cell(CellType t, const std::vector<int>& p) {
    ids.insert(ids.end(), p.begin(), p.end());
    offsets.push_back(int32_t(ids.size()));
    types.push_back(uint8_t(t));
    of_cell.push_back(int64_t(faces.size()));
  }
  int point(Vec3 p) {
    xyz.insert(xyz.end(), {p.x, p.y, p.z});
    return int(xyz.size() / 3 - 1);
  }
};

/// The cells, with a value f at each point.
inline DatasetPtr dataset_of(CellsOf m, std::vector<double> values) {
  UnstructuredMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(m.xyz), 3);
  mesh.cells.connectivity = Array::from_vector(std::move(m.ids));
  mesh.cells.offsets = Array::from_vector(std::move(m.offsets));
  mesh.types = Array::from_vector(std::move(m.types));
  if (!m.faces.empty()) {
    std::vector<int64_t> face_ids, face_offsets{0};
    for (const auto& face : m.faces) {
      face_ids.insert(face_ids.end(), face.begin(), face.end());
      face_offsets.push_back(int64_t(face_ids.size()));
    }
    mesh.faces.connectivity = Array::from_vector(std::move(face_ids));
    mesh.faces.offsets = Array::from_vector(std::move(face_offsets));
    mesh.polyhedron_faces = Array::from_vector(std::move(m.of_cell));
  }
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::move(values)), "", Role::scalars});
  return make_dataset(std::move(mesh), std::move(fields));
}

/// n steps of equal length from -1 to 1.
inline std::vector<double> even_axis(size_t n) {
  std::vector<double> axis;
  for (size_t i = 0; i <= n; ++i) axis.push_back(-1 + 2.0 * double(i) / double(n));
  return axis;
}

/// The points of a lattice with the same coordinates along all axes.
inline std::vector<Vec3> lattice_places(const std::vector<double>& axis) {
  std::vector<Vec3> at;
  for (const double z : axis)
    for (const double y : axis)
      for (const double x : axis) at.emplace_back(x, y, z);
  return at;
}

/// A lattice of the axis' coordinates along x, y and z. kind 0: uniform, for an axis of equal steps; 1: rectilinear; 2: curvilinear, its
/// points moved by `move`.
template <class Move>
Mesh lattice_mesh(int kind, const std::vector<double>& axis, Move&& move) {
  const size_t n = axis.size();
  if (kind == 0) {
    UniformGrid g;
    g.dims = {n, n, n};
    g.origin = Vec3(1, 1, 1) * axis.front();
    g.spacing = Vec3(1, 1, 1) * ((axis.back() - axis.front()) / double(n - 1));
    return g;
  }
  if (kind == 1) {
    RectilinearGrid g;
    g.x = g.y = g.z = Array::from_vector(axis);
    return g;
  }
  CurvilinearGrid g;
  g.dims = {n, n, n};
  std::vector<double> xyz;
  for (const Vec3 p : lattice_places(axis)) {
    const Vec3 q = move(p);
    xyz.insert(xyz.end(), {q.x, q.y, q.z});
  }
  g.points.xyz = Array::from_vector(std::move(xyz), 3);
  return g;
}
inline Mesh lattice_mesh(int kind, const std::vector<double>& axis) {
  return lattice_mesh(kind, axis, [](Vec3 p) { return p; });
}

/// [-r,r]^3 in n^3 blocks, each cut as `kind` says: hexahedron, voxel, tetra, wedge, pyramid, or mixed (all in turn but tetra).
/// `bend` moves the points of the blocks smoothly; hexahedra then have warped faces.
template <class F>
DatasetPtr solid_mesh(const std::string& kind, int n, double r, F&& f, double bend = 0) {
  CellsOf m;
  auto at = [&](double i, double j, double k) {
    Vec3 p(-r + 2 * r * i / n, -r + 2 * r * j / n, -r + 2 * r * k / n);
    return p + bend * Vec3(std::sin(p.y + 2 * p.z), std::sin(p.z - p.x), std::cos(p.x + p.y));
  };
  const int s = n + 1;
  for (int k = 0; k < s; ++k)
    for (int j = 0; j < s; ++j)
      for (int i = 0; i < s; ++i) m.point(at(i, j, k));
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const int a = i + s * (j + s * k);
        const int c[8] = {a, a + 1, a + 1 + s, a + s, a + s * s, a + 1 + s * s, a + 1 + s + s * s, a + s + s * s};
        const std::string what = kind == "mixed" ? (i + j + k) % 2 ? "pyramid" : i % 2 ? "polyhedron" : "hexahedron" : kind;
        if (what == "hexahedron") m.cell(CellType::hexahedron, {c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]});
        if (what == "polyhedron")  // some faces turned inwards, as files do
          m.polyhedron({c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]},
                       {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 4, 5, 1}, {3, 7, 6, 2}, {0, 4, 7, 3}, {1, 2, 6, 5}});
        if (what == "voxel") m.cell(CellType::voxel, {c[0], c[1], c[3], c[2], c[4], c[5], c[7], c[6]});
        if (what == "wedge") {
          m.cell(CellType::wedge, {c[0], c[1], c[2], c[4], c[5], c[6]});
          m.cell(CellType::wedge, {c[0], c[3], c[2], c[4], c[7], c[6]});  // turned the other way, as files do
        }
        if (what == "pyramid") {
          const int top = m.point(at(i + .5, j + .5, k + .5));
          for (const auto& q : {std::array<int, 4>{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1}, {3, 2, 6, 7}, {0, 3, 7, 4}, {1, 5, 6, 2}})
            m.cell(CellType::pyramid, {c[q[0]], c[q[1]], c[q[2]], c[q[3]], top});
        }
        if (what == "tetra") {  // six around the diagonal 0-6: the same on both sides of every face
          const int around[] = {1, 2, 3, 7, 4, 5};
          for (int t = 0; t < 6; ++t) m.cell(CellType::tetra, {c[0], c[around[t]], c[around[(t + 1) % 6]], c[6]});
        }
      }
  std::vector<double> v;
  for (size_t p = 0; p < m.xyz.size() / 3; ++p) v.push_back(f(Vec3(m.xyz[3 * p], m.xyz[3 * p + 1], m.xyz[3 * p + 2])));
  return dataset_of(std::move(m), std::move(v));
}

inline const std::vector<std::string>& solid_kinds() {
  static const std::vector<std::string> kinds{"hexahedron", "voxel", "tetra", "wedge", "pyramid", "polyhedron", "mixed"};
  return kinds;
}

}  // namespace sg::test
