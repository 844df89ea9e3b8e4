// SPDX-License-Identifier: Apache-2.0
// Legacy VTK files: each dataset kind and attribute, old and new cell lists, text and big-endian bytes, bad input.
#include <algorithm>
#include <cstring>
#include <tuple>

#include "base/file/file.h"
#include "base/parallel.h"
#include "io/formats.h"
#include "io/io.h"
#include "io/vtk/vtk_numbers.h"
#include "io/vtk/vtk_samples.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::temp;

namespace {

DatasetPtr read_legacy(const std::string& text, const ReadOptions& options = {}) {
  write_file(temp("x.vtk"), text);
  Context context;
  return std::get<DatasetPtr>(read_data(temp("x.vtk"), options, context));
}

std::string error_of_legacy(const std::string& text) {
  return test::error_of([&] { read_legacy(text); });
}

const std::string ascii = "# vtk DataFile Version 3.0\na title\nASCII\n";
const std::string binary = "# vtk DataFile Version 5.1\n\nBINARY\n";

template <class T>
std::string big_endian(std::initializer_list<T> values) {
  std::string r;
  for (const T v : values) {
    char b[sizeof(T)];
    std::memcpy(b, &v, sizeof(T));
    for (size_t i = sizeof(T); i-- > 0;) r += b[i];
  }
  return r;
}

std::vector<double> values(const Dataset& d, const char* name) {
  const Field* f = d.fields().find(name);
  REQUIRE(f);
  std::vector<double> r;
  for (size_t i = 0; i < f->array.count(); ++i)
    for (int c = 0; c < f->components(); ++c) r.push_back(f->array.get(i, c));
  return r;
}

const std::string triangle = "DATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nCELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n";

}  // namespace

TEST_CASE("vtk legacy: structured points with scalars, lookup table and ghost arrays") {
  const DatasetPtr d =
      read_legacy(ascii +
                  "DATASET STRUCTURED_POINTS\nDIMENSIONS 3 2 1\nASPECT_RATIO 0.5 1 2\nORIGIN 1 2 3\nPOINT_DATA 6\n"
                  "SCALARS my%20field unsigned_char 1\nLOOKUP_TABLE colors\n1 2 3\n4 5 255\nLOOKUP_TABLE colors 2\n0 0 0 1 1 1 1 1\n"
                  "FIELD FieldData 1\nvtkGhostType 1 6 unsigned_char\n0 0 1 0 2 0\n"
                  "CELL_DATA 2\nSCALARS vtkGhostLevels unsigned_char\nLOOKUP_TABLE default\n0 2\n");
  const auto& g = *d->as<UniformGrid>();
  CHECK(g.dims == std::array<size_t, 3>{3, 2, 1});
  CHECK(g.origin == Vec3{1, 2, 3});
  CHECK(g.spacing == Vec3{0.5, 1, 2});
  CHECK(values(*d, "my field") == std::vector<double>{1, 2, 3, 4, 5, 255});
  CHECK(d->fields().find("my field")->role == Role::scalars);
  CHECK(d->fields().size() == 1);
  REQUIRE(d->point_ghost().count() == 6);
  CHECK(d->point_ghost().get(4) == ghost_hidden_point);
  CHECK(d->cell_ghost().get(1) == ghost_duplicate);
  REQUIRE(d->notes().size() == 1);
  CHECK(d->notes()[0].second == "a title");
}

TEST_CASE("vtk legacy: structured and rectilinear grids") {
  const DatasetPtr c = read_legacy(
      ascii + "DATASET STRUCTURED_GRID\nDIMENSIONS 2 2 1\nPOINTS 4 int\n0 0 0 1 0 0 0 1 0 1 1 5\nBLANKING 4 unsigned_char\n1 1 0 1\n");
  CHECK(c->as<CurvilinearGrid>()->points.at(3) == Vec3{1, 1, 5});
  CHECK(c->point_ghost().get(2) == ghost_hidden_point);
  const DatasetPtr r = read_legacy(
      ascii +
      "DATASET RECTILINEAR_GRID\nDIMENSIONS 3 1 2\nX_COORDINATES 3 float\n0 1 4\nY_COORDINATES 1 double\n7\nZ_COORDINATES 2 short\n-1 1\n");
  CHECK(r->bounds().hi == Vec3{4, 7, 1});
  CHECK(r->as<RectilinearGrid>()->y.type() == ElementType::f64);
}

TEST_CASE("vtk legacy: polygonal data keep vertices, lines, polygons and strips apart") {
  const DatasetPtr d = read_legacy(
      ascii +
      "DATASET POLYDATA\nPOINTS 5 double\n0 0 0 1 0 0 1 1 0 0 1 0 2 2 2\nVERTICES 1 2\n1 4\nLINES 2 5\n1 0 2 1 2\n"
      "POLYGONS 2 9\n3 0 1 2 4 0 1 2 3\nTRIANGLE_STRIPS 1 5\n4 0 1 3 2\nCELL_DATA 6\nCOLOR_SCALARS c 2\n0 1 0.5 0.5 1 1 0 0 0 0 0 0.25\n");
  const auto& m = *d->as<SurfaceMesh>();
  CHECK(m.vertices.size() == 1);
  CHECK(m.lines.size() == 2);
  CHECK(m.polygons.size() == 2);
  CHECK(cells_view(m.polygons).size(1) == 4);
  CHECK(m.strips.size() == 1);
  const auto c = values(*d, "c");
  CHECK(c == std::vector<double>{0, 255, 128, 128, 255, 255, 0, 0, 0, 0, 0, 64});
  CHECK(d->fields().find("c")->array.type() == ElementType::u8);
}

TEST_CASE("vtk legacy: each attribute has its components and role") {
  const std::string nine = "1 2 3 4 5 6 7 8 9\n";
  const DatasetPtr d =
      read_legacy(ascii + triangle + "POINT_DATA 3\nSCALARS s float 2\nLOOKUP_TABLE default\n1 2 3 4 5 6\nVECTORS v double\n" + nine +
                  "NORMALS n float\n" + nine + "TEXTURE_COORDINATES t 2 float\n1 2 3 4 5 6\nTENSORS T float\n" + nine + nine + nine +
                  "TENSORS6 T6 float\n" + nine + nine +
                  "GLOBAL_IDS g vtkIdType\n7 8 9\nMETADATA\nINFORMATION 0\n\nFIELD f 3\nb 1 3 bit\n1 0 1\nwords 1 2 "
                  "string\nfirst%20word\nsecond\nx 3 3 long\n" +
                  nine + "CELL_DATA 1\nPEDIGREE_IDS p int\n4\nEDGE_FLAGS e int\n0\n");
  const std::tuple<const char*, int, Role> want[] = {
      {"s", 2, Role::scalars},  {"v", 3, Role::vectors},    {"n", 3, Role::normals}, {"t", 2, Role::tcoords}, {"T", 9, Role::tensors},
      {"T6", 6, Role::tensors}, {"g", 1, Role::global_ids}, {"b", 1, Role::none},    {"x", 3, Role::none},    {"p", 1, Role::global_ids}};
  for (const auto& [name, components, role] : want) {
    CAPTURE(name);
    const Field* f = d->fields().find(name);
    REQUIRE(f);
    CHECK(f->components() == components);
    CHECK(f->role == role);
  }
  CHECK(values(*d, "b") == std::vector<double>{1, 0, 1});
  CHECK(d->fields().find("g")->array.type() == ElementType::i64);
}

TEST_CASE("vtk legacy: big-endian bytes, bits, strings, ids and version 5 cell lists") {
  const std::string text = binary + "DATASET UNSTRUCTURED_GRID\nFIELD FieldData 2\nTIME 1 1 double\n" + big_endian<double>({2.5}) +
                           "\nnote 1 1 string\n\xC3"
                           "abc\n" +
                           "POINTS 5 float\n" + big_endian<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}) +
                           "\nMETADATA\nINFORMATION 0\n\n" + "CELLS 3 7\nOFFSETS vtktypeint64\n" + big_endian<int64_t>({0, 4, 7}) +
                           "\nCONNECTIVITY vtktypeint64\n" + big_endian<int64_t>({0, 1, 2, 3, 4, 0, 1}) + "\nCELL_TYPES 2\n" +
                           big_endian<int32_t>({10, 5}) + "\nPOINT_DATA 5\nFIELD FieldData 3\nb 1 5 bit\n\xA8\nids 1 5 vtkIdType\n" +
                           big_endian<int32_t>({1, 2, 3, 4, -5}) + "\nu 1 5 unsigned_short\n" + big_endian<uint16_t>({1, 2, 3, 4, 65535}) +
                           "\n";
  const DatasetPtr d = read_legacy(text);
  const auto& m = *d->as<UnstructuredMesh>();
  CHECK(m.points.at(4) == Vec3{1, 1, 1});
  CHECK(cells_view(m.cells).point(1, 0) == 4);
  CHECK(m.type(1) == CellType::triangle);
  CHECK(d->time() == 2.5);
  CHECK(values(*d, "b") == std::vector<double>{1, 0, 1, 0, 1});
  CHECK(values(*d, "ids") == std::vector<double>{1, 2, 3, 4, -5});
  CHECK(values(*d, "u")[4] == 65535);
  // Cut anywhere before the last array it is an error, and never worse.
  const size_t points = text.find("POINTS"), types = text.find("\nPOINT_DATA"), field = text.find("FIELD FieldData 3");
  for (size_t n = 27; n < text.size() - 1; ++n) {
    if ((n > points && n < types) || n > field + 6) CHECK(contains(error_of_legacy(text.substr(0, n)), "x.vtk"));
    else CHECK_NOTHROW(try { read_legacy(text.substr(0, n)); } catch (const Error&){});
  }
}

TEST_CASE("vtk legacy: polyhedra are read from face streams") {
  const DatasetPtr d =
      read_legacy(ascii +
                  "DATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\nCELLS 2 23\n17 4 3 0 1 2 3 0 1 "
                  "3 3 1 2 3 3 0 2 3\n4 0 1 2 4\nCELL_TYPES 2\n42 10\n");
  const auto& m = *d->as<UnstructuredMesh>();
  CHECK(m.faces.size() == 4);
  CHECK(cells_view(m.cells).size(0) == 4);
  CHECK(cells_view(m.cells).point(1, 3) == 4);
  CHECK(m.polyhedron_faces.view<int64_t>()[2] == 4);
  CHECK(contains(error_of_legacy(ascii + "DATASET UNSTRUCTURED_GRID\nPOINTS 1 float\n0 0 0\nCELLS 1 3\n2 9 0\nCELL_TYPES 1\n42\n"),
                 "polyhedron"));
}

TEST_CASE("vtk legacy: a text file cut anywhere before its last attribute gives an Error with the line") {
  const std::string text = ascii + triangle + "POINT_DATA 3\nFIELD f 2\na 1 3 float\n1.5 2.5 3.5\nb 3 3 double\n1 2 3 4 5 6 7 8 9\n";
  const size_t points = text.find("POINTS");
  for (size_t i = 1; i < 64; ++i) {
    const size_t n = text.size() * i / 64;
    CAPTURE(i);
    if (n > points && n < text.find("POINT_DATA")) {
      CHECK(contains(error_of_legacy(text.substr(0, n)), "x.vtk"));
    } else if (n > text.find("FIELD") + 8) {
      CHECK(contains(error_of_legacy(text.substr(0, n)), "x.vtk: line"));
    } else {
      CHECK_NOTHROW(try { read_legacy(text.substr(0, n)); } catch (const Error&){});
    }
  }
}

TEST_CASE("vtk legacy: files with any byte changed read or give an Error, and nothing worse") {
  const std::string text = ascii + triangle +
                           "POINT_DATA 3\nSCALARS a float\nLOOKUP_TABLE default\n1.5 2.5 3.5\nMETADATA\nINFORMATION 0\n\nFIELD f 1\nb 3 3 "
                           "double\n1 2 3 4 5 6 7 8 9\n";
  size_t errors = 0, reads = 0;
  for (size_t i = 0; i < 3000; ++i) {
    std::string bent = text;
    const uint64_t h = (i + 1) * 0x9e3779b97f4a7c15ull;
    bent[(h >> 20) % bent.size()] = char(h >> 8);
    try {
      read_legacy(bent);
      ++reads;
    } catch (const Error& e) {
      CHECK(e.kind() == ErrorKind::data);
      ++errors;
    }
  }
  CHECK(errors > 300);
  CHECK(reads > 300);
}

TEST_CASE("vtk legacy: wrong words, counts and types are refused with line and reason") {
  CHECK(contains(error_of_legacy("# vtk DataFile Version 3.0\nt\nTEXT\n"), "TEXT"));
  CHECK(contains(error_of_legacy(ascii + "DATASET MULTIBLOCK\n"), "MULTIBLOCK"));
  CHECK(contains(error_of_legacy(ascii + "FIELD f 1\na 1 2 float\n1 2\n"), "no mesh"));
  CHECK(contains(error_of_legacy(ascii + "POINT_DATA 3\n"), "no mesh"));
  CHECK(contains(error_of_legacy(ascii + "DATASET POLYDATA\nPOINTS 9223372036854775807 float\n0 0 0"), "line 5"));
  CHECK(contains(error_of_legacy(ascii + "DATASET POLYDATA\nPOINTS -1 float\n"), "'-1'"));
  CHECK(contains(error_of_legacy(ascii + "DATASET POLYDATA\nPOINTS 1 half\n0 0 0"), "half"));
  CHECK(contains(error_of_legacy(ascii + "DATASET POLYDATA\nPOINTS 2 float\n0 0 0 1 x 0\n"), "line 6"));
  CHECK(contains(error_of_legacy(ascii + "DATASET POLYDATA\nPOINTS 1 float\n0 0 0\nPOLYGONS 2 3\n2 0 0\n"), "POLYGONS"));
  CHECK(contains(error_of_legacy(ascii + "DATASET POLYDATA\nPOINTS 1 float\n0 0 0\nPOLYGONS 1 3\n5 0 0\n"), "cell 0"));
  CHECK(contains(error_of_legacy(ascii + "DATASET POLYDATA\nPOINTS 1 float\n0 0 0\nPOLYGONS 1 2\n1 4\n"), "point id 4"));
  CHECK(contains(error_of_legacy(ascii + "DATASET POLYDATA\nPOINTS 1 float\n0 0 0\nCELLS 1 2\n1 0\n"), "CELLS"));
  CHECK(contains(error_of_legacy(ascii + "DATASET UNSTRUCTURED_GRID\nPOINTS 1 float\n0 0 0\n"), "no CELLS"));
  CHECK(contains(error_of_legacy(ascii + "DATASET UNSTRUCTURED_GRID\nPOINTS 1 float\n0 0 0\nCELLS 1 2\n1 0\n"), "0 CELL_TYPES"));
  CHECK(
      contains(error_of_legacy(ascii + "DATASET UNSTRUCTURED_GRID\nPOINTS 1 float\n0 0 0\nCELLS 1 2\n1 0\nCELL_TYPES 1\n99\n"), "type 99"));
  CHECK(contains(error_of_legacy(ascii + "DATASET STRUCTURED_POINTS\nORIGIN 0 0 0\n"), "DIMENSIONS"));
  CHECK(contains(error_of_legacy(ascii + "DATASET STRUCTURED_GRID\nDIMENSIONS 2 2 2\nPOINTS 1 float\n0 0 0\n"), "2x2x2"));
  CHECK(contains(error_of_legacy(ascii + "DATASET RECTILINEAR_GRID\nDIMENSIONS 2 1 1\nX_COORDINATES 1 float\n0\n"), "x coordinates"));
  CHECK(contains(error_of_legacy(ascii + triangle + "POINT_DATA 3\nSCALARS s float\n1 2 3\n"), "LOOKUP_TABLE"));
  CHECK(contains(error_of_legacy(ascii + triangle + "POINT_DATA 2\nVECTORS v float\n1 2 3 4 5 6\n"), "'v'"));
  CHECK(contains(error_of_legacy(ascii + triangle + "POINT_DATA 3\nVECTORS v float\n1 2 3 4 5 6 7 8 9\n10 11\n"), "'10'"));
  CHECK(contains(error_of_legacy(ascii + triangle + "VECTORS v float\n1 2 3\n"), "POINT_DATA"));
  CHECK(contains(error_of_legacy(binary + "DATASET POLYDATA\nPOINTS 1000 float\nabc"), "byte"));
}

TEST_CASE("vtk numbers: what printers print is read back, in parallel as in one thread") {
  const std::string text = "+1 -2.5e3 .5 5. nan -inf 1.#QNAN 1.#INF -1.#IND 1e400 1e-400 0x";
  double v[12];
  const vtk::NumbersEnd end = vtk::parse_numbers(text, ElementType::f64, 12, reinterpret_cast<std::byte*>(v));
  CHECK(end.parsed == 11);
  REQUIRE(end.bad);
  CHECK(std::string_view(end.bad) == "0x");
  CHECK((v[0] == 1 && v[1] == -2500 && v[2] == 0.5 && v[3] == 5));
  CHECK((std::isnan(v[4]) && v[5] == -HUGE_VAL && std::isnan(v[6]) && v[7] == HUGE_VAL && std::isnan(v[8])));
  CHECK((v[9] == HUGE_VAL && v[10] == 0));

  std::vector<double> many(200000);
  for (size_t i = 0; i < many.size(); ++i) many[i] = std::sqrt(double(i)) * (i % 7 ? 1e-5 : -1e300);
  const std::string long_text = vtk::format_numbers(Array::from_vector(std::vector<double>(many)), 3);
  CHECK(vtk::count_words(long_text) == many.size());
  for (const int threads : {1, 8}) {
    set_thread_count(threads);
    std::vector<double> back(many.size() + 1);
    const auto all = vtk::parse_numbers(long_text, ElementType::f64, many.size(), reinterpret_cast<std::byte*>(back.data()));
    CHECK(all.parsed == many.size());
    CHECK(std::equal(many.begin(), many.end(), back.begin()));
    const auto more = vtk::parse_numbers(long_text, ElementType::f64, back.size(), reinterpret_cast<std::byte*>(back.data()));
    CHECK(more.parsed == many.size());
    CHECK(more.bad == nullptr);
  }
  set_thread_count(0);
}
