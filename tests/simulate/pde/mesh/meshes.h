// SPDX-License-Identifier: Apache-2.0
// Meshes for the tests of finite elements: shaken grids, spheres.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "data/dataset.h"
#include "simulate/pde/mesh/simplices.h"

namespace sg::test {

/// A curvilinear grid of n x n x n cells (flat: one layer of points) over the unit cube, whose points inside are moved by up to `shake`
/// cells along each axis.
inline DatasetPtr shaken_grid(size_t n, double shake, bool flat = false, uint64_t seed = 1) {
  CurvilinearGrid g;
  g.dims = {n + 1, n + 1, flat ? 1 : n + 1};
  std::mt19937_64 random(seed);
  std::vector<double> xyz;
  for (size_t k = 0; k < g.dims[2]; ++k)
    for (size_t j = 0; j <= n; ++j)
      for (size_t i = 0; i <= n; ++i) {
        const std::array<size_t, 3> at{i, j, k};
        const bool inside = i > 0 && i < n && j > 0 && j < n && (flat || (k > 0 && k < n));
        for (size_t a = 0; a < 3; ++a) {
          const double r = double(random() >> 11) * 0x1p-53 * 2 - 1;
          xyz.push_back((double(at[a]) + (inside && !(flat && a == 2) ? shake * r : 0)) / double(n));
        }
      }
  g.points.xyz = Array::from_vector(std::move(xyz), 3);
  return make_dataset(std::move(g));
}

/// The simplices of a mesh as cells of an unstructured one.
inline DatasetPtr as_simplices(const DatasetPtr& in) {
  const pde::Simplices s = pde::simplices_of(in, "test", Context());
  UnstructuredMesh m;
  std::vector<double> xyz;
  for (const Vec3& p : s.at) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  std::vector<int32_t> ids;
  for (const auto& c : s.corners)
    for (int v = 0; v <= s.dimension; ++v) ids.push_back(int32_t(c[size_t(v)]));
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.cells.connectivity = Array::from_vector(std::move(ids));
  m.cells.fixed = s.dimension + 1;
  m.single_type = s.dimension == 3 ? CellType::tetra : s.dimension == 2 ? CellType::triangle : CellType::line;
  return make_dataset(std::move(m));
}

/// The unit sphere: an octahedron, each triangle cut into four `levels` times.
inline DatasetPtr sphere_mesh(int levels) {
  std::vector<Vec3> at{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<std::array<int32_t, 3>> triangles{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int l = 0; l < levels; ++l) {
    std::map<std::pair<int32_t, int32_t>, int32_t> middles;
    const auto middle = [&](int32_t a, int32_t b) {
      const auto [found, added] = middles.try_emplace(std::minmax(a, b), int32_t(at.size()));
      if (added) at.push_back(normalize(at[size_t(a)] + at[size_t(b)]));
      return found->second;
    };
    std::vector<std::array<int32_t, 3>> finer;
    for (const auto& t : triangles) {
      const int32_t a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}});
    }
    triangles = finer;
  }
  SurfaceMesh m;
  std::vector<double> xyz;
  for (const Vec3& p : at) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  std::vector<int32_t> ids;
  for (const auto& t : triangles) ids.insert(ids.end(), t.begin(), t.end());
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.polygons.connectivity = Array::from_vector(std::move(ids));
  m.polygons.fixed = 3;
  return make_dataset(std::move(m));
}

}  // namespace sg::test
