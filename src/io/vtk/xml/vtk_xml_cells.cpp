// SPDX-License-Identifier: Apache-2.0
// VTK XML unstructured grids and polygonal data: pieces are joined to one mesh, in their order.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "io/vtk/vtk_cells.h"
#include "io/vtk/xml/vtk_xml_pieces.h"

namespace sg::vtk {

namespace {

// Versions up to 2.2: one stream of faces for each polyhedron, and where it ends (-1 for other cells).
void read_face_streams(const XmlFile& file, pugi::xml_node cells, UnstructuredMesh& mesh, uint64_t n) {
  const Array stream = as_indices(file.array(need_array(file, cells, "faces"), std::nullopt));
  const Array ends = as_indices(file.array(need_array(file, cells, "faceoffsets"), n));
  const IndexView at = index_view(stream), end = index_view(ends);
  FaceCollector faces;
  size_t begin = 0;
  for (size_t c = 0; c < n; ++c) {
    if (mesh.type(c) != CellType::polyhedron || end[c] < 0) {
      faces.add_none();
      continue;
    }
    if (size_t(end[c]) > stream.count() || size_t(end[c]) < begin)
      fail_data(fmt::format("the faces of cell {} end at {} of {}", c, end[c], stream.count()),
                fmt::format("{}: DataArray 'faceoffsets'", file.path()));
    faces.add(at, begin, size_t(end[c]));
    begin = size_t(end[c]);
  }
  faces.finish(mesh);
}

// Since version 2.3: faces as a cell list of their own, and the faces of each polyhedron.
void read_face_lists(const XmlFile& file, pugi::xml_node cells, UnstructuredMesh& mesh, uint64_t n) {
  auto list = [&](const char* name) { return as_indices(file.array(need_array(file, cells, name), std::nullopt)); };
  auto ends = [&](const char* name) {  // with or without the leading zero
    const Array a = list(name);
    return a.count() > 0 && index_view(a)[0] == 0 ? a.slice(1, a.count()) : a;
  };
  const CellArray all = cells_from_ends(ends("face_offsets"), list("face_connectivity"));
  const Array of_cell = list("polyhedron_to_faces"),
              cell_ends = as_indices(file.array(need_array(file, cells, "polyhedron_offsets"), std::nullopt));
  const size_t skip = cell_ends.count() == n + 1 ? 1 : 0;
  if (cell_ends.count() < n) file.fail(fmt::format("has polyhedron_offsets of {} cells, not {}", cell_ends.count(), n), cells);
  const CellsView faces = cells_view(all);
  const IndexView face = index_view(of_cell), end = index_view(cell_ends);
  std::vector<int64_t> ids, offsets{0}, cell_faces{0};
  size_t at = 0;
  for (size_t c = 0; c < n; ++c) {
    for (; int64_t(at) < end[c + skip]; ++at) {
      if (at >= of_cell.count() || face[at] < 0 || size_t(face[at]) >= faces.count)
        fail_data(fmt::format("cell {} has a face that does not exist", c),
                  fmt::format("{}: DataArray 'polyhedron_to_faces'", file.path()));
      // A face belongs to two cells; a file that attaches one face to thousands of them would fill the memory.
      if (ids.size() > 8 * all.connectivity.count() + 4096)
        file.fail("has faces that belong to far more than two cells", cells, "the file is damaged");
      for (size_t k = 0; k < faces.size(size_t(face[at])); ++k) ids.push_back(faces.point(size_t(face[at]), k));
      offsets.push_back(int64_t(ids.size()));
    }
    cell_faces.push_back(int64_t(offsets.size()) - 1);
  }
  mesh.faces.connectivity = Array::from_vector(std::move(ids));
  mesh.faces.offsets = Array::from_vector(std::move(offsets));
  mesh.polyhedron_faces = Array::from_vector(std::move(cell_faces));
}

CellArray read_cells(const XmlFile& file, pugi::xml_node cells, uint64_t n) {
  if (n == 0) return {};
  const pugi::xml_node offsets = need_array(file, cells, "offsets"), connectivity = need_array(file, cells, "connectivity");
  return with_context(fmt::format("splitting the cells of {}", cells.name()), [&] {
    // Cells of one size: one look at the offsets where they lie, and they need not become an array.
    ElementType type{};
    if (const std::byte* p = file.in_place(offsets, n, type))
      if (const int size = uniform_size(p, type, n)) return cells_of_size(size, n, file.ids(connectivity, n * uint64_t(size)));
    if (const int size = file.equal_steps(offsets, n)) return cells_of_size(size, n, file.ids(connectivity, n * uint64_t(size)));
    const Array ends = as_indices(file.array(offsets, n));
    const int64_t last = index_view(ends)[n - 1];
    if (last < 0) file.fail(fmt::format("has the offset {}", last), offsets);
    return cells_from_ends(ends, file.ids(connectivity, uint64_t(last)));
  });
}

UnstructuredMesh unstructured_piece(const XmlPiece& piece, uint64_t points, uint64_t n) {
  const XmlFile& file = *piece.file;
  UnstructuredMesh mesh;
  mesh.points.xyz = read_points(piece, points);
  const pugi::xml_node cells = piece.node.child("Cells");
  if (n == 0) return mesh;
  if (!cells) file.fail("has no Cells", piece.node, "the file is truncated or not complete");
  mesh.cells = read_cells(file, cells, n);
  const pugi::xml_node types_element = need_array(file, cells, "types");
  const Array types = file.array(types_element, n);
  if (is_float(types.type()) || types.components() != 1) file.fail("is not a list of cell types", types_element);
  set_types(mesh, types);
  if (!mesh.types.empty()) {
    const auto t = mesh.types.view<uint8_t>();
    if (std::find(t.data, t.data + t.count, uint8_t(CellType::polyhedron)) != t.data + t.count) {
      if (find_array(cells, "polyhedron_to_faces")) read_face_lists(file, cells, mesh, n);
      else read_face_streams(file, cells, mesh, n);
    }
  }
  return mesh;
}

// Points of all pieces; f64 as soon as one piece is.
Points joined_points(std::vector<Array> parts) {
  bool wide = false;
  for (const Array& a : parts) wide = wide || a.type() == ElementType::f64;
  if (wide)
    for (Array& a : parts) a = a.converted(ElementType::f64);
  return {concatenated(parts)};
}

// Faces of polyhedra of all pieces; cells of pieces without any have none.
void join_faces(const std::vector<UnstructuredMesh>& parts, std::span<const size_t> shift, UnstructuredMesh& out) {
  std::vector<CellArray> lists;
  std::vector<int64_t> cell_faces{0};
  int64_t faces = 0;
  for (const UnstructuredMesh& m : parts) {
    lists.push_back(m.faces);
    for (size_t c = 0; c < m.cells.size(); ++c)
      cell_faces.push_back(faces + (m.polyhedron_faces.empty() ? 0 : m.polyhedron_faces.view<int64_t>()[c + 1]));
    faces += int64_t(m.faces.size());
  }
  if (faces == 0) return;
  out.faces = concatenated_cells(lists, shift);
  out.polyhedron_faces = Array::from_vector(std::move(cell_faces));
}

UnstructuredMesh joined(std::vector<UnstructuredMesh> parts) {
  if (parts.size() == 1) return std::move(parts[0]);
  UnstructuredMesh out;
  std::vector<Array> xyz;
  std::vector<CellArray> cells;
  std::vector<size_t> shift;
  size_t points = 0, n = 0;
  bool one_type = true;
  for (const UnstructuredMesh& m : parts) {
    validate(m);  // an id beyond its piece would else point into the next one
    xyz.push_back(m.points.xyz), cells.push_back(m.cells), shift.push_back(points);
    points += m.points.count(), n += m.cells.size();
    if (m.cells.size() == 0) continue;
    if (out.single_type == CellType::empty) out.single_type = m.single_type;
    one_type = one_type && m.types.empty() && m.single_type == out.single_type;
  }
  if (!one_type) {
    uint8_t* t = nullptr;
    out.types = Array::make<uint8_t>(n, 1, &t);
    for (const UnstructuredMesh& m : parts)
      for (size_t c = 0; c < m.cells.size(); ++c) *t++ = uint8_t(m.type(c));
    out.single_type = CellType::empty;
  }
  out.points = joined_points(std::move(xyz));
  out.cells = concatenated_cells(cells, shift);
  join_faces(parts, shift, out);
  return out;
}

// Named so, or named by the attribute of that name.
bool is_attribute(const XmlField& f, const char* attribute) {
  const pugi::xml_node data = f.nodes[0].parent();
  return data.attribute(attribute) ? f.field.name == data.attribute(attribute).value() : f.field.name == attribute;
}

}  // namespace

void read_unstructured(const XmlRead& read, DatasetParts& parts) {
  std::vector<UnstructuredMesh> meshes;
  std::vector<XmlPiece> pieces;
  std::vector<size_t> points, cells;
  for (const XmlPiece& piece : read.pieces) {
    const uint64_t n = parse_count(*piece.file, piece.node, "NumberOfPoints"), m = parse_count(*piece.file, piece.node, "NumberOfCells");
    if (n == 0 && m == 0) continue;
    read.context.check();
    meshes.push_back(unstructured_piece(piece, n, m));
    pieces.push_back(piece), points.push_back(n), cells.push_back(m);
  }
  if (pieces.empty() && !read.pieces.empty())  // nothing at all: the first piece still names the fields
    meshes.emplace_back(), pieces.push_back(read.pieces[0]), points.push_back(0), cells.push_back(0);
  UnstructuredMesh mesh = meshes.empty() ? UnstructuredMesh{} : joined(std::move(meshes));
  for (const XmlField& f : list_fields(read, pieces, "PointData", Association::point)) {
    Field field = f.field;
    field.array = joined_field(read, pieces, f, points);
    if (is_attribute(f, "RationalWeights")) set_weights(mesh, field);
    parts.fields.add(std::move(field));
  }
  for (const XmlField& f : list_fields(read, pieces, "CellData", Association::cell)) {
    Field field = f.field;
    field.array = joined_field(read, pieces, f, cells);
    if (is_attribute(f, "HigherOrderDegrees")) set_degrees(mesh, field);
    parts.fields.add(std::move(field));
  }
  add_categories(read, pieces, "PointData", Association::point, points, parts);
  add_categories(read, pieces, "CellData", Association::cell, cells, parts);
  parts.mesh = std::move(mesh);
}

namespace {

// The four cell lists in the order in which cell data are numbered.
constexpr struct {
  const char* element;
  const char* count;
  CellArray SurfaceMesh::*list;
} surface_lists[] = {{"Verts", "NumberOfVerts", &SurfaceMesh::vertices},
                     {"Lines", "NumberOfLines", &SurfaceMesh::lines},
                     {"Polys", "NumberOfPolys", &SurfaceMesh::polygons},
                     {"Strips", "NumberOfStrips", &SurfaceMesh::strips}};

// Cells of each list of all pieces lie together, so cell data do too.
Array joined_cell_field(const XmlRead& read, const std::vector<XmlPiece>& pieces, const XmlField& f,
                        const std::vector<SurfaceMesh>& meshes) {
  std::vector<size_t> cells;
  size_t total = 0;
  for (const SurfaceMesh& m : meshes) cells.push_back(m.cell_count()), total += cells.back();
  if (meshes.size() == 1 || header_only(read, f)) return joined_field(read, pieces, f, cells);
  check_backed(pieces, f, total);
  std::byte* out = nullptr;
  Array all = Array::make_raw(f.type, total, f.components, &out);
  if (total > 0) std::memset(out, 0, all.bytes());
  const size_t tuple = size_t(f.components) * element_size(f.type);
  size_t place[std::size(surface_lists)], next = 0;  // of the next piece's cells of each list
  for (size_t k = 0; k < std::size(surface_lists); ++k) {
    place[k] = next;
    for (const SurfaceMesh& m : meshes) next += (m.*surface_lists[k].list).size();
  }
  for (size_t i = 0; i < meshes.size(); ++i) {
    const Array part = f.nodes[i] ? pieces[i].file->array(f.nodes[i], cells[i]).made_packed() : Array();
    for (size_t k = 0, from = 0; k < std::size(surface_lists); ++k) {
      const size_t n = (meshes[i].*surface_lists[k].list).size();
      if (n > 0 && f.nodes[i]) std::memcpy(out + place[k] * tuple, part.raw() + from * tuple, n * tuple);
      from += n, place[k] += n;
    }
  }
  return all;
}

SurfaceMesh joined(const std::vector<SurfaceMesh>& meshes) {
  SurfaceMesh out;
  std::vector<Array> xyz;
  std::vector<size_t> shift;
  size_t n = 0;
  for (const SurfaceMesh& m : meshes) {
    validate(m);
    xyz.push_back(m.points.xyz), shift.push_back(n);
    n += m.points.count();
  }
  out.points = joined_points(std::move(xyz));
  for (const auto& kind : surface_lists) {
    std::vector<CellArray> lists;
    for (const SurfaceMesh& m : meshes) lists.push_back(m.*kind.list);
    out.*kind.list = concatenated_cells(lists, shift);
  }
  return out;
}

}  // namespace

void read_polydata(const XmlRead& read, DatasetParts& parts) {
  std::vector<SurfaceMesh> meshes;
  std::vector<XmlPiece> pieces;
  std::vector<size_t> points;
  for (const XmlPiece& piece : read.pieces) {
    const XmlFile& file = *piece.file;
    const uint64_t n = parse_count(file, piece.node, "NumberOfPoints");
    read.context.check();
    SurfaceMesh mesh;
    mesh.points.xyz = read_points(piece, n);
    for (const auto& kind : surface_lists) {
      const uint64_t cells = parse_count(file, piece.node, kind.count);
      if (cells > 0 && !piece.node.child(kind.element))
        file.fail(fmt::format("has no {}", kind.element), piece.node, "the file is truncated or not complete");
      mesh.*kind.list = read_cells(file, piece.node.child(kind.element), cells);
    }
    if (n == 0 && mesh.cell_count() == 0) continue;
    meshes.push_back(std::move(mesh)), pieces.push_back(piece), points.push_back(n);
  }
  if (pieces.empty() && !read.pieces.empty()) meshes.emplace_back(), pieces.push_back(read.pieces[0]), points.push_back(0);
  for (const XmlField& f : list_fields(read, pieces, "PointData", Association::point)) {
    Field field = f.field;
    field.array = joined_field(read, pieces, f, points);
    parts.fields.add(std::move(field));
  }
  for (const XmlField& f : list_fields(read, pieces, "CellData", Association::cell)) {
    Field field = f.field;
    field.array = joined_cell_field(read, pieces, f, meshes);
    parts.fields.add(std::move(field));
  }
  add_categories(read, pieces, "PointData", Association::point, points, parts);
  if (meshes.size() == 1) add_categories(read, pieces, "CellData", Association::cell, {meshes[0].cell_count()}, parts);
  if (meshes.size() == 1) parts.mesh = std::move(meshes[0]);
  else parts.mesh = meshes.empty() ? SurfaceMesh{} : joined(meshes);
}

}  // namespace sg::vtk
