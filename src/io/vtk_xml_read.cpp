// SPDX-License-Identifier: Apache-2.0
// VTK XML files, reading: the choice of the kind, fields, unstructured grids and polygonal data.
// Format: VTK User's Guide, "XML file formats".
#include "base/bytes.h"
#include "base/text.h"
#include "io/formats.h"
#include "io/vtk_cells.h"
#include "io/vtk_xml_pieces.h"

namespace sg {

bool sniff_vtk_xml(std::span<const std::byte> head) {
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  const size_t root = text.find("<VTKFile");
  if (root == std::string_view::npos) return false;
  // Collections (.vtm, .pvd) and parallel headers (.pvtu) have the same root but are other formats.
  size_t type = root;  // the attribute type, not header_type
  do type = text.find("type=", type + 1);
  while (type != std::string_view::npos && static_cast<unsigned char>(text[type - 1]) > ' ');
  if (type == std::string_view::npos || type + 6 >= text.size()) return true;
  const std::string_view name = text.substr(type + 6, text.find_first_of("\"'", type + 6) - type - 6);
  for (std::string_view t : {"ImageData", "RectilinearGrid", "StructuredGrid", "UnstructuredGrid", "PolyData"})
    if (t == name) return true;
  return false;
}

namespace vtk {

pugi::xml_node find_array(pugi::xml_node parent, std::string_view name) {
  for (const pugi::xml_node& n : parent.children("DataArray"))
    if (equal_ignoring_case(n.attribute("Name").value(), name)) return n;
  return {};
}

pugi::xml_node need_array(const XmlRead& read, pugi::xml_node parent, std::string_view name) {
  const pugi::xml_node n = find_array(parent, name);
  if (!n) read.file.fail(fmt::format("has no DataArray '{}'", name), parent, "the file is truncated or not complete");
  return n;
}

namespace {

Role role_of(pugi::xml_node data, std::string_view name) {
  constexpr std::pair<const char*, Role> roles[] = {
      {"Scalars", Role::scalars}, {"Vectors", Role::vectors},      {"Normals", Role::normals},       {"TCoords", Role::tcoords},
      {"Tensors", Role::tensors}, {"GlobalIds", Role::global_ids}, {"PedigreeIds", Role::global_ids}};
  for (const auto& [attribute, role] : roles)
    if (data.attribute(attribute) && name == data.attribute(attribute).value()) return role;
  return Role::none;
}

}  // namespace

FieldSet read_fields(const XmlRead& read, pugi::xml_node parent, const char* element, Association association,
                     std::optional<uint64_t> tuples) {
  FieldSet fields;
  const auto& wanted = read.options.fields;
  for (const pugi::xml_node& data : parent.children(element))
    for (const pugi::xml_node& n : data.children()) {
      if (!XmlFile::is_numeric(n)) continue;  // strings and element types of later versions
      std::string name = n.attribute("Name").value();
      if (!wanted.empty() && !is_ghost_name(name) && std::find(wanted.begin(), wanted.end(), name) == wanted.end()) continue;
      read.context.check();
      std::optional<uint64_t> count = tuples;
      if (association == Association::whole && n.attribute("NumberOfTuples")) count = parse_count(read.file, n, "NumberOfTuples");
      const Role role = role_of(data, name);
      if (name.empty()) name = fmt::format("unnamed {}", fields.size());
      fields.add({std::move(name), association, read.file.array(n, count), {}, role});
    }
  return fields;
}

Array read_points(const XmlRead& read, pugi::xml_node piece, uint64_t tuples) {
  const pugi::xml_node points = piece.child("Points");
  const pugi::xml_node n = points.child("DataArray");
  if (!n) {
    if (tuples == 0) return {};
    read.file.fail("has no Points", piece, "the file is truncated or not complete");
  }
  const Array a = as_coordinates(read.file.array(n, tuples));
  if (a.components() != 3) read.file.fail(fmt::format("has {} coordinates per point", a.components()), n, "3");
  return a;
}

std::vector<SharedField> shared_fields(const XmlRead& read, const std::vector<FieldSet>& pieces) {
  std::vector<SharedField> shared;
  if (pieces.empty()) return shared;
  for (const Field& f : pieces[0]) {
    SharedField s{&f, {}};
    for (const FieldSet& p : pieces) {
      const Field* other = p.find(f.name, f.association);
      if (other && other->array.type() == f.array.type() && other->components() == f.components()) s.arrays.push_back(other->array);
    }
    if (s.arrays.size() == pieces.size()) shared.push_back(std::move(s));
    else read.context.warn(fmt::format("{} array '{}' is not the same in all pieces: left out", association_name(f.association), f.name));
  }
  return shared;
}

namespace {

// Versions up to 2.2: one stream of faces for each polyhedron, and where it ends (-1 for other cells).
void read_face_streams(const XmlRead& read, pugi::xml_node cells, UnstructuredMesh& mesh, uint64_t n) {
  const Array stream = as_indices(read.file.array(need_array(read, cells, "faces"), std::nullopt));
  const Array ends = as_indices(read.file.array(need_array(read, cells, "faceoffsets"), n));
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
                fmt::format("{}: DataArray 'faceoffsets'", read.file.path()));
    faces.add(at, begin, size_t(end[c]));
    begin = size_t(end[c]);
  }
  faces.finish(mesh);
}

// Since version 2.3: faces as a cell list of their own, and the faces of each polyhedron.
void read_face_lists(const XmlRead& read, pugi::xml_node cells, UnstructuredMesh& mesh, uint64_t n) {
  auto list = [&](const char* name) { return as_indices(read.file.array(need_array(read, cells, name), std::nullopt)); };
  auto ends = [&](const char* name) {  // with or without the leading zero
    const Array a = list(name);
    return a.count() > 0 && index_view(a)[0] == 0 ? a.slice(1, a.count()) : a;
  };
  const CellArray all = cells_from_ends(ends("face_offsets"), list("face_connectivity"));
  const Array of_cell = list("polyhedron_to_faces"),
              cell_ends = as_indices(read.file.array(need_array(read, cells, "polyhedron_offsets"), std::nullopt));
  const size_t skip = cell_ends.count() == n + 1 ? 1 : 0;
  if (cell_ends.count() < n) read.file.fail(fmt::format("has polyhedron_offsets of {} cells, not {}", cell_ends.count(), n), cells);
  const CellsView faces = cells_view(all);
  const IndexView face = index_view(of_cell), end = index_view(cell_ends);
  std::vector<int64_t> ids, offsets{0}, cell_faces{0};
  size_t at = 0;
  for (size_t c = 0; c < n; ++c) {
    for (; int64_t(at) < end[c + skip]; ++at) {
      if (at >= of_cell.count() || face[at] < 0 || size_t(face[at]) >= faces.count)
        fail_data(fmt::format("cell {} has a face that is not there", c),
                  fmt::format("{}: DataArray 'polyhedron_to_faces'", read.file.path()));
      for (size_t k = 0; k < faces.size(size_t(face[at])); ++k) ids.push_back(faces.point(size_t(face[at]), k));
      offsets.push_back(int64_t(ids.size()));
    }
    cell_faces.push_back(int64_t(offsets.size()) - 1);
  }
  mesh.faces.connectivity = Array::from_vector(std::move(ids));
  mesh.faces.offsets = Array::from_vector(std::move(offsets));
  mesh.polyhedron_faces = Array::from_vector(std::move(cell_faces));
}

CellArray read_cells(const XmlRead& read, pugi::xml_node cells, uint64_t n) {
  if (n == 0) return {};
  const pugi::xml_node offsets = need_array(read, cells, "offsets"), connectivity = need_array(read, cells, "connectivity");
  return with_context(fmt::format("taking apart the cells of {}", cells.name()), [&] {
    // Cells of one size: one look at the offsets where they lie, and they need not become an array.
    ElementType type{};
    if (const std::byte* p = read.file.in_place(offsets, n, type))
      if (const int size = uniform_size(p, type, n)) return cells_of_size(size, n, read.file.array(connectivity, n * uint64_t(size)));
    const Array ends = as_indices(read.file.array(offsets, n));
    const int64_t last = index_view(ends)[n - 1];
    if (last < 0) read.file.fail(fmt::format("has the offset {}", last), offsets);
    return cells_from_ends(ends, read.file.array(connectivity, uint64_t(last)));
  });
}

UnstructuredMesh unstructured_piece(const XmlRead& read, pugi::xml_node piece, uint64_t points, uint64_t n) {
  UnstructuredMesh mesh;
  mesh.points.xyz = read_points(read, piece, points);
  const pugi::xml_node cells = piece.child("Cells");
  if (n == 0) return mesh;
  if (!cells) read.file.fail("has no Cells", piece, "the file is truncated or not complete");
  mesh.cells = read_cells(read, cells, n);
  const pugi::xml_node types_element = need_array(read, cells, "types");
  const Array types = read.file.array(types_element, n);
  if (is_float(types.type()) || types.components() != 1) read.file.fail("is no list of cell types", types_element);
  set_types(mesh, types);
  if (!mesh.types.empty()) {
    const auto t = mesh.types.view<uint8_t>();
    if (std::find(t.data, t.data + t.count, uint8_t(CellType::polyhedron)) != t.data + t.count) {
      if (find_array(cells, "polyhedron_to_faces")) read_face_lists(read, cells, mesh, n);
      else read_face_streams(read, cells, mesh, n);
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

}  // namespace

void read_unstructured(const XmlRead& read, DatasetParts& parts) {
  std::vector<UnstructuredMesh> meshes;
  std::vector<FieldSet> fields;
  for (const pugi::xml_node& piece : read.file.dataset().children("Piece")) {
    const uint64_t points = parse_count(read.file, piece, "NumberOfPoints"), cells = parse_count(read.file, piece, "NumberOfCells");
    if (points == 0 && cells == 0) continue;
    meshes.push_back(unstructured_piece(read, piece, points, cells));
    fields.push_back(read_fields(read, piece, "PointData", Association::point, points));
    for (const Field& f : read_fields(read, piece, "CellData", Association::cell, cells)) fields.back().add(f);
  }
  for (const SharedField& s : shared_fields(read, fields)) {
    Field f = *s.first;
    f.array = concatenated(s.arrays);
    parts.fields.add(std::move(f));
  }
  parts.mesh = meshes.empty() ? UnstructuredMesh{} : joined(std::move(meshes));
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

Array joined_cell_field(const std::vector<Array>& arrays, const std::vector<SurfaceMesh>& meshes) {
  if (arrays.size() == 1) return arrays[0];
  std::vector<Array> slices;
  std::vector<size_t> begin(arrays.size(), 0);
  for (const auto& kind : surface_lists)
    for (size_t i = 0; i < arrays.size(); ++i) {
      const size_t n = (meshes[i].*kind.list).size();
      slices.push_back(arrays[i].slice(begin[i], begin[i] + n));
      begin[i] += n;
    }
  return concatenated(slices);
}

}  // namespace

void read_polydata(const XmlRead& read, DatasetParts& parts) {
  std::vector<SurfaceMesh> meshes;
  std::vector<FieldSet> fields;
  for (const pugi::xml_node& piece : read.file.dataset().children("Piece")) {
    const uint64_t points = parse_count(read.file, piece, "NumberOfPoints");
    SurfaceMesh mesh;
    mesh.points.xyz = read_points(read, piece, points);
    for (const auto& kind : surface_lists) {
      const uint64_t n = parse_count(read.file, piece, kind.count);
      if (n > 0 && !piece.child(kind.element))
        read.file.fail(fmt::format("has no {}", kind.element), piece, "the file is truncated or not complete");
      mesh.*kind.list = read_cells(read, piece.child(kind.element), n);
    }
    if (points == 0 && mesh.cell_count() == 0) continue;
    fields.push_back(read_fields(read, piece, "PointData", Association::point, points));
    for (const Field& f : read_fields(read, piece, "CellData", Association::cell, mesh.cell_count())) fields.back().add(f);
    meshes.push_back(std::move(mesh));
  }
  for (const SharedField& s : shared_fields(read, fields)) {
    Field f = *s.first;
    f.array = f.association == Association::cell ? joined_cell_field(s.arrays, meshes) : concatenated(s.arrays);
    parts.fields.add(std::move(f));
  }
  SurfaceMesh out;
  if (meshes.size() == 1) {
    out = std::move(meshes[0]);
  } else if (!meshes.empty()) {
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
  }
  parts.mesh = std::move(out);
}

}  // namespace vtk

Data read_vtk_xml(const std::string& path, const ReadOptions& options, Context& context) {
  const vtk::XmlFile file(path);
  const vtk::XmlRead read{file, options, context};
  constexpr std::pair<std::string_view, void (*)(const vtk::XmlRead&, DatasetParts&)> kinds[] = {
      {"ImageData", vtk::read_image},
      {"RectilinearGrid", vtk::read_rectilinear},
      {"StructuredGrid", vtk::read_curvilinear},
      {"UnstructuredGrid", vtk::read_unstructured},
      {"PolyData", vtk::read_polydata}};
  for (const auto& [type, read_kind] : kinds) {
    if (file.type() != type) continue;
    DatasetParts parts;
    read_kind(read, parts);
    for (const pugi::xml_node& owner : {file.dataset(), file.dataset().parent()})
      for (const Field& f : vtk::read_fields(read, owner, "FieldData", Association::whole, std::nullopt)) {
        if (f.name == "TimeValue" && f.array.count() == 1 && f.components() == 1) parts.time = f.array.get(0);
        else parts.fields.add(f);
      }
    vtk::take_ghosts(parts);
    return make_dataset(std::move(parts));
  }
  fail_data(fmt::format("has the type '{}'", file.type()), path,
            "ImageData, RectilinearGrid, StructuredGrid, UnstructuredGrid or PolyData");
}

}  // namespace sg
