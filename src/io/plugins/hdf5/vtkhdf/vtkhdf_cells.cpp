// SPDX-License-Identifier: Apache-2.0
// VTKHDF: unstructured grids and polygonal data. Partitions lie one after the other in every array, each numbering its points from 0;
// they are merged here. In a series, tables in Steps give the partitions, points, cells and ids of a step.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "io/plugins/hdf5/vtkhdf/vtkhdf.h"
#include "io/vtk/vtk_cells.h"

namespace sg::vtkhdf {

namespace {

uint64_t total(const Group& g, const std::string& what, const std::vector<uint64_t>& counts) {
  uint64_t n = 0;
  for (const uint64_t c : counts)
    if (!add(n, c, n) || n > (uint64_t(1) << 60)) g.file.fail("adds up to too many to count", g.at(what), "the file is damaged");
  return n;
}

/// The partitions of the step: first .. first + points.size().
struct Partitions {
  uint64_t first = 0, point_offset = 0, point_count = 0;
  std::vector<uint64_t> points;
  size_t size() const { return points.size(); }
};

Partitions partitions_of(const Group& g) {
  Partitions p;
  p.first = g.step_entry("PartOffsets", 0);
  p.point_offset = g.step_entry("PointOffsets", 0);
  const uint64_t all = h5::Dataset(g.file, g.at("NumberOfPoints")).rows();
  // Without their number, a step has one part, or all where no step has parts of its own.
  const bool own = g.step.any && g.file.is_dataset(g.at("Steps/PartOffsets"));
  const uint64_t n = g.step_entry("NumberOfParts", own ? 1 : all);
  p.points = h5::read_counts(g.file, g.at("NumberOfPoints"), p.first, n);
  p.point_count = total(g, "NumberOfPoints", p.points);
  return p;
}

Array read_points(const Group& g, const Partitions& p) {
  if (p.point_count == 0) return {};
  const Array a = h5::Dataset(g.file, g.at("Points")).read_rows(p.point_offset, p.point_count);
  if (a.components() != 3) g.file.fail(fmt::format("has {} coordinates per point", a.components()), g.at("Points"), "3");
  return vtk::as_coordinates(a);
}

/// The cell lists of all partitions, as the file holds them.
struct CellLists {
  std::vector<uint64_t> cells, ids;  // per partition
  uint64_t cell_offset = 0, cell_count = 0;
  std::vector<CellArray> lists;  // per partition, ids from 0
};

// `at` is "" or a group ("Polygons/"), `column` its place in the tables of steps.
CellLists read_lists(const Group& g, const Partitions& p, const std::string& at, uint64_t column) {
  CellLists r;
  r.cells = h5::read_counts(g.file, g.at(at + "NumberOfCells"), p.first, p.size());
  r.ids = h5::read_counts(g.file, g.at(at + "NumberOfConnectivityIds"), p.first, p.size());
  r.cell_count = total(g, at + "NumberOfCells", r.cells);
  const uint64_t id_count = total(g, at + "NumberOfConnectivityIds", r.ids);
  r.cell_offset = g.step_entry("CellOffsets", 0, column);
  const uint64_t id_offset = g.step_entry("ConnectivityIdOffsets", 0, column);
  r.lists.resize(p.size());
  if (r.cell_count == 0) return r;
  // Each partition has one offset more than cells.
  uint64_t from = 0;
  if (!add(r.cell_offset, p.first, from)) from = UINT64_MAX;
  const Array offsets = vtk::as_indices(h5::Dataset(g.file, g.at(at + "Offsets")).read_rows(from, r.cell_count + p.size()));
  const Array ids = vtk::as_indices(h5::Dataset(g.file, g.at(at + "Connectivity")).read_rows(id_offset, id_count));
  if (offsets.components() != 1 || ids.components() != 1) g.file.fail("has cells that are not lists of numbers", g.at(at));
  size_t o = 0, c = 0;
  for (size_t i = 0; i < p.size(); ++i) {
    const size_t n = r.cells[i], m = r.ids[i];
    if (n > 0)
      r.lists[i] = with_context(fmt::format("splitting the cells of partition {} in '{}'", p.first + i, g.at(at)),
                                [&] { return vtk::cells_from_starts(offsets.slice(o, o + n + 1), ids.slice(c, c + m)); });
    o += n + 1, c += m;
  }
  return r;
}

std::vector<size_t> starts(const std::vector<uint64_t>& counts) {
  std::vector<size_t> r;
  size_t n = 0;
  for (const uint64_t c : counts) r.push_back(n), n += c;
  return r;
}

/// Faces of polyhedra since version 2.5: lists of faces, and for each cell the numbers of its faces.
void read_faces(const Group& g, const Partitions& p, const CellLists& cells, UnstructuredMesh& mesh) {
  auto before_and_here = [&](const char* name) {  // what precedes the step's partitions, and their counts
    std::vector<uint64_t> all = h5::read_counts(g.file, g.at(name), 0, p.first + p.size());
    uint64_t before = 0;
    for (uint64_t i = 0; i < p.first; ++i) before += all[i];
    all.erase(all.begin(), all.begin() + ptrdiff_t(p.first));
    return std::pair(before, all);
  };
  const auto [faces_before, faces] = before_and_here("NumberOfFaces");
  const auto [ids_before, ids] = before_and_here("NumberOfFaceConnectivityIds");
  const auto [links_before, links] = before_and_here("NumberOfPolyhedronToFaceIds");
  auto read = [&](const char* name, uint64_t from, uint64_t n) {
    return vtk::as_indices(h5::Dataset(g.file, g.at(name)).read_rows(from, n));
  };
  const Array id = read("FaceConnectivity", ids_before, total(g, "NumberOfFaceConnectivityIds", ids));
  const Array id_starts = read("FaceOffsets", faces_before + p.first, total(g, "NumberOfFaces", faces) + p.size());
  const Array link = read("PolyhedronToFaces", links_before, total(g, "NumberOfPolyhedronToFaceIds", links));
  const Array link_starts = read("PolyhedronOffsets", cells.cell_offset + p.first, cells.cell_count + p.size());
  std::vector<int64_t> out, offsets{0}, cell_faces{0};
  size_t f = 0, c = 0, l = 0, o = 0, point = 0;
  for (size_t i = 0; i < p.size(); ++i) {
    const CellArray lists = vtk::cells_from_starts(id_starts.slice(f, f + faces[i] + 1), id.slice(o, o + ids[i]));
    const CellArray of_cell = vtk::cells_from_starts(link_starts.slice(c, c + cells.cells[i] + 1), link.slice(l, l + links[i]));
    const CellsView face = cells_view(lists), of = cells_view(of_cell);
    for (size_t k = 0; k < cells.cells[i]; ++k) {
      for (size_t j = 0; k < of.count && j < of.size(k); ++j) {
        const int64_t number = of.point(k, j);
        if (number < 0 || size_t(number) >= face.count)
          g.file.fail(fmt::format("gives cell {} the face {} of {}", k, number, face.count), g.at("PolyhedronToFaces"));
        for (size_t q = 0; q < face.size(size_t(number)); ++q) {
          const int64_t v = face.point(size_t(number), q);
          out.push_back(v < 0 || uint64_t(v) >= p.points[i] ? -1 : v + int64_t(point));  // -1: for validate() to refuse
        }
        offsets.push_back(int64_t(out.size()));
      }
      cell_faces.push_back(int64_t(offsets.size()) - 1);
    }
    f += faces[i] + 1, o += ids[i], c += cells.cells[i] + 1, l += links[i], point += p.points[i];
  }
  mesh.faces.connectivity = Array::from_vector(std::move(out));
  mesh.faces.offsets = Array::from_vector(std::move(offsets));
  mesh.polyhedron_faces = Array::from_vector(std::move(cell_faces));
}

bool has_polyhedra(const UnstructuredMesh& m) {
  if (m.types.empty()) return m.single_type == CellType::polyhedron;
  const auto t = m.types.view<uint8_t>();
  return std::find(t.data, t.data + t.count, uint8_t(CellType::polyhedron)) != t.data + t.count;
}

// An id beyond its partition would else point into the next one.
void check_partitions(const Partitions& p, const CellLists& r) {
  if (p.size() < 2) return;
  for (size_t i = 0; i < p.size(); ++i) {
    const Array& ids = r.lists[i].connectivity;
    if (ids.empty()) continue;
    const IndexView v = index_view(ids);
    for (size_t k = 0; k < ids.count(); ++k)
      if (v[k] < 0 || uint64_t(v[k]) >= p.points[i])
        fail_data(fmt::format("partition {}: point id {} is not in 0..{}", p.first + i, v[k], int64_t(p.points[i]) - 1));
  }
}

void add_point_fields(const Group& g, const Partitions& p, DatasetParts& parts) {
  for (const std::string& name : field_names(g, "PointData"))
    parts.fields.add(
        field_of(g, "PointData", name, Association::point, read_field(g, "PointData", name, p.point_offset, 0, p.point_count)));
}

// What shapes high-order cells: the field that the attribute of that name names, else the field of that name.
const Field* shaping_field(const Group& g, const std::string& data, const char* attribute, Association association,
                           const DatasetParts& parts) {
  const auto named = g.file.is_group(g.at(data)) ? g.file.text_attribute(g.at(data), attribute) : std::nullopt;
  return parts.fields.find(named.value_or(attribute), association);
}

}  // namespace

void read_unstructured(const Group& g, DatasetParts& parts) {
  const Partitions p = partitions_of(g);
  UnstructuredMesh mesh;
  mesh.points.xyz = read_points(g, p);
  const CellLists cells = read_lists(g, p, "", 0);
  check_partitions(p, cells);
  mesh.cells = vtk::concatenated_cells(cells.lists, starts(p.points));
  if (cells.cell_count > 0) {
    const Array types = h5::Dataset(g.file, g.at("Types")).read_rows(cells.cell_offset, cells.cell_count);
    if (is_float(types.type()) || types.components() != 1) g.file.fail("is not a list of cell types", g.at("Types"));
    vtk::set_types(mesh, types);
    if (has_polyhedra(mesh)) {
      if (!g.file.is_dataset(g.at("FaceConnectivity")))
        g.file.fail("has polyhedra without faces", g.path, "faces are stored since version 2.5 of the format");
      read_faces(g, p, cells, mesh);
    }
  }
  add_point_fields(g, p, parts);
  for (const std::string& name : field_names(g, "CellData"))
    parts.fields.add(
        field_of(g, "CellData", name, Association::cell, read_field(g, "CellData", name, cells.cell_offset, 0, cells.cell_count)));
  if (const Field* f = shaping_field(g, "PointData", "RationalWeights", Association::point, parts)) vtk::set_weights(mesh, *f);
  if (const Field* f = shaping_field(g, "CellData", "HigherOrderDegrees", Association::cell, parts)) vtk::set_degrees(mesh, *f);
  parts.mesh = std::move(mesh);
}

void read_polydata(const Group& g, DatasetParts& parts) {
  constexpr std::pair<const char*, CellArray SurfaceMesh::*> kinds[] = {{"Vertices/", &SurfaceMesh::vertices},
                                                                        {"Lines/", &SurfaceMesh::lines},
                                                                        {"Polygons/", &SurfaceMesh::polygons},
                                                                        {"Strips/", &SurfaceMesh::strips}};
  const Partitions p = partitions_of(g);
  SurfaceMesh mesh;
  mesh.points.xyz = read_points(g, p);
  std::array<std::vector<uint64_t>, 4> cells;  // per kind and partition
  uint64_t cell_count = 0, cell_offset = 0;
  for (uint64_t k = 0; k < 4; ++k) {
    cells[k].assign(p.size(), 0);
    if (!g.file.is_group(g.at(std::string(kinds[k].first, std::strlen(kinds[k].first) - 1)))) continue;
    const CellLists lists = read_lists(g, p, kinds[k].first, k);
    check_partitions(p, lists);
    mesh.*kinds[k].second = vtk::concatenated_cells(lists.lists, starts(p.points));
    cells[k] = lists.cells;
    cell_count += lists.cell_count, cell_offset += lists.cell_offset;
  }
  if (cell_count == 0 && g.file.text_attribute(g.path, "Kind").value_or("") == "points")
    parts.mesh = PointCloud{std::move(mesh.points)};  // as clouds are written
  else parts.mesh = std::move(mesh);
  add_point_fields(g, p, parts);
  for (const std::string& name : field_names(g, "CellData")) {
    Array a = read_field(g, "CellData", name, cell_offset, 0, cell_count);
    if (p.size() > 1) {  // the file goes partition by partition, the mesh kind by kind
      std::vector<Array> slices[4];
      size_t at = 0;
      for (size_t i = 0; i < p.size(); ++i)
        for (size_t k = 0; k < 4; ++k) slices[k].push_back(a.slice(at, at + cells[k][i])), at += cells[k][i];
      std::vector<Array> all;
      for (const auto& s : slices) all.insert(all.end(), s.begin(), s.end());
      a = vtk::concatenated(all);
    }
    parts.fields.add(field_of(g, "CellData", name, Association::cell, std::move(a)));
  }
}

}  // namespace sg::vtkhdf
