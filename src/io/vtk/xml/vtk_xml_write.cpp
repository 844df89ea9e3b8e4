// SPDX-License-Identifier: Apache-2.0
// VTK XML files, writing: one piece that holds the whole dataset.
#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "base/parallel.h"
#include "base/text/text.h"
#include "data/lattice.h"
#include "io/formats.h"
#include "io/vtk/vtk_cells.h"
#include "io/vtk/xml/vtk_xml_encode.h"

namespace sg {

namespace vtk {
namespace {

constexpr std::pair<std::string_view, std::string_view> elements[] = {
    {"vti", "ImageData"}, {"vtr", "RectilinearGrid"}, {"vts", "StructuredGrid"}, {"vtu", "UnstructuredGrid"}, {"vtp", "PolyData"}};

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
} written_lists[] = {{"Verts", "NumberOfVerts", &SurfaceMesh::vertices},
                     {"Lines", "NumberOfLines", &SurfaceMesh::lines},
                     {"Strips", "NumberOfStrips", &SurfaceMesh::strips},
                     {"Polys", "NumberOfPolys", &SurfaceMesh::polygons}};

// One vertex per point, so that every reader draws the cloud.
CellArray one_vertex_each(const PointCloud& cloud) {
  int64_t* ids = nullptr;
  CellArray cells;
  cells.connectivity = Array::make<int64_t>(cloud.points.count(), 1, &ids);
  std::iota(ids, ids + cloud.points.count(), 0);
  cells.fixed = 1;
  return cells;
}

SurfaceMesh as_surface(const Mesh& mesh) {
  if (auto* s = std::get_if<SurfaceMesh>(&mesh)) return *s;
  const auto& cloud = std::get<PointCloud>(mesh);
  SurfaceMesh s;
  s.points = cloud.points;
  s.vertices = one_vertex_each(cloud);
  return s;
}

// Surfaces and clouds as cells of an unstructured grid, in the order of their cell fields.
UnstructuredMesh as_unstructured(const Mesh& mesh) {
  if (auto* u = std::get_if<UnstructuredMesh>(&mesh)) return *u;
  UnstructuredMesh m;
  if (auto* cloud = std::get_if<PointCloud>(&mesh)) {
    m.points = cloud->points;
    m.cells = one_vertex_each(*cloud);
    m.single_type = CellType::vertex;
    return m;
  }
  const auto& s = std::get<SurfaceMesh>(mesh);
  m.points = s.points;
  const CellArray lists[] = {s.vertices, s.lines, s.polygons, s.strips};
  const size_t shift[] = {0, 0, 0, 0};
  m.cells = concatenated_cells(lists, shift);
  uint8_t* out = nullptr;
  m.types = Array::make<uint8_t>(s.cell_count(), 1, &out);
  auto add = [&](const CellArray& cells, size_t size, CellType one, CellType other) {
    const CellsView v = cells_view(cells);
    for (size_t i = 0; i < v.count; ++i)
      *out++ = uint8_t(v.size(i) == size ? one : v.size(i) == 4 && one == CellType::triangle ? CellType::quad : other);
  };
  add(s.vertices, 1, CellType::vertex, CellType::poly_vertex);
  add(s.lines, 2, CellType::line, CellType::poly_line);
  add(s.polygons, 3, CellType::triangle, CellType::polygon);
  add(s.strips, 0, CellType::triangle_strip, CellType::triangle_strip);
  return m;
}

// PointData or CellData, with the attributes that state an array's role.
void write_fields(XmlWriter& xml, const Dataset& d, Association association, const Array& ghost) {
  constexpr std::pair<Role, std::string_view> roles[] = {{Role::scalars, "Scalars"}, {Role::vectors, "Vectors"},
                                                         {Role::normals, "Normals"}, {Role::tcoords, "TCoords"},
                                                         {Role::tensors, "Tensors"}, {Role::global_ids, "GlobalIds"}};
  XmlAttributes attributes;
  for (const auto& [role, attribute] : roles)
    for (const Field& f : d.fields())
      if (f.association == association && f.role == role && (association == Association::point || !d.as<PointCloud>())) {
        attributes.emplace_back(attribute, f.name);
        break;
      }
  // What shapes high-order cells: the mesh's own, unless the file that was read kept it as a field.
  const auto* u = d.as<UnstructuredMesh>();
  const bool point = association == Association::point;
  const std::string_view shaping = point ? "RationalWeights" : "HigherOrderDegrees";
  const Array shape = !u ? Array() : point ? u->weights : u->degrees;
  if (!shape.empty()) attributes.emplace_back(shaping, std::string(shaping));
  xml.begin(point ? "PointData" : "CellData", attributes);
  for (const Field& f : d.fields())
    if (f.association == association && (point || !d.as<PointCloud>()))  // clouds get a vertex each, and have no values on cells
      xml.array(f.name, f.array, false, f.unit);
  if (!shape.empty() && !d.fields().find(shaping, association)) xml.array(shaping, shape.converted(ElementType::f64));
  if (!ghost.empty()) xml.array("vtkGhostType", ghost);
  xml.end();
}

void write_whole(XmlWriter& xml, const Dataset& d) {
  xml.begin("FieldData");
  if (d.time()) xml.array("TimeValue", Array::from_vector(std::vector<double>{*d.time()}), true);
  for (const Field& f : d.fields())
    if (f.association == Association::whole) xml.array(f.name, f.array, true, f.unit);
  xml.end();
}

struct Header {
  XmlAttributes dataset, piece;
};

Header header_of(const Dataset& d, size_t cells, const GridPlace* place) {
  Header h;
  auto extent = [&](const std::array<long long, 3>& lo) {
    const std::string text = extent_text(lattice_dims(d.mesh()), lo);
    h.dataset.emplace_back("WholeExtent", text);
    h.piece.emplace_back("Extent", text);
  };
  if (auto* u = d.as<UniformGrid>()) {
    const auto zero = place ? place->zero : origin_of_zero(*u);
    extent(place ? place->start : zero ? u->extent_start : std::array<long long, 3>{0, 0, 0});
    std::string direction;
    for (int i = 0; i < 9; ++i) direction += (i ? " " : "") + exact_number(u->direction.m[i / 3][i % 3]);
    h.dataset.insert(h.dataset.end(),
                     {{"Origin", three(zero.value_or(u->origin))}, {"Spacing", three(u->spacing)}, {"Direction", direction}});
  } else if (auto* r = d.as<RectilinearGrid>()) {
    extent(place ? place->start : r->extent_start);
  } else if (auto* c = d.as<CurvilinearGrid>()) {
    extent(place ? place->start : c->extent_start);
  } else {
    h.piece = {{"NumberOfPoints", std::to_string(d.point_count())}, {"NumberOfCells", std::to_string(cells)}};
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
  }
}

}  // namespace

std::string_view extension_for(const Mesh& mesh) {
  struct Visitor {
    std::string_view operator()(const UniformGrid&) const { return "vti"; }
    std::string_view operator()(const RectilinearGrid&) const { return "vtr"; }
    std::string_view operator()(const CurvilinearGrid&) const { return "vts"; }
    std::string_view operator()(const UnstructuredMesh&) const { return "vtu"; }
    std::string_view operator()(const SurfaceMesh&) const { return "vtp"; }
    std::string_view operator()(const PointCloud&) const { return "vtp"; }
    std::string_view operator()(const AmrGrid&) const { return "vthb"; }
  };
  return std::visit(Visitor{}, mesh);
}

void write_dataset(const std::string& path, const Dataset& d, const WriteOptions& options, Context& context, const GridPlace* place) {
  const std::string ext = extension_of(path);
  const std::string_view right = extension_for(d.mesh());
  if (ext != right && !(ext == "vtu" && right == "vtp"))
    fail_usage(fmt::format("a mesh of kind {} cannot be written to .{}", d.kind(), ext), path, fmt::format("name the file *.{}", right));
  const auto* element = std::find_if(std::begin(elements), std::end(elements), [&](const auto& e) { return e.first == ext; });
  XmlWriter xml(path, options, context);
  const bool surface = ext == "vtp", unstructured = ext == "vtu";
  const SurfaceMesh lists = surface ? as_surface(d.mesh()) : SurfaceMesh{};
  const UnstructuredMesh cells = unstructured ? as_unstructured(d.mesh()) : UnstructuredMesh{};
  Header h = surface ? Header{} : header_of(d, cells.cells.size(), place);
  if (surface) {
    h.piece.emplace_back("NumberOfPoints", std::to_string(d.point_count()));
    for (const auto& kind : written_lists) h.piece.emplace_back(kind.count, std::to_string((lists.*kind.list).size()));
  }
  xml.begin("VTKFile",
            {{"type", std::string(element->second)}, {"version", "1.0"}, {"byte_order", "LittleEndian"}, {"header_type", "UInt64"}});
  xml.begin(element->second, h.dataset);
  write_whole(xml, d);
  xml.begin("Piece", h.piece);
  write_fields(xml, d, Association::point, d.point_ghost());
  write_fields(xml, d, Association::cell, d.cell_ghost());
  if (surface) {
    write_points(xml, lists.points);
    for (const auto& kind : written_lists) {
      xml.begin(kind.element);
      write_cell_list(xml, lists.*kind.list);
      xml.end();
    }
  } else if (unstructured) {
    write_points(xml, cells.points);
    write_cells(xml, cells);
  } else {
    write_geometry(xml, d);
  }
  xml.finish();
}

}  // namespace vtk

void write_vtk_xml(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  vtk::write_dataset(path, *single_dataset(data, "a VTK XML file"), options, context);
}

}  // namespace sg
