// SPDX-License-Identifier: Apache-2.0
// Unit spheres of cells of every kind.
#pragma once
#include <algorithm>
#include <array>
#include <map>

#include "data/cells/cell_reader.h"
#include "filter/flow/topology/topology_support.h"
#include "filter/surface/surface_shapes.h"

namespace sg::test::topology {

// A mesh of listed cells, whose points are pushed onto the unit sphere; points at one place are one.
struct Ball {
  std::map<std::array<int64_t, 3>, int64_t> number;
  std::vector<double> xyz;
  std::vector<int64_t> ids, offsets{0};
  std::vector<uint8_t> types;

  int64_t point(Vec3 p) {
    p = normalize(p);
    const std::array<int64_t, 3> key{std::llround(p.x * 1e9), std::llround(p.y * 1e9), std::llround(p.z * 1e9)};
    const auto [at, fresh] = number.try_emplace(key, int64_t(xyz.size() / 3));
    if (fresh) xyz.insert(xyz.end(), {p.x, p.y, p.z});
    return at->second;
  }
  void cell(CellType type, const std::vector<Vec3>& at) {
    for (const Vec3 p : at) ids.push_back(point(p));
    offsets.push_back(int64_t(ids.size()));
    types.push_back(uint8_t(type));
  }
  DatasetPtr mesh() const {
    UnstructuredMesh m;
    m.points.xyz = Array::from_vector(xyz, 3);
    m.cells.connectivity = Array::from_vector(ids);
    m.cells.offsets = Array::from_vector(offsets);
    m.types = Array::from_vector(types);
    return make_dataset(std::move(m));
  }
};

// The six faces of a cube in n*n squares; `cell` gets their corners.
template <class C>
void cube_faces(int n, C&& cell) {
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1})
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          auto corner = [&](int a, int b) {
            Vec3 p;
            p[axis] = side, p[(axis + 1) % 3] = side * std::tan((3.14159265358979323846 / 4) * (2.0 * (i + a) / n - 1));
            p[(axis + 2) % 3] = std::tan((3.14159265358979323846 / 4) * (2.0 * (j + b) / n - 1));
            return p;
          };
          cell(corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1), i + j);
        }
}

inline DatasetPtr ball_of(const std::string& kind) {
  Ball ball;
  const auto middle = [](Vec3 a, Vec3 b) { return normalize(normalize(a) + normalize(b)); };
  if (kind == "polygons") {
    // The dual of a sphere of triangles: a polygon about each of its points.
    const DatasetPtr d = shapes::sphere(2).dataset();
    CellReader cell(d);
    std::vector<std::vector<Vec3>> around(d->point_count());
    std::vector<Vec3> at(d->point_count());
    for (size_t c = 0; c < cell.count(); ++c) {
      cell.open(c);
      for (size_t k = 0; k < 3; ++k) {
        at[size_t(cell.ids()[k])] = cell.at()[k];
        around[size_t(cell.ids()[k])].push_back(normalize(cell.at()[0] + cell.at()[1] + cell.at()[2]));
      }
    }
    for (size_t i = 0; i < at.size(); ++i) {
      const Vec3 u = normalize(cross(at[i], Vec3(0.3, 0.5, 0.7))), w = cross(at[i], u);
      std::sort(around[i].begin(), around[i].end(),
                [&](Vec3 a, Vec3 b) { return std::atan2(dot(a, w), dot(a, u)) < std::atan2(dot(b, w), dot(b, u)); });
      ball.cell(CellType::polygon, around[i]);
    }
    return ball.mesh();
  }
  cube_faces(kind == "quads" || kind == "mixed" || kind == "triangles" ? 8 : 5, [&](Vec3 a, Vec3 b, Vec3 c, Vec3 d, int number) {
    const Vec3 ab = middle(a, b), bc = middle(b, c), cd = middle(c, d), da = middle(d, a), ac = middle(a, c);
    using enum CellType;
    if (kind == "quads" || (kind == "mixed" && number % 2)) ball.cell(quad, {a, b, c, d});
    else if (kind == "triangles" || kind == "mixed") ball.cell(triangle, {a, b, c}), ball.cell(triangle, {a, c, d});
    else if (kind == "quadratic triangles")
      ball.cell(quadratic_triangle, {a, b, c, ab, bc, ac}), ball.cell(quadratic_triangle, {a, c, d, ac, cd, da});
    else if (kind == "quadratic quads") ball.cell(quadratic_quad, {a, b, c, d, ab, bc, cd, da});
    else ball.cell(biquadratic_quad, {a, b, c, d, ab, bc, cd, da, normalize(ab) + normalize(cd)});
  });
  return ball.mesh();
}

}  // namespace sg::test::topology
