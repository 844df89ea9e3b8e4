// SPDX-License-Identifier: Apache-2.0
// What the tests of cells share: every type and order with a reference map, random places and distorted cells.
#pragma once
#include <string>
#include <vector>

#include "base/random.h"
#include "data/cells/cell_topology.h"
#include "data/cells/shape/cell_shape.h"
#include "data/dataset.h"

namespace sg::test {

struct CellCase {
  CellType type;
  size_t nodes;
  std::array<int, 3> orders{0, 0, 0};
  std::string name() const {
    return std::string(cell_type_info(type).name) + " " + std::to_string(nodes) + " nodes, orders " + std::to_string(orders[0]) + " " +
           std::to_string(orders[1]) + " " + std::to_string(orders[2]);
  }
  const CellShape& shape() const { return *CellShape::find(type, nodes, orders); }
};

/// The types with a fixed number of nodes and a reference map.
inline std::vector<CellCase> fixed_cases() {
  std::vector<CellCase> r;
  for (int t = 1; t < 68; ++t) {
    const CellTypeInfo* info = cell_type_info(uint8_t(t));
    if (info && info->points > 0 && t != int(CellType::pentagonal_prism) && t != int(CellType::hexagonal_prism))
      r.push_back({CellType(t), size_t(info->points)});
  }
  return r;
}

/// Lagrange and Bezier cells of orders `first` to `last`, some with different orders along the axes, and the special node counts.
inline std::vector<CellCase> order_cases(int first, int last) {
  using enum CellType;
  std::vector<CellCase> r;
  for (CellType type : {lagrange_curve, lagrange_triangle, lagrange_quad, lagrange_tetra, lagrange_hexahedron, lagrange_wedge, bezier_curve,
                        bezier_triangle, bezier_quad, bezier_tetra, bezier_hexahedron, bezier_wedge}) {
    for (int n = first; n <= last; ++n) r.push_back({type, lattice_nodes(type, {n, n, n})});
    const CellType base = linear_type(type);
    if (base == quad || base == hexahedron)
      for (std::array<int, 3> o : {std::array{2, 3, 1}, {4, 1, 5}, {1, 2, 2}})
        if (o[0] >= first && o[0] <= last) r.push_back({type, lattice_nodes(type, o), o});
    if (base == wedge)
      for (std::array<int, 3> o : {std::array{2, 2, 1}, {4, 4, 2}, {1, 1, 3}})
        if (o[0] >= first && o[0] <= last) r.push_back({type, lattice_nodes(type, o), o});
  }
  if (first <= 2)
    for (CellCase c : {CellCase{lagrange_triangle, 7},
                       {lagrange_tetra, 15},
                       {lagrange_wedge, 21},
                       {lagrange_pyramid, 5},
                       {lagrange_pyramid, 13},
                       {lagrange_pyramid, 14},
                       {lagrange_pyramid, 19},
                       {bezier_pyramid, 5}})
      r.push_back(c);
  return r;
}

inline std::vector<CellCase> all_cases() {
  std::vector<CellCase> r = fixed_cases();
  for (const CellCase& c : order_cases(1, 10)) r.push_back(c);
  return r;
}

/// A random place in the reference element, away from the apex of pyramids.
inline Vec3 random_place(const CellShape& shape, uint64_t seed) {
  Vec3 p;
  for (int a = 0; a < shape.dimension(); ++a) p[a] = random_unit(seed, uint64_t(a));
  return shape.clamped(p);
}

inline Vec3 random_vector(uint64_t seed, uint64_t index) {
  return Vec3(random_unit(seed, 3 * index) - 0.5, random_unit(seed, 3 * index + 1) - 0.5, random_unit(seed, 3 * index + 2) - 0.5);
}

/// One cell as a mesh of its own.
inline DatasetPtr one_cell(CellType type, const std::vector<Vec3>& at, std::array<int, 3> orders = {0, 0, 0},
                           std::vector<double> weights = {}) {
  UnstructuredMesh m;
  std::vector<double> xyz;
  std::vector<int64_t> ids;
  for (Vec3 p : at) ids.push_back(int64_t(xyz.size() / 3)), xyz.insert(xyz.end(), {p.x, p.y, p.z});
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.cells = {Array::from_vector(ids), Array::from_vector(std::vector<int64_t>{0, int64_t(ids.size())}), 0};
  m.single_type = type;
  if (orders[0] > 0) {
    std::vector<uint8_t> d;
    for (int n : orders) d.push_back(uint8_t(n));
    m.degrees = Array::from_vector(d, 3);
  }
  if (!weights.empty()) m.weights = Array::from_vector(std::move(weights));
  return make_dataset(m);
}

}  // namespace sg::test
