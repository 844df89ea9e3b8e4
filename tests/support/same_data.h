// SPDX-License-Identifier: Apache-2.0
// Whether two results are the same, byte by byte.
#pragma once
#include <fmt/format.h>

#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "data/dataset.h"

namespace sg::test {

inline bool same_array(const Array& a, const Array& b) {
  if (a.type() != b.type() || a.count() != b.count() || a.components() != b.components()) return false;
  const Array p = a.made_packed(), q = b.made_packed();
  return p.bytes() == 0 || std::memcmp(p.raw(), q.raw(), p.bytes()) == 0;
}

namespace detail {

inline bool same(const CellArray& a, const CellArray& b) {
  return a.fixed == b.fixed && same_array(a.connectivity, b.connectivity) && same_array(a.offsets, b.offsets);
}
inline bool same(const Points& a, const Points& b) { return a.origin == b.origin && same_array(a.xyz, b.xyz); }
inline bool same(const UniformGrid& a, const UniformGrid& b) {
  return a.dims == b.dims && a.origin == b.origin && a.spacing == b.spacing && a.direction == b.direction;
}
inline bool same(const RectilinearGrid& a, const RectilinearGrid& b) {
  return same_array(a.x, b.x) && same_array(a.y, b.y) && same_array(a.z, b.z);
}
inline bool same(const CurvilinearGrid& a, const CurvilinearGrid& b) { return a.dims == b.dims && same(a.points, b.points); }
inline bool same(const UnstructuredMesh& a, const UnstructuredMesh& b) {
  return same(a.points, b.points) && same(a.cells, b.cells) && same_array(a.types, b.types) && a.single_type == b.single_type &&
         same(a.faces, b.faces) && same_array(a.polyhedron_faces, b.polyhedron_faces) && same_array(a.degrees, b.degrees) &&
         same_array(a.weights, b.weights);
}
inline bool same(const SurfaceMesh& a, const SurfaceMesh& b) {
  return same(a.points, b.points) && same(a.vertices, b.vertices) && same(a.lines, b.lines) && same(a.polygons, b.polygons) &&
         same(a.strips, b.strips);
}
inline bool same(const PointCloud& a, const PointCloud& b) { return same(a.points, b.points); }
inline bool same(const AmrGrid& a, const AmrGrid& b) {
  return a.levels.size() == b.levels.size() && point_count(a) == point_count(b) && bounds(a).lo == bounds(b).lo &&
         bounds(a).hi == bounds(b).hi;
}

}  // namespace detail

/// What tells the meshes, ghosts and those fields that `wanted` accepts apart; "" = nothing. Their order is compared, too.
inline std::string difference(const Dataset& a, const Dataset& b, const std::function<bool(const Field&)>& wanted) {
  if (a.mesh().index() != b.mesh().index()) return fmt::format("{} and {} meshes", a.kind(), b.kind());
  const bool same_mesh = std::visit([&](const auto& m) { return detail::same(m, *b.as<std::decay_t<decltype(m)>>()); },
                                    static_cast<const MeshKinds&>(a.mesh()));
  if (!same_mesh) return fmt::format("{} meshes of {} and {} points", a.kind(), a.point_count(), b.point_count());
  if (!same_array(a.point_ghost(), b.point_ghost()) || !same_array(a.cell_ghost(), b.cell_ghost())) return "ghosts";
  if (a.time() != b.time()) return "times";
  std::vector<const Field*> of_a, of_b;
  for (const Field& f : a.fields())
    if (wanted(f)) of_a.push_back(&f);
  for (const Field& f : b.fields())
    if (wanted(f)) of_b.push_back(&f);
  for (size_t i = 0; i < std::max(of_a.size(), of_b.size()); ++i) {
    if (i >= of_a.size() || i >= of_b.size()) return fmt::format("field '{}' missing", (i < of_a.size() ? of_a : of_b)[i]->name);
    const Field &f = *of_a[i], &g = *of_b[i];
    if (f.name != g.name || f.association != g.association) return fmt::format("field '{}' in place of '{}'", g.name, f.name);
    if (f.unit != g.unit || f.role != g.role) return fmt::format("unit or role of '{}'", f.name);
    if (!same_array(f.array, g.array)) return fmt::format("values of '{}'", f.name);
  }
  return "";
}

/// The same of collections and tables.
inline std::string difference(const Data& a, const Data& b, const std::function<bool(const Field&)>& wanted) {
  if (a.index() != b.index()) return "kinds of data";
  if (auto* t = std::get_if<TablePtr>(&a)) {
    const Table &s = **t, &u = *std::get<TablePtr>(b);
    if (s.columns.size() != u.columns.size()) return "columns";
    for (size_t i = 0; i < s.columns.size(); ++i)
      if (s.columns[i].name != u.columns[i].name || !same_array(s.columns[i].array, u.columns[i].array))
        return "column " + s.columns[i].name;
    return "";
  }
  std::vector<std::pair<std::string, DatasetPtr>> parts_a, parts_b;
  for_each_dataset(a, [&](const std::string& name, const DatasetPtr& d) { parts_a.emplace_back(name, d); });
  for_each_dataset(b, [&](const std::string& name, const DatasetPtr& d) { parts_b.emplace_back(name, d); });
  if (parts_a.size() != parts_b.size()) return "numbers of parts";
  for (size_t i = 0; i < parts_a.size(); ++i) {
    if (parts_a[i].first != parts_b[i].first) return "names of parts";
    if (const std::string d = difference(*parts_a[i].second, *parts_b[i].second, wanted); !d.empty()) return d;
  }
  return "";
}

}  // namespace sg::test
