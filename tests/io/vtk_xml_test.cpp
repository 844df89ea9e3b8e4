// SPDX-License-Identifier: Apache-2.0
// VTK XML: what is written reads back exactly; pieces are joined; bad files give errors.
#include "base/file.h"
#include "base/parallel.h"
#include "io/formats.h"
#include "io/io.h"
#include "support/test.h"

using namespace sg;

namespace {

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

bool same(const Array& a, const Array& b) {
  if (a.count() == 0 && b.count() == 0) return true;
  if (a.type() != b.type() || a.count() != b.count() || a.components() != b.components()) return false;
  const Array p = a.made_packed(), q = b.made_packed();
  return std::memcmp(p.raw(), q.raw(), p.bytes()) == 0;
}

void check_same_cells(const CellArray& a, const CellArray& b) {
  REQUIRE(a.size() == b.size());
  const CellsView v = cells_view(a), w = cells_view(b);
  for (size_t c = 0; c < a.size(); ++c) {
    REQUIRE(v.size(c) == w.size(c));
    for (size_t k = 0; k < v.size(c); ++k) CHECK(v.point(c, k) == w.point(c, k));
  }
}

void check_same_points(const Points& a, const Points& b) {
  REQUIRE(a.count() == b.count());
  for (size_t i = 0; i < a.count(); ++i) CHECK(a.at(i) == b.at(i));
  if (a.count() && a.origin == Vec3{0, 0, 0}) CHECK(a.xyz.type() == b.xyz.type());
}

void check_same_mesh(const Mesh& x, const Mesh& y) {
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

void check_same(const Dataset& a, const Dataset& b) {
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
void add_fields(DatasetParts& p) {
  const size_t points = point_count(p.mesh), cells = cell_count(p.mesh);
  auto ends = [&]<class T>(const char* name, T) {
    std::vector<T> v(points);
    for (size_t i = 0; i < points; ++i) v[i] = i % 3 == 0 ? std::numeric_limits<T>::min() : i % 3 == 1 ? std::numeric_limits<T>::max() : T(i);
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

UnstructuredMesh mixed_mesh() {
  UnstructuredMesh m;
  m.points.xyz = ramp<double>(12, 3, 0.3);
  m.cells.connectivity = ramp<int32_t>(4 + 8 + 8);  // replaced below
  m.cells.connectivity = numbers<int32_t>({0, 1, 2, 3, 0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 8, 9, 10, 11});
  m.cells.offsets = numbers<int32_t>({0, 4, 12, 20});
  m.types = numbers<uint8_t>({uint8_t(CellType::tetra), uint8_t(CellType::hexahedron), uint8_t(CellType::polyhedron)});
  m.faces.connectivity = numbers<int64_t>({4, 5, 6, 7, 8, 9, 10, 11, 4, 5, 9, 8, 5, 6, 10, 9, 6, 7, 11, 10, 7, 4, 8, 11});
  m.faces.offsets = numbers<int64_t>({0, 4, 8, 12, 16, 20, 24});
  m.polyhedron_faces = numbers<int64_t>({0, 0, 0, 6});
  return m;
}

UnstructuredMesh tetra_mesh(size_t n) {
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

SurfaceMesh surface_mesh() {
  SurfaceMesh m;
  m.points.xyz = ramp<float>(9, 3, 0.5);
  m.vertices = {numbers<int64_t>({0, 3, 5}), {}, 1};
  m.lines = {numbers<int64_t>({0, 1, 2, 4, 5}), numbers<int64_t>({0, 3, 5}), 0};
  m.polygons = {numbers<int64_t>({0, 1, 2, 3, 4, 5, 6}), numbers<int64_t>({0, 3, 7}), 0};
  m.strips = {numbers<int64_t>({2, 3, 4, 5, 6}), numbers<int64_t>({0, 5}), 0};
  return m;
}

UniformGrid uniform_grid() {
  UniformGrid g;
  g.dims = {4, 3, 2};
  g.origin = {0.1, -2.7, 1e7 + 0.3};
  g.spacing = {0.1, 0.25, 1.0 / 3};
  g.direction.m[0][0] = 0.8, g.direction.m[0][1] = -0.6, g.direction.m[1][0] = 0.6, g.direction.m[1][1] = 0.8;
  g.extent_start = {2, 0, -5};
  return g;
}

RectilinearGrid rectilinear_grid() {
  return {numbers<float>({0, 0.1f, 3}), numbers<float>({5, 4, 2, 1}), numbers<float>({-1, 1}), {1, 2, 3}};
}

CurvilinearGrid curvilinear_grid() {
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

std::vector<Sample> samples() {
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

DatasetPtr read(const std::string& path, const ReadOptions& options = {}) {
  Context context;
  return std::get<DatasetPtr>(read_data(path, options, context));
}

void write(const std::string& path, const DatasetPtr& d, const WriteOptions& options = {}) {
  Context context;
  write_data(path, d, options, context);
}

std::string temp(const std::string& name) { return test::temp_folder() + name; }

DatasetPtr read_text(const std::string& name, const std::string& text, const ReadOptions& options = {}) {
  write_file(temp(name), text);
  return read(temp(name), options);
}

// `body` inside the elements of an unstructured grid.
std::string vtu(const std::string& body) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n" + body +
         "\n</UnstructuredGrid>\n</VTKFile>\n";
}

std::string piece(const std::string& points, const std::string& cells, const std::string& data = "") {
  return "<Piece NumberOfPoints=\"" + points + "\" NumberOfCells=\"" + cells + "\">" + data +
         "<Points><DataArray type=\"Float32\" Name=\"P\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0</DataArray></Points>"
         "<Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>"
         "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray>"
         "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5</DataArray></Cells></Piece>";
}

const WriteOptions every_option[] = {{"ascii", "none"},   {"base64", "none"},   {"base64", "zlib"},   {"base64", "lz4"},   {"base64", "lzma"},
                                     {"appended", "none"}, {"appended", "zlib"}, {"appended", "lz4"}, {"appended", "lzma"}};

}  // namespace

TEST_CASE("vtk xml: each mesh kind reads back exactly in each encoding and compression") {
  for (const Sample& s : samples())
    for (const WriteOptions& o : every_option) {
      CAPTURE(s.extension);
      CAPTURE(o.encoding);
      CAPTURE(o.compression);
      const std::string path = temp(std::string("round.") + s.extension);
      write(path, s.dataset, o);
      check_same(*s.dataset, *read(path));
    }
}

TEST_CASE("vtk xml: one thread and eight write the same bytes") {
  const DatasetPtr d = make_dataset(tetra_mesh(200000));
  for (const WriteOptions& o : every_option) {
    if (o.compression == "lzma") continue;
    std::string bytes[2];
    for (int i = 0; i < 2; ++i) {
      set_thread_count(i ? 8 : 1);
      write(temp("threads.vtu"), d, o);
      bytes[i] = std::string(MappedFile(temp("threads.vtu")).text());
      CHECK(read(temp("threads.vtu"))->cell_count() == 200000);
    }
    set_thread_count(0);
    CHECK(bytes[0] == bytes[1]);
  }
}

TEST_CASE("vtk xml: uncompressed appended arrays of our own files are not copied") {
  write(temp("zero.vtu"), make_dataset(tetra_mesh(1000)));
  const DatasetPtr d = read(temp("zero.vtu"));
  const auto& m = *d->as<UnstructuredMesh>();
  CHECK(m.points.xyz.buffer().owner == m.cells.connectivity.buffer().owner);
  CHECK(reinterpret_cast<uintptr_t>(m.cells.connectivity.raw()) % 64 == 0);
  CHECK(m.cells.fixed == 4);
  CHECK(m.types.empty());
}

TEST_CASE("vtk xml: points far from zero keep their double origin in the file") {
  SurfaceMesh m = surface_mesh();
  m.points.origin = {1e7, -2e7, 0.125};
  write(temp("far.vtp"), make_dataset(m));
  const DatasetPtr d = read(temp("far.vtp"));
  CHECK(d->as<SurfaceMesh>()->points.xyz.type() == ElementType::f64);
  check_same_points(m.points, d->as<SurfaceMesh>()->points);
}

TEST_CASE("vtk xml: a point cloud is written as vertices") {
  write(temp("cloud.vtp"), make_dataset(PointCloud{{ramp<float>(7, 3)}}));
  CHECK(read(temp("cloud.vtp"))->as<SurfaceMesh>()->vertices.size() == 7);
}

TEST_CASE("vtk xml: an empty mesh of each listed kind reads back empty") {
  for (const WriteOptions& o : every_option) {
    write(temp("empty.vtu"), make_dataset(UnstructuredMesh{}), o);
    CHECK(read(temp("empty.vtu"))->point_count() == 0);
    write(temp("empty.vtp"), make_dataset(SurfaceMesh{}), o);
    CHECK(read(temp("empty.vtp"))->cell_count() == 0);
  }
}

TEST_CASE("vtk xml: the wrong extension for a mesh kind names the right one") {
  const DatasetPtr d = make_dataset(tetra_mesh(2));
  for (const char* name : {"x.vti", "x.vtr", "x.vts", "x.vtp"}) {
    const std::string error = test::error_of([&] { write(temp(name), d); });
    CHECK(error.find("*.vtu") != std::string::npos);
    CHECK(!file_exists(temp(name)));
  }
  CHECK(test::error_of([&] { write(temp("x.vtu"), d, {"asci", "none"}); }).find("'ascii'") != std::string::npos);
  CHECK(test::error_of([&] { write(temp("x.vtu"), d, {"base64", "lz5"}); }).find("'lz4'") != std::string::npos);
  CHECK(test::error_of([&] { write(temp("x.vtu"), d, {"ascii", "zlib"}); }).find("compressed") != std::string::npos);
  AmrGrid amr;
  CHECK(test::error_of([&] { write(temp("x.vti"), make_dataset(amr)); }).find("amr") != std::string::npos);
}

TEST_CASE("vtk xml: only the wanted fields are read") {
  write(temp("some.vtu"), samples()[4].dataset);
  ReadOptions o;
  o.fields = {"velocity", "material"};
  const DatasetPtr d = read(temp("some.vtu"), o);
  CHECK(d->fields().size() == 2);
  CHECK(!d->cell_ghost().empty());
}

TEST_CASE("vtk xml: unstructured pieces are appended, with ids shifted and fields joined") {
  auto data = [](const char* point, const char* cell) {
    return std::string("<PointData><DataArray type=\"Float64\" Name=\"T\" format=\"ascii\">") + point + "</DataArray></PointData><CellData Scalars=\"c\">" +
           "<DataArray type=\"UInt8\" Name=\"c\" format=\"ascii\">" + cell + "</DataArray></CellData>";
  };
  const std::string empty = "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"/>";
  const DatasetPtr d = read_text("pieces.vtu", vtu(piece("3", "+1", data("1 2 3", "7")) + empty + piece("3", "1", data("4 5 6", "9"))));
  REQUIRE(d->point_count() == 6);
  REQUIRE(d->cell_count() == 2);
  const auto& m = *d->as<UnstructuredMesh>();
  CHECK(m.cells.fixed == 3);
  CHECK(m.single_type == CellType::triangle);
  CHECK(cells_view(m.cells).point(1, 2) == 5);
  CHECK(d->fields().find("T")->array.get(5) == 6);
  CHECK(d->fields().find("c")->array.get(1) == 9);
  CHECK(d->fields().find("c")->role == Role::scalars);
}

TEST_CASE("vtk xml: pieces of polygonal data keep cell fields beside their cells") {
  auto part = [](const char* ids, const char* cell) {
    return std::string("<Piece NumberOfPoints=\"3\" NumberOfVerts=\"1\" NumberOfPolys=\"1\"><CellData><DataArray type=\"Int16\" Name=\"c\" format=\"ascii\">") + cell +
           "</DataArray></CellData><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0</DataArray></Points>"
           "<Verts><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">2</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">1</DataArray></Verts>"
           "<Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">" + ids +
           "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray></Polys></Piece>";
  };
  const std::string head = "<VTKFile type=\"PolyData\" version=\"0.1\"><PolyData>", tail = "</PolyData></VTKFile>";
  const DatasetPtr d = read_text("pieces.vtp", head + part("0 1 2", "1 2") + part("2 1 0", "3 4") + tail);
  const auto& m = *d->as<SurfaceMesh>();
  REQUIRE(m.vertices.size() == 2);
  REQUIRE(m.polygons.size() == 2);
  CHECK(cells_view(m.vertices).point(1, 0) == 5);
  CHECK(cells_view(m.polygons).point(1, 0) == 5);
  const Array& c = d->fields().find("c")->array;  // vertices first, then polygons
  CHECK((c.get(0) == 1 && c.get(1) == 3 && c.get(2) == 2 && c.get(3) == 4));
  // An id beyond its own piece must not reach into the next.
  CHECK(test::error_of([&] { read_text("pieces.vtp", head + part("0 1 3", "1 2") + part("2 1 0", "3 4") + tail); }).find("3") != std::string::npos);
}

TEST_CASE("vtk xml: pieces of an image are put in their place, gaps are hidden") {
  auto part = [](const char* extent, const char* point, const char* cell) {
    return std::string("<Piece Extent=\"") + extent + "\"><PointData><DataArray type=\"Int32\" Name=\"p\" format=\"ascii\">" + point +
           "</DataArray></PointData><CellData><DataArray type=\"Int32\" Name=\"c\" format=\"ascii\">" + cell + "</DataArray></CellData></Piece>";
  };
  const std::string head = "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"2 5 0 1 0 0\" Origin=\"10 0 0\" Spacing=\"0.5 1 1\">", tail = "</ImageData></VTKFile>";
  const DatasetPtr d = read_text("p.vti", head + part("4 5 0 1 0 0", "2 3 6 7", "2") + part("2 4 0 1 0 0", "0 1 2 4 5 6", "0 1") + tail);
  const auto& g = *d->as<UniformGrid>();
  CHECK(g.dims == std::array<size_t, 3>{4, 2, 1});
  CHECK(g.origin == Vec3{11, 0, 0});
  for (size_t i = 0; i < 8; ++i) CHECK(d->fields().find("p")->array.get(i) == double(i));
  for (size_t i = 0; i < 3; ++i) CHECK(d->fields().find("c")->array.get(i) == double(i));
  CHECK(d->cell_ghost().empty());

  const DatasetPtr gap = read_text("p.vti", head + part("4 5 0 1 0 0", "2 3 6 7", "2") + part("2 3 0 1 0 0", "0 1 4 5", "0") + tail);
  CHECK(gap->point_ghost().empty());
  REQUIRE(gap->cell_ghost().count() == 3);
  CHECK(gap->cell_ghost().get(1) == ghost_hidden_cell);
  CHECK(gap->cell_ghost().get(0) == 0);
}

TEST_CASE("vtk xml: pieces of rectilinear and structured grids are joined") {
  auto array = [](const char* name, const char* n, const char* values) {
    return std::string("<DataArray type=\"Float32\" Name=\"") + name + "\" NumberOfComponents=\"" + n + "\" format=\"ascii\">" + values + "</DataArray>";
  };
  auto rect = [&](const char* extent, const char* x) {
    return std::string("<Piece Extent=\"") + extent + "\"><Coordinates>" + array("x", "1", x) + array("y", "1", "0 1") + array("z", "1", "0") + "</Coordinates></Piece>";
  };
  const DatasetPtr r = read_text("p.vtr", "<VTKFile type=\"RectilinearGrid\"><RectilinearGrid WholeExtent=\"0 3 0 1 0 0\">" + rect("0 1 0 1 0 0", "0 1") +
                                              rect("1 3 0 1 0 0", "1 5 7") + "</RectilinearGrid></VTKFile>");
  REQUIRE(r->as<RectilinearGrid>()->x.count() == 4);
  CHECK(r->as<RectilinearGrid>()->x.type() == ElementType::f32);
  CHECK(r->as<RectilinearGrid>()->x.get(3) == 7);
  auto curv = [&](const char* extent, const char* xyz) { return std::string("<Piece Extent=\"") + extent + "\"><Points>" + array("P", "3", xyz) + "</Points></Piece>"; };
  const DatasetPtr c = read_text("p.vts", "<VTKFile type=\"StructuredGrid\"><StructuredGrid WholeExtent=\"0 2 0 0 0 0\">" + curv("0 1 0 0 0 0", "0 0 0 1 0 0") +
                                              curv("1 2 0 0 0 0", "1 0 0 4 5 6") + "</StructuredGrid></VTKFile>");
  CHECK(c->as<CurvilinearGrid>()->points.at(2) == Vec3{4, 5, 6});
}

TEST_CASE("vtk xml: big-endian bytes, 32-bit headers and bits are understood") {
  // Three big-endian f64 and ten bits, appended raw.
  std::string raw;
  auto be = [&](uint64_t v, int bytes) {
    for (int i = bytes; i-- > 0;) raw += char(v >> (8 * i));
  };
  be(24, 4);
  for (const double x : {1.5, -2.0, 1e100}) be(std::bit_cast<uint64_t>(x), 8);
  be(2, 4);
  raw += "\xA5\x80";
  const DatasetPtr d = read_text("be.vti", "<VTKFile type=\"ImageData\" byte_order=\"BigEndian\" header_type=\"UInt32\"><ImageData WholeExtent=\"0 2 0 0 0 0\">"
                                           "<FieldData><DataArray type=\"Bit\" Name=\"bits\" NumberOfTuples=\"10\" format=\"appended\" offset=\"28\"/></FieldData>"
                                           "<Piece Extent=\"0 2 0 0 0 0\"><PointData><DataArray type=\"Float64\" Name=\"T\" format=\"appended\" offset=\"0\"/></PointData>"
                                           "</Piece></ImageData><AppendedData encoding=\"raw\">\n_" + raw + "\n</AppendedData></VTKFile>");
  const Array& t = d->fields().find("T")->array;
  CHECK((t.get(0) == 1.5 && t.get(1) == -2 && t.get(2) == 1e100));
  const Array& bits = d->fields().find("bits")->array;
  REQUIRE(bits.count() == 10);
  const int want[] = {1, 0, 1, 0, 0, 1, 0, 1, 1, 0};
  for (size_t i = 0; i < 10; ++i) CHECK(bits.get(i) == want[i]);
}

TEST_CASE("vtk xml: base64 may be wrapped, and its size may be padded on its own") {
  auto file = [](const char* data) {
    return std::string("<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 1 0 0 0 0\"><Piece Extent=\"0 1 0 0 0 0\"><PointData>"
                       "<DataArray type=\"Int32\" Name=\"v\" format=\"binary\">") + data + "</DataArray></PointData></Piece></ImageData></VTKFile>";
  };
  for (const char* data : {"CAAAAAEAAAACAAAA", "\n  CAAA\n  AAEAAAAC\n AAAA \n", "CAAAAA==AQAAAAIAAAA="}) {
    CAPTURE(data);
    const DatasetPtr d = read_text("b64.vti", file(data));
    CHECK(d->fields().find("v")->array.get(0) == 1);
    CHECK(d->fields().find("v")->array.get(1) == 2);
  }
  for (const char* data : {"CAAAAAEAAAA", "CAAAAAEA*AACAAAA", "////fwEAAAACAAAA", "", "CA=="})
    CHECK(test::error_of([&] { read_text("b64.vti", file(data)); }).find("DataArray 'v'") != std::string::npos);
}

TEST_CASE("vtk xml: polyhedra of version 2.3 files have their faces as lists") {
  const std::string array = "<DataArray type=\"Int64\" format=\"ascii\" Name=";
  const DatasetPtr d = read_text("poly23.vtu", vtu("<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">"
      "0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells>" + array + "\"connectivity\">0 1 2 3</DataArray>" + array + "\"offsets\">4</DataArray>" + array +
      "\"types\">42</DataArray>" + array + "\"face_connectivity\">0 1 2 0 3 1 1 3 2 2 3 0</DataArray>" + array + "\"face_offsets\">3 6 9 12</DataArray>" + array +
      "\"polyhedron_to_faces\">3 0 1 2</DataArray>" + array + "\"polyhedron_offsets\">4</DataArray></Cells></Piece>"));
  const auto& m = *d->as<UnstructuredMesh>();
  REQUIRE(m.faces.size() == 4);
  CHECK(cells_view(m.faces).point(0, 0) == 2);
  CHECK(cells_view(m.faces).point(1, 0) == 0);
}

TEST_CASE("vtk xml: a file cut anywhere gives an Error that names it") {
  for (const Sample& s : samples())
    for (const WriteOptions& o : every_option) {
      const std::string whole = temp(std::string("whole.") + s.extension), part = temp(std::string("cut.") + s.extension);
      write(whole, s.dataset, o);
      const std::string text(MappedFile(whole).text());
      for (size_t i = 1; i < 64; ++i) {
        write_file(part, text.substr(0, text.size() * i / 64));
        CAPTURE(s.extension);
        CAPTURE(o.encoding);
        CAPTURE(i);
        CHECK(test::error_of([&] { read(part); }).find("cut.") != std::string::npos);
      }
    }
}

TEST_CASE("vtk xml: files with any byte changed read or give an Error, and nothing worse") {
  size_t errors = 0, reads = 0;
  for (const Sample& s : samples())
    for (const WriteOptions& o : {every_option[0], every_option[2], every_option[5], every_option[7]}) {
      const std::string path = temp(std::string("bent.") + s.extension);
      write(path, s.dataset, o);
      const std::string text(MappedFile(path).text());
      for (size_t i = 0; i < 150; ++i) {
        std::string bent = text;
        uint64_t h = (i + 1) * 0x9e3779b97f4a7c15ull;
        bent[(h >> 20) % bent.size()] = char(h >> 8);
        write_file(path, bent);
        try {
          read(path);
          ++reads;
        } catch (const Error& e) {
          CHECK(e.kind() == ErrorKind::data);
          ++errors;
        }
      }
    }
  CHECK(errors > 100);
  CHECK(reads > 100);
}

TEST_CASE("vtk xml: absurd sizes, types, offsets and extents are refused with the element's name") {
  auto array = [](const std::string& attributes, const std::string& text = "1 2 3") {
    return "<PointData><DataArray Name=\"T\" " + attributes + ">" + text + "</DataArray></PointData>";
  };
  auto error = [&](const std::string& text) { return test::error_of([&] { read_text("bad.vtu", text); }); };
  auto says = [](const std::string& e, const char* what) { return e.find(what) != std::string::npos; };
  CHECK(says(error(vtu(piece("9223372036854775808", "1"))), "DataArray 'P'"));
  CHECK(says(error(vtu(piece("18446744073709551616", "1"))), "NumberOfPoints"));
  CHECK(says(error(vtu(piece("-3", "1"))), "NumberOfPoints"));
  CHECK(says(error(vtu(piece("3", "9223372036854775808"))), "offsets"));
  CHECK(says(error(vtu(piece("4", "1"))), "4 tuples"));
  CHECK(says(error(vtu(piece("2", "1"))), "point id 2"));
  CHECK(says(error(vtu(piece("3", "1", array("type=\"Float16\" format=\"ascii\"")))), "Float16"));
  CHECK(says(error(vtu(piece("3", "1", array("type=\"Int8\" format=\"ascii\"", "1 2 300")))), "'300'"));
  CHECK(says(error(vtu(piece("3", "1", array("type=\"Float32\" format=\"ascii\"", "1 x 3")))), "DataArray 'T'"));
  CHECK(says(error(vtu(piece("3", "1", array("type=\"Float32\" format=\"ascii\"", "1 2")))), "DataArray 'T'"));
  CHECK(says(error(vtu(piece("3", "1", array("type=\"Float32\" format=\"ascii\" NumberOfComponents=\"4294967296\"")))), "components"));
  CHECK(says(error(vtu(piece("3", "1", array("type=\"Float32\" format=\"hex\"")))), "hex"));
  CHECK(says(error(vtu(piece("3", "1", array("type=\"Float32\" format=\"appended\" offset=\"0\"")))), "AppendedData"));
  CHECK(says(error("<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkZstd\"><UnstructuredGrid/></VTKFile>"), "vtkZstd"));
  CHECK(says(error("<VTKFile type=\"UnstructuredGrid\" header_type=\"UInt128\"><UnstructuredGrid/></VTKFile>"), "UInt128"));
  CHECK(says(error("<VTKFile type=\"UnstructuredGrid\" byte_order=\"Middle\"><UnstructuredGrid/></VTKFile>"), "Middle"));
  CHECK(says(error("<VTKFile type=\"UnstructuredGrid\"><PolyData/></VTKFile>"), "UnstructuredGrid"));
  for (const char* extent : {"0 -5 0 1 0 1", "0 9223372036854775807 0 1 0 1", "0 1000000000000 0 1000000000000 0 1", "0 1 0 1", "a b c d e f"}) {
    CAPTURE(extent);
    CHECK(says(error(std::string("<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"") + extent + "\"><Piece/></ImageData></VTKFile>"), "WholeExtent"));
  }
  // Appended bytes: an offset beyond the end, and a size that is larger than the file.
  auto appended = [&](const char* offset, const std::string& bytes, const char* compressor = "") {
    return error("<VTKFile type=\"ImageData\" " + std::string(compressor) + "><ImageData WholeExtent=\"0 1 0 0 0 0\"><Piece Extent=\"0 1 0 0 0 0\"><PointData><DataArray type=\"Int8\" Name=\"T\" "
                 "format=\"appended\" offset=\"" + offset + "\"/></PointData></Piece></ImageData><AppendedData encoding=\"raw\">_" + bytes + "</AppendedData></VTKFile>");
  };
  CHECK(says(appended("999", std::string("\2\0\0\0ab", 6)), "offset 999"));
  CHECK(says(appended("5", std::string("\2\0\0\0ab", 6)), "DataArray 'T'"));
  CHECK(says(appended("0", "\xff\xff\xff\xff" "ab"), "4294967295"));
  CHECK(says(appended("0", std::string("\1\0\0\0ab", 6)), "2 tuples"));
  const char* zlib = "compressor=\"vtkZLibDataCompressor\"";
  CHECK(says(appended("0", "\xff\xff\xff\xff" "abcdabcdabcd", zlib), "blocks"));
  CHECK(says(appended("0", std::string("\1\0\0\0\2\0\0\0\0\0\0\0\5\0\0\0abcde", 21), zlib), "decompressed"));
  CHECK(says(appended("0", std::string("\1\0\0\0\2\0\0\0\0\0\0\0\5\0\0\1abcde", 21), zlib), "DataArray 'T'"));
  CHECK(says(appended("0", std::string("\1\0\0\0\0\0\0\x7f\0\0\0\0\5\0\0\0abcde", 21), zlib), "DataArray 'T'"));
}

TEST_CASE("vtk xml: entities are not expanded and deep nesting is survived") {
  std::string bomb = "<?xml version=\"1.0\"?><!DOCTYPE x [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;\">]><VTKFile type=\"&b;\"><ImageData/></VTKFile>";
  CHECK(!test::error_of([&] { read_text("bomb.vti", bomb); }).empty());
  std::string deep = "<VTKFile type=\"ImageData\">";
  for (int i = 0; i < 200000; ++i) deep += "<a>";
  CHECK(!test::error_of([&] { read_text("deep.vti", deep); }).empty());
}
