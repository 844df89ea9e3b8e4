// SPDX-License-Identifier: Apache-2.0
// VTK XML: what is written reads back exactly; pieces are joined; each encoding is understood.
#include "base/file/mapped_watch.h"
#include "io/vtk/vtk_samples.h"

using namespace sg;
using namespace sg::test;

TEST_CASE("vtk xml: each mesh kind reads back exactly in each encoding and compression") {
  for (const Sample& s : samples())
    for (const WriteOptions& o : every_option) {
      CAPTURE(s.extension);
      CAPTURE(std::string(word_of(o.encoding)));
      CAPTURE(std::string(word_of(*o.compression)));
      const std::string path = temp(std::string("round.") + s.extension);
      write(path, s.dataset, o);
      check_same(*s.dataset, *read(path));
    }
}

TEST_CASE("vtk xml: one thread and eight write the same bytes") {
  const DatasetPtr d = make_dataset(tetra_mesh(200000));
  for (const WriteOptions& o : every_option) {
    if (o.compression == Compression::lzma) continue;
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

TEST_CASE("vtk xml: uncompressed appended points of our own files are not copied; ids are, since they are trusted once they are checked") {
  write(temp("zero.vtu"), make_dataset(tetra_mesh(1000)));
  const DatasetPtr d = read(temp("zero.vtu"));
  const auto& m = *d->as<UnstructuredMesh>();
  CHECK(mapped_watch().holds(m.points.xyz.raw()));
  CHECK(reinterpret_cast<uintptr_t>(m.points.xyz.raw()) % 64 == 0);
  CHECK(!mapped_watch().holds(m.cells.connectivity.raw()));
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
  CHECK(test::error_of([&] { write(temp("x.vtu"), d, {VtkEncoding::base64, Compression::gzip}); }).find("lz4") != std::string::npos);
  CHECK(test::error_of([&] { write(temp("x.vtu"), d, {VtkEncoding::ascii, Compression::zlib}); }).find("compressed") != std::string::npos);
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
    return std::string("<PointData><DataArray type=\"Float64\" Name=\"T\" format=\"ascii\">") + point +
           "</DataArray></PointData><CellData Scalars=\"c\">" + "<DataArray type=\"UInt8\" Name=\"c\" format=\"ascii\">" + cell +
           "</DataArray></CellData>";
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
    return std::string(
               "<Piece NumberOfPoints=\"3\" NumberOfVerts=\"1\" NumberOfPolys=\"1\"><CellData><DataArray type=\"Int16\" Name=\"c\" "
               "format=\"ascii\">") +
           cell +
           "</DataArray></CellData><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 "
           "0</DataArray></Points>"
           "<Verts><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">2</DataArray><DataArray type=\"Int32\" "
           "Name=\"offsets\" format=\"ascii\">1</DataArray></Verts>"
           "<Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">" +
           ids + "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray></Polys></Piece>";
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
  CHECK(test::error_of([&] { read_text("pieces.vtp", head + part("0 1 3", "1 2") + part("2 1 0", "3 4") + tail); }).find("3") !=
        std::string::npos);
}

TEST_CASE("vtk xml: pieces of an image are put in their place, gaps are hidden") {
  auto part = [](const char* extent, const char* point, const char* cell) {
    return std::string("<Piece Extent=\"") + extent + "\"><PointData><DataArray type=\"Int32\" Name=\"p\" format=\"ascii\">" + point +
           "</DataArray></PointData><CellData><DataArray type=\"Int32\" Name=\"c\" format=\"ascii\">" + cell +
           "</DataArray></CellData></Piece>";
  };
  const std::string head = "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"2 5 0 1 0 0\" Origin=\"10 0 0\" Spacing=\"0.5 1 1\">",
                    tail = "</ImageData></VTKFile>";
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
    return std::string("<DataArray type=\"Float32\" Name=\"") + name + "\" NumberOfComponents=\"" + n + "\" format=\"ascii\">" + values +
           "</DataArray>";
  };
  auto rect = [&](const char* extent, const char* x) {
    return std::string("<Piece Extent=\"") + extent + "\"><Coordinates>" + array("x", "1", x) + array("y", "1", "0 1") +
           array("z", "1", "0") + "</Coordinates></Piece>";
  };
  const DatasetPtr r = read_text("p.vtr", "<VTKFile type=\"RectilinearGrid\"><RectilinearGrid WholeExtent=\"0 3 0 1 0 0\">" +
                                              rect("0 1 0 1 0 0", "0 1") + rect("1 3 0 1 0 0", "1 5 7") + "</RectilinearGrid></VTKFile>");
  REQUIRE(r->as<RectilinearGrid>()->x.count() == 4);
  CHECK(r->as<RectilinearGrid>()->x.type() == ElementType::f32);
  CHECK(r->as<RectilinearGrid>()->x.get(3) == 7);
  auto curv = [&](const char* extent, const char* xyz) {
    return std::string("<Piece Extent=\"") + extent + "\"><Points>" + array("P", "3", xyz) + "</Points></Piece>";
  };
  const DatasetPtr c =
      read_text("p.vts", "<VTKFile type=\"StructuredGrid\"><StructuredGrid WholeExtent=\"0 2 0 0 0 0\">" +
                             curv("0 1 0 0 0 0", "0 0 0 1 0 0") + curv("1 2 0 0 0 0", "1 0 0 4 5 6") + "</StructuredGrid></VTKFile>");
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
  const DatasetPtr d = read_text(
      "be.vti",
      "<VTKFile type=\"ImageData\" byte_order=\"BigEndian\" header_type=\"UInt32\"><ImageData WholeExtent=\"0 2 0 0 0 0\">"
      "<FieldData><DataArray type=\"Bit\" Name=\"bits\" NumberOfTuples=\"10\" format=\"appended\" offset=\"28\"/></FieldData>"
      "<Piece Extent=\"0 2 0 0 0 0\"><PointData><DataArray type=\"Float64\" Name=\"T\" format=\"appended\" offset=\"0\"/></PointData>"
      "</Piece></ImageData><AppendedData encoding=\"raw\">\n_" +
          raw + "\n</AppendedData></VTKFile>");
  const Array& t = d->fields().find("T")->array;
  CHECK((t.get(0) == 1.5 && t.get(1) == -2 && t.get(2) == 1e100));
  const Array& bits = d->fields().find("bits")->array;
  REQUIRE(bits.count() == 10);
  const int want[] = {1, 0, 1, 0, 0, 1, 0, 1, 1, 0};
  for (size_t i = 0; i < 10; ++i) CHECK(bits.get(i) == want[i]);
}

TEST_CASE("vtk xml: strings of points and cells are categories with names, those of the whole are notes") {
  const auto file = [](const char* codes) {
    return std::string(
               "<VTKFile type=\"PolyData\"><PolyData><FieldData><Array type=\"String\" Name=\"Title\" NumberOfTuples=\"1\" "
               "format=\"ascii\">72 105 0</Array></FieldData><Piece NumberOfPoints=\"3\" NumberOfVerts=\"3\"><PointData>"
               "<Array type=\"String\" Name=\"site\" format=\"ascii\">") +
           codes +
           "</Array></PointData><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 2 0 0</DataArray>"
           "</Points><Verts><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>"
           "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">1 2 3</DataArray></Verts></Piece></PolyData></VTKFile>";
  };
  const DatasetPtr d = read_text("strings.vtp", file("116 105 110 0 97 0 116 105 110 0"));  // tin a tin
  const Field& site = d->fields().require("site", Association::point);
  CHECK(site.role == Role::labels);
  REQUIRE(site.array.count() == 3);
  CHECK((site.array.get(0) == 1 && site.array.get(1) == 0 && site.array.get(2) == 1));
  std::string notes;
  for (const auto& [key, value] : d->notes()) notes += key + ":" + value + ";";
  CHECK(notes.find("labels of site:0=a\n1=tin;") != std::string::npos);
  CHECK(notes.find("Title:Hi;") != std::string::npos);
  CHECK(refusal("strings.vtp", file("97 0 98 0")).find("has 2 strings for 3 points") != std::string::npos);
  CHECK(refusal("strings.vtp", file("97 0 98 0 97 0 97 0 97 0")).find("has more strings for 3 points") != std::string::npos);
}

TEST_CASE("vtk xml: base64 may be wrapped, and its size may be padded on its own") {
  auto file = [](const char* data) {
    return std::string(
               "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 1 0 0 0 0\"><Piece Extent=\"0 1 0 0 0 0\"><PointData>"
               "<DataArray type=\"Int32\" Name=\"v\" format=\"binary\">") +
           data + "</DataArray></PointData></Piece></ImageData></VTKFile>";
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
  const DatasetPtr d = read_text(
      "poly23.vtu",
      vtu("<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">"
          "0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells>" +
          array + "\"connectivity\">0 1 2 3</DataArray>" + array + "\"offsets\">4</DataArray>" + array + "\"types\">42</DataArray>" +
          array + "\"face_connectivity\">0 1 2 0 3 1 1 3 2 2 3 0</DataArray>" + array + "\"face_offsets\">3 6 9 12</DataArray>" + array +
          "\"polyhedron_to_faces\">3 0 1 2</DataArray>" + array + "\"polyhedron_offsets\">4</DataArray></Cells></Piece>"));
  const auto& m = *d->as<UnstructuredMesh>();
  REQUIRE(m.faces.size() == 4);
  CHECK(cells_view(m.faces).point(0, 0) == 2);
  CHECK(cells_view(m.faces).point(1, 0) == 0);
}

TEST_CASE("vtk xml: 64-bit ids come as 32-bit ones when they are unpacked or lie on odd bytes, and none is cut") {
  DatasetParts p;
  UnstructuredMesh m = tetra_mesh(3000);  // several blocks
  m.cells.connectivity = m.cells.connectivity.converted(ElementType::i64);
  p.mesh = m;
  const DatasetPtr d = make_dataset(p);
  auto ids_of = [](const DatasetPtr& x) { return x->as<UnstructuredMesh>()->cells; };
  for (const char* compression : {"none", "zlib", "lz4"}) {
    CAPTURE(compression);
    Context context;
    write_data(temp("ids.vtu"), d, {VtkEncoding::appended, value_of_word<Compression>(compression)}, context);
    const bool plain = std::string_view(compression) == "none";
    const std::string text(MappedFile(temp("ids.vtu")).text());
    for (const size_t shift : {0, 1, 8, 13}) {
      CAPTURE(shift);
      std::string moved = text;
      moved.insert(8, std::string(shift, ' '));  // behind "<VTKFile"
      write_file(temp("moved.vtu"), moved);
      for (const int threads : {1, 8}) {
        set_thread_count(threads);
        const DatasetPtr back = read(temp("moved.vtu"));
        set_thread_count(0);
        check_same_cells(ids_of(d), ids_of(back));
        CHECK(ids_of(back).fixed == 4);
        CHECK(ids_of(back).connectivity.type() == (plain && shift % 8 == 0 ? ElementType::i64 : ElementType::i32));
      }
    }
    // 2^32 is no 0: an id that 32 bits cannot hold is refused as what it is.
    std::vector<int64_t> ids(m.cells.connectivity.count());
    for (size_t i = 0; i < ids.size(); ++i) ids[i] = int64_t(m.cells.connectivity.get(i));
    ids[7777] += int64_t(1) << 32;
    DatasetParts q;
    q.mesh = m;
    q.fields.add({"connectivity copy", Association::whole, Array::from_vector(ids), {}, Role::none});
    write_data(temp("copy.vtu"), make_dataset(q), {VtkEncoding::appended, value_of_word<Compression>(compression)}, context);
    std::string swapped(MappedFile(temp("copy.vtu")).text());
    const size_t good_name = swapped.find("\"connectivity\""), copy_name = swapped.find("\"connectivity copy\"");
    REQUIRE(good_name != std::string::npos);
    REQUIRE(copy_name != std::string::npos);
    // The array of that name is the copy now: same length, one id too large.
    auto offset_of = [&](size_t name) {
      const size_t at = swapped.find("offset=\"", name) + 8;
      return std::pair(at, swapped.substr(at, swapped.find('"', at) - at));
    };
    const auto [good_at, good] = offset_of(good_name);
    const std::string copy = offset_of(copy_name).second;
    swapped.replace(good_at, good.size(), copy);
    if (copy.size() < good.size()) swapped.insert(swapped.find("/>", good_at), good.size() - copy.size(), ' ');
    write_file(temp("swapped.vtu"), swapped);
    const std::string error = error_of([&] { read(temp("swapped.vtu")); });
    CHECK(error.find(std::to_string(ids[7777])) != std::string::npos);
  }
}
