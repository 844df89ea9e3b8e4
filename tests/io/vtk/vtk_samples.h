// SPDX-License-Identifier: Apache-2.0
// Small datasets of each mesh kind with fields of each type, and what the tests of VTK XML do with them.
#pragma once
#include <cstring>

#include "io/formats.h"
#include "io/io_files.h"

namespace sg::test {

template <class T>
Array numbers(std::initializer_list<T> v, int components = 1) {
  return Array::from_vector(std::vector<T>(v), components);
}

template <class T>
Array ramp(size_t n, int components = 1, double step = 1) {
  std::vector<T> v(n * size_t(components));
  for (size_t i = 0; i < v.size(); ++i) v[i] = T(double(i) * step);
  return Array::from_vector(std::move(v), components);
}

inline bool same(const Array& a, const Array& b) {
  if (a.count() == 0 && b.count() == 0) return true;
  if (a.type() != b.type() || a.count() != b.count() || a.components() != b.components()) return false;
  const Array p = a.made_packed(), q = b.made_packed();
  return std::memcmp(p.raw(), q.raw(), p.bytes()) == 0;
}

inline void check_same_cells(const CellArray& a, const CellArray& b) {
  REQUIRE(a.size() == b.size());
  const CellsView v = cells_view(a), w = cells_view(b);
  for (size_t c = 0; c < a.size(); ++c) {
    REQUIRE(v.size(c) == w.size(c));
    for (size_t k = 0; k < v.size(c); ++k) CHECK(v.point(c, k) == w.point(c, k));
  }
}

inline void check_same_points(const Points& a, const Points& b) {
  REQUIRE(a.count() == b.count());
  for (size_t i = 0; i < a.count(); ++i) CHECK(a.at(i) == b.at(i));
  if (a.count() && a.origin == Vec3{0, 0, 0}) CHECK(a.xyz.type() == b.xyz.type());
}

inline void check_same_mesh(const Mesh& x, const Mesh& y) {
  REQUIRE(x.index() == y.index());
  if (auto* a = std::get_if<UniformGrid>(&x)) {
    auto& b = std::get<UniformGrid>(y);
    CHECK(a->dims == b.dims);
    CHECK(a->origin == b.origin);
    CHECK(a->spacing == b.spacing);
    CHECK(a->direction == b.direction);
  } else if (auto* r = std::get_if<RectilinearGrid>(&x)) {
    auto& b = std::get<RectilinearGrid>(y);
    CHECK((same(r->x, b.x) && same(r->y, b.y) && same(r->z, b.z)));
    CHECK(r->extent_start == b.extent_start);
  } else if (auto* c = std::get_if<CurvilinearGrid>(&x)) {
    CHECK(c->dims == std::get<CurvilinearGrid>(y).dims);
    check_same_points(c->points, std::get<CurvilinearGrid>(y).points);
  } else if (auto* u = std::get_if<UnstructuredMesh>(&x)) {
    auto& b = std::get<UnstructuredMesh>(y);
    check_same_points(u->points, b.points);
    check_same_cells(u->cells, b.cells);
    for (size_t i = 0; i < u->cells.size(); ++i) CHECK(u->type(i) == b.type(i));
    check_same_cells(u->faces, b.faces);
    CHECK(same(u->polyhedron_faces, b.polyhedron_faces));
  } else {
    auto &s = std::get<SurfaceMesh>(x), &t = std::get<SurfaceMesh>(y);
    check_same_points(s.points, t.points);
    check_same_cells(s.vertices, t.vertices);
    check_same_cells(s.lines, t.lines);
    check_same_cells(s.polygons, t.polygons);
    check_same_cells(s.strips, t.strips);
  }
}

inline void check_same(const Dataset& a, const Dataset& b) {
  check_same_mesh(a.mesh(), b.mesh());
  CHECK(a.fields().size() == b.fields().size());
  for (const Field& f : a.fields()) {
    CAPTURE(f.name);
    const Field* g = b.fields().find(f.name, f.association);
    REQUIRE(g);
    CHECK(same(f.array, g->array));
    CHECK(f.role == g->role);
  }
  CHECK(same(a.point_ghost(), b.point_ghost()));
  CHECK(same(a.cell_ghost(), b.cell_ghost()));
  CHECK(a.time() == b.time());
}

// Fields of every element type, with values at the ends of their ranges.
inline void add_fields(DatasetParts& p) {
  const size_t points = point_count(p.mesh), cells = cell_count(p.mesh);
  auto ends = [&]<class T>(const char* name, T) {
    std::vector<T> v(points);
    for (size_t i = 0; i < points; ++i)
      v[i] = i % 3 == 0 ? std::numeric_limits<T>::min() : i % 3 == 1 ? std::numeric_limits<T>::max() : T(i);
    p.fields.add({name, Association::point, Array::from_vector(std::move(v)), {}, Role::none});
  };
  ends("u8", uint8_t()), ends("i8", int8_t()), ends("u16", uint16_t()), ends("i16", int16_t()), ends("u32", uint32_t());
  ends("i32", int32_t()), ends("u64", uint64_t()), ends("i64", int64_t()), ends("f32", float()), ends("f64", double());
  p.fields.add({"a <quoted> & \"odd\" name", Association::point, ramp<float>(points, 1, 0.1), {}, Role::scalars});
  p.fields.add({"velocity", Association::point, ramp<double>(points, 3, 1.0 / 3), {}, Role::vectors});
  p.fields.add({"strided", Association::cell, ramp<float>(cells, 3, 0.7).component(1), {}, Role::none});
  p.fields.add({"material", Association::cell, ramp<int32_t>(cells), {}, Role::global_ids});
  p.fields.add({"parameters", Association::whole, numbers<double>({1, 2.5, -3, 1e300}, 2), {}, Role::none});
  uint8_t* ghost = nullptr;
  p.cell_ghost = Array::make<uint8_t>(cells, 1, &ghost);
  for (size_t i = 0; i < cells; ++i) ghost[i] = i % 2 ? ghost_duplicate : 0;
  p.point_ghost = Array::make<uint8_t>(points, 1, &ghost);
  for (size_t i = 0; i < points; ++i) ghost[i] = i % 5 ? 0 : ghost_hidden_point;
  p.time = 0.1 + 0.2;
}

inline UnstructuredMesh mixed_mesh() {
  UnstructuredMesh m;
  m.points.xyz = ramp<double>(12, 3, 0.3);
  m.cells.connectivity = numbers<int32_t>({0, 1, 2, 3, 0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 8, 9, 10, 11});
  m.cells.offsets = numbers<int32_t>({0, 4, 12, 20});
  m.types = numbers<uint8_t>({uint8_t(CellType::tetra), uint8_t(CellType::hexahedron), uint8_t(CellType::polyhedron)});
  m.faces.connectivity = numbers<int64_t>({4, 5, 6, 7, 8, 9, 10, 11, 4, 5, 9, 8, 5, 6, 10, 9, 6, 7, 11, 10, 7, 4, 8, 11});
  m.faces.offsets = numbers<int64_t>({0, 4, 8, 12, 16, 20, 24});
  m.polyhedron_faces = numbers<int64_t>({0, 0, 0, 6});
  return m;
}

inline UnstructuredMesh tetra_mesh(size_t n) {
  UnstructuredMesh m;
  m.points.xyz = ramp<float>(n + 3, 3, 0.25);
  std::vector<int64_t> ids;
  for (size_t c = 0; c < n; ++c)
    for (size_t k = 0; k < 4; ++k) ids.push_back(int64_t(c + k));
  m.cells.connectivity = Array::from_vector(std::move(ids));
  m.cells.fixed = 4;
  m.single_type = CellType::tetra;
  return m;
}

inline SurfaceMesh surface_mesh() {
  SurfaceMesh m;
  m.points.xyz = ramp<float>(9, 3, 0.5);
  m.vertices = {numbers<int64_t>({0, 3, 5}), {}, 1};
  m.lines = {numbers<int64_t>({0, 1, 2, 4, 5}), numbers<int64_t>({0, 3, 5}), 0};
  m.polygons = {numbers<int64_t>({0, 1, 2, 3, 4, 5, 6}), numbers<int64_t>({0, 3, 7}), 0};
  m.strips = {numbers<int64_t>({2, 3, 4, 5, 6}), numbers<int64_t>({0, 5}), 0};
  return m;
}

inline UniformGrid uniform_grid() {
  UniformGrid g;
  g.dims = {4, 3, 2};
  g.origin = {0.1, -2.7, 1e7 + 0.3};
  g.spacing = {0.1, 0.25, 1.0 / 3};
  g.direction.m[0][0] = 0.8, g.direction.m[0][1] = -0.6, g.direction.m[1][0] = 0.6, g.direction.m[1][1] = 0.8;
  g.extent_start = {2, 0, -5};
  return g;
}

inline RectilinearGrid rectilinear_grid() {
  return {numbers<float>({0, 0.1f, 3}), numbers<float>({5, 4, 2, 1}), numbers<float>({-1, 1}), {1, 2, 3}};
}

inline CurvilinearGrid curvilinear_grid() {
  CurvilinearGrid g;
  g.dims = {3, 2, 2};
  g.points.xyz = ramp<float>(12, 3, 0.1);
  g.extent_start = {0, 7, 0};
  return g;
}

struct Sample {
  const char* extension;
  DatasetPtr dataset;
};

inline std::vector<Sample> samples() {
  const std::pair<const char*, Mesh> meshes[] = {{"vti", uniform_grid()}, {"vtr", rectilinear_grid()}, {"vts", curvilinear_grid()},
                                                 {"vtu", mixed_mesh()},   {"vtu", tetra_mesh(5)},      {"vtp", surface_mesh()}};
  std::vector<Sample> r;
  for (const auto& [extension, mesh] : meshes) {
    DatasetParts p;
    p.mesh = mesh;
    add_fields(p);
    r.push_back({extension, make_dataset(std::move(p))});
  }
  return r;
}

inline DatasetPtr read(const std::string& path, const ReadOptions& options = {}) {
  Context context;
  return std::get<DatasetPtr>(read_data(path, options, context));
}

inline void write(const std::string& path, const DatasetPtr& d, const WriteOptions& options = {}) {
  Context context;
  write_data(path, d, options, context);
}

inline std::string temp(const std::string& name) { return test::temp_folder() + name; }

// `body` inside the elements of an unstructured grid.
inline std::string vtu(const std::string& body) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n" +
         body + "\n</UnstructuredGrid>\n</VTKFile>\n";
}

inline std::string piece(const std::string& points, const std::string& cells, const std::string& data = "") {
  return "<Piece NumberOfPoints=\"" + points + "\" NumberOfCells=\"" + cells + "\">" + data +
         "<Points><DataArray type=\"Float32\" Name=\"P\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0</DataArray></Points>"
         "<Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>"
         "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray>"
         "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5</DataArray></Cells></Piece>";
}

inline const WriteOptions every_option[] = {
    {VtkEncoding::ascii, Compression::none},    {VtkEncoding::base64, Compression::none},  {VtkEncoding::base64, Compression::zlib},
    {VtkEncoding::base64, Compression::lz4},    {VtkEncoding::base64, Compression::lzma},  {VtkEncoding::appended, Compression::none},
    {VtkEncoding::appended, Compression::zlib}, {VtkEncoding::appended, Compression::lz4}, {VtkEncoding::appended, Compression::lzma},
};

}  // namespace sg::test
