// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/to_unstructured.h"

#include <numeric>

#include "filter/mesh/select/extract.h"

namespace sg {

namespace {

// The type of a list of n points in one of the four arrays of a surface.
CellType listed_type(int kind, size_t n) {
  switch (kind) {
    case 0: return n == 1 ? CellType::vertex : CellType::poly_vertex;
    case 1: return n == 2 ? CellType::line : CellType::poly_line;
    case 2: return n == 3 ? CellType::triangle : n == 4 ? CellType::quad : CellType::polygon;
    default: return CellType::triangle_strip;
  }
}

UnstructuredMesh cells_of(const SurfaceMesh& s) {
  UnstructuredMesh u;
  u.points = s.points;
  std::vector<int64_t> ids, offsets{0};
  std::vector<uint8_t> types;
  const CellArray* kinds[4] = {&s.vertices, &s.lines, &s.polygons, &s.strips};
  for (int kind = 0; kind < 4; ++kind) {
    const CellsView v = cells_view(*kinds[kind]);
    for (size_t c = 0; c < v.count; ++c) {
      for (size_t k = v.begin(c); k < v.end(c); ++k) ids.push_back(v.connectivity[k]);
      offsets.push_back(int64_t(ids.size()));
      types.push_back(uint8_t(listed_type(kind, v.size(c))));
    }
  }
  u.cells = {Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
  u.types = Array::from_vector(std::move(types));
  return u;
}

UnstructuredMesh cells_of(const PointCloud& c) {
  UnstructuredMesh u;
  u.points = c.points;
  std::vector<int64_t> ids(c.points.count());
  std::iota(ids.begin(), ids.end(), 0);
  u.cells = {Array::from_vector(std::move(ids)), {}, 1};
  u.single_type = CellType::vertex;
  return u;
}

}  // namespace

DatasetPtr to_unstructured(const DatasetPtr& in) {
  if (in->as<UnstructuredMesh>()) return in;
  DatasetParts parts = in->parts();
  if (auto* s = in->as<SurfaceMesh>()) {
    parts.mesh = cells_of(*s);
  } else if (auto* c = in->as<PointCloud>()) {
    parts.mesh = cells_of(*c);
    for (const Field& f : in->fields())  // of the cells that it did not have
      if (f.association == Association::cell) parts.fields.remove(f.name, Association::cell);
  } else {
    std::vector<int64_t> all(in->cell_count());
    std::iota(all.begin(), all.end(), 0);
    return extract_cells(in, all, "to_unstructured");
  }
  return make_dataset(std::move(parts));
}

}  // namespace sg
