// SPDX-License-Identifier: Apache-2.0
// VTK XML files, writing: one piece that holds the whole dataset.
#include "base/parallel.h"
#include "base/text.h"
#include "data/lattice.h"
#include "io/formats.h"
#include "io/vtk_xml_encode.h"

namespace sg {

namespace vtk {
namespace {

struct KindRow {
  std::string_view extension, element;
};

// The extension and the dataset element of each mesh kind; none for AMR.
KindRow kind_row(const Mesh& mesh) {
  struct Visitor {
    KindRow operator()(const UniformGrid&) const { return {"vti", "ImageData"}; }
    KindRow operator()(const RectilinearGrid&) const { return {"vtr", "RectilinearGrid"}; }
    KindRow operator()(const CurvilinearGrid&) const { return {"vts", "StructuredGrid"}; }
    KindRow operator()(const UnstructuredMesh&) const { return {"vtu", "UnstructuredGrid"}; }
    KindRow operator()(const SurfaceMesh&) const { return {"vtp", "PolyData"}; }
    KindRow operator()(const PointCloud&) const { return {"vtp", "PolyData"}; }
    KindRow operator()(const AmrGrid&) const { return {}; }
  };
  return std::visit(Visitor{}, mesh);
}

std::string three(Vec3 v) { return fmt::format("{} {} {}", exact_number(v.x), exact_number(v.y), exact_number(v.z)); }

std::string extent_text(const std::array<size_t, 3>& dims, const std::array<long long, 3>& lo) {
  std::string r;
  for (size_t a = 0; a < 3; ++a) r += fmt::format("{}{} {}", a ? " " : "", lo[a], lo[a] + (long long)(dims[a]) - 1);
  return r;
}

// The origin of index (0,0,0) that gives exactly our origin at the first point; nothing when rounding is in the way.
std::optional<Vec3> origin_of_zero(const UniformGrid& g) {
  const Vec3 first = g.direction * (g.spacing * Vec3(double(g.extent_start[0]), double(g.extent_start[1]), double(g.extent_start[2])));
  const Vec3 zero = g.origin - first;
  if (!(zero + first == g.origin)) return std::nullopt;
  return zero;
}

// Positions as they are written: f64 with the origin added, where there is one.
Array positions(const Points& p) {
  if (p.origin == Vec3{0, 0, 0}) return p.count() ? p.xyz : Array({}, p.xyz.type(), 0, 3);
  double* out = nullptr;
  Array a = Array::make<double>(p.count(), 3, &out);
  dispatch(p.xyz, [&](auto v) {
    parallel_for(v.count, 1 << 15, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        for (int c = 0; c < 3; ++c) out[3 * i + size_t(c)] = p.origin[c] + double(v(i, c));
    });
  });
  return a;
}

// End offsets of cells of one size.
Array fixed_ends(size_t n, int size) {
  int64_t* out = nullptr;
  Array a = Array::make<int64_t>(n, 1, &out);
  for (size_t i = 0; i < n; ++i) out[i] = int64_t(i + 1) * size;
  return a;
}

void write_points(XmlWriter& xml, const Points& points) {
  xml.begin("Points");
  xml.array("Points", positions(points));
  xml.end();
}

void write_cell_list(XmlWriter& xml, const CellArray& cells) {
  const size_t n = cells.size();
  if (n == 0) {
    xml.array("connectivity", Array({}, ElementType::i64, 0));
    xml.array("offsets", Array({}, ElementType::i64, 0));
    return;
  }
  const Array ends = cells.fixed > 0 ? fixed_ends(n, cells.fixed) : cells.offsets.slice(1, n + 1);
  xml.array("connectivity", cells.connectivity.slice(0, size_t(index_view(ends)[n - 1])));
  xml.array("offsets", ends);
}

void write_faces(XmlWriter& xml, const UnstructuredMesh& m) {
  const CellsView faces = cells_view(m.faces);
  const auto of_cell = m.polyhedron_faces.view<int64_t>();
  std::vector<int64_t> stream, ends;
  for (size_t c = 0; c < m.cells.size(); ++c) {
    if (m.type(c) != CellType::polyhedron) {
      ends.push_back(-1);
      continue;
    }
    stream.push_back(of_cell[c + 1] - of_cell[c]);
    for (auto f = size_t(of_cell[c]); f < size_t(of_cell[c + 1]); ++f) {
      stream.push_back(int64_t(faces.size(f)));
      for (size_t k = 0; k < faces.size(f); ++k) stream.push_back(faces.point(f, k));
    }
    ends.push_back(int64_t(stream.size()));
  }
  xml.array("faces", Array::from_vector(std::move(stream)));
  xml.array("faceoffsets", Array::from_vector(std::move(ends)));
}

void write_cells(XmlWriter& xml, const UnstructuredMesh& m) {
  xml.begin("Cells");
  write_cell_list(xml, m.cells);
  Array types = m.types;
  if (types.empty()) {
    uint8_t* out = nullptr;
    types = Array::make<uint8_t>(m.cells.size(), 1, &out);
    std::fill(out, out + m.cells.size(), uint8_t(m.single_type));
  }
  xml.array("types", types);
  if (!m.polyhedron_faces.empty()) write_faces(xml, m);
  xml.end();
}

constexpr struct {
  const char* element;
  const char* count;
  CellArray SurfaceMesh::*list;
} surface_lists[] = {{"Verts", "NumberOfVerts", &SurfaceMesh::vertices},
                     {"Lines", "NumberOfLines", &SurfaceMesh::lines},
                     {"Strips", "NumberOfStrips", &SurfaceMesh::strips},
                     {"Polys", "NumberOfPolys", &SurfaceMesh::polygons}};

// A cloud is written with one vertex per point, so that every reader draws it.
SurfaceMesh as_surface(const Mesh& mesh) {
  if (auto* s = std::get_if<SurfaceMesh>(&mesh)) return *s;
  SurfaceMesh s;
  s.points = std::get<PointCloud>(mesh).points;
  std::vector<int64_t> ids(s.points.count());
  std::iota(ids.begin(), ids.end(), 0);
  s.vertices.connectivity = Array::from_vector(std::move(ids));
  s.vertices.fixed = 1;
  return s;
}

// PointData or CellData, with the attributes that say what an array is for.
void write_fields(XmlWriter& xml, const Dataset& d, Association association, const Array& ghost) {
  constexpr std::pair<Role, std::string_view> roles[] = {{Role::scalars, "Scalars"}, {Role::vectors, "Vectors"},
                                                         {Role::normals, "Normals"}, {Role::tcoords, "TCoords"},
                                                         {Role::tensors, "Tensors"}, {Role::global_ids, "GlobalIds"}};
  XmlAttributes attributes;
  for (const auto& [role, attribute] : roles)
    for (const Field& f : d.fields())
      if (f.association == association && f.role == role) {
        attributes.emplace_back(attribute, f.name);
        break;
      }
  xml.begin(association == Association::point ? "PointData" : "CellData", attributes);
  for (const Field& f : d.fields())
    if (f.association == association) xml.array(f.name, f.array);
  if (!ghost.empty()) xml.array("vtkGhostType", ghost);
  xml.end();
}

void write_whole(XmlWriter& xml, const Dataset& d) {
  xml.begin("FieldData");
  if (d.time()) xml.array("TimeValue", Array::from_vector(std::vector<double>{*d.time()}), true);
  for (const Field& f : d.fields())
    if (f.association == Association::whole) xml.array(f.name, f.array, true);
  xml.end();
}

struct Header {
  XmlAttributes dataset, piece;
};

Header header_of(const Dataset& d) {
  Header h;
  auto extent = [&](const std::array<long long, 3>& lo) {
    const std::string text = extent_text(lattice_dims(d.mesh()), lo);
    h.dataset.emplace_back("WholeExtent", text);
    h.piece.emplace_back("Extent", text);
  };
  if (auto* u = d.as<UniformGrid>()) {
    const auto zero = origin_of_zero(*u);
    extent(zero ? u->extent_start : std::array<long long, 3>{0, 0, 0});
    std::string direction;
    for (int i = 0; i < 9; ++i) direction += (i ? " " : "") + exact_number(u->direction.m[i / 3][i % 3]);
    h.dataset.insert(h.dataset.end(),
                     {{"Origin", three(zero.value_or(u->origin))}, {"Spacing", three(u->spacing)}, {"Direction", direction}});
  } else if (auto* r = d.as<RectilinearGrid>()) {
    extent(r->extent_start);
  } else if (auto* c = d.as<CurvilinearGrid>()) {
    extent(c->extent_start);
  } else if (d.as<UnstructuredMesh>()) {
    h.piece = {{"NumberOfPoints", std::to_string(d.point_count())}, {"NumberOfCells", std::to_string(d.cell_count())}};
  }
  return h;
}

void write_geometry(XmlWriter& xml, const Dataset& d) {
  if (auto* r = d.as<RectilinearGrid>()) {
    xml.begin("Coordinates");
    xml.array("x", r->x), xml.array("y", r->y), xml.array("z", r->z);
    xml.end();
  } else if (auto* c = d.as<CurvilinearGrid>()) {
    write_points(xml, c->points);
  } else if (auto* u = d.as<UnstructuredMesh>()) {
    write_points(xml, u->points);
    write_cells(xml, *u);
  }
}

void write_dataset(const std::string& path, const Dataset& d, const WriteOptions& options, Context& context) {
  const KindRow row = kind_row(d.mesh());
  const std::string ext = extension_of(path);
  if (row.extension.empty())
    fail_usage(fmt::format("a mesh of kind {} cannot be written as VTK XML", d.kind()), path, "resample it to a uniform grid first");
  if (ext != row.extension)
    fail_usage(fmt::format("a mesh of kind {} cannot be written to .{}", d.kind(), ext), path,
               fmt::format("name the file *.{}", row.extension));
  XmlWriter xml(path, options, context);
  const bool surface = row.extension == "vtp";
  Header h = header_of(d);
  const SurfaceMesh lists = surface ? as_surface(d.mesh()) : SurfaceMesh{};
  if (surface) {
    h.piece.emplace_back("NumberOfPoints", std::to_string(d.point_count()));
    for (const auto& kind : surface_lists) h.piece.emplace_back(kind.count, std::to_string((lists.*kind.list).size()));
  }
  xml.begin("VTKFile", {{"type", std::string(row.element)}, {"version", "1.0"}, {"byte_order", "LittleEndian"}, {"header_type", "UInt64"}});
  xml.begin(row.element, h.dataset);
  write_whole(xml, d);
  xml.begin("Piece", h.piece);
  write_fields(xml, d, Association::point, d.point_ghost());
  write_fields(xml, d, Association::cell, d.cell_ghost());
  if (surface) {
    write_points(xml, lists.points);
    for (const auto& kind : surface_lists) {
      xml.begin(kind.element);
      write_cell_list(xml, lists.*kind.list);
      xml.end();
    }
  } else {
    write_geometry(xml, d);
  }
  xml.finish();
}

}  // namespace
}  // namespace vtk

void write_vtk_xml(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  vtk::write_dataset(path, *single_dataset(data, "a VTK XML file"), options, context);
}

}  // namespace sg
