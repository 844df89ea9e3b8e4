// SPDX-License-Identifier: Apache-2.0
#include "io/io_files.h"

#include "base/bytes.h"

using namespace sg;
using namespace sg::test;

namespace {

struct Bytes {
  std::string s;
  bool big = false;
  template <class T>
  Bytes& put(T v) {
    const T x = load<T>(&v, big);
    s.append(reinterpret_cast<const char*>(&x), sizeof x);
    return *this;
  }
};

std::string header(const std::string& format, const std::string& rest) {
  return "ply\nformat " + format + " 1.0\n" + rest + "end_header\n";
}

const std::string mixed =
    "comment a remark\nelement vertex 4\nproperty double x\nproperty short y\nproperty float z\nproperty list uchar int "
    "neighbours\nproperty uchar red\nproperty uchar green\n"
    "property uchar blue\nproperty uchar alpha\nproperty int tag\nelement face 2\nproperty float quality\nproperty list ushort uint "
    "vertex_indices\nproperty list uchar float texcoord\n"
    "property uchar flag\nelement extra 1\nproperty int a\n";

// The same data in the three encodings.
std::string mixed_file(int encoding) {
  if (encoding == 0)
    return header("ascii", mixed) +
           "0 0 0.5 0 1 2 3 4 -5\n1 0 0 2 7 8 10 20 30 40 6\n\n1 1 0 1 9 0 0 0 255 7\n0.1 1 0 0 255 255 255 0 8\n1.5 3 0 1 2 2 0.5 0.25 "
           "9\n2.5 4 0 1 2 3 0 1\n77\n";
  Bytes b;
  b.big = encoding == 2;
  auto vertex = [&](double x, int16_t y, float z, std::vector<int32_t> near, std::array<uint8_t, 4> c, int32_t tag) {
    b.put(x).put(y).put(z).put(uint8_t(near.size()));
    for (const int32_t i : near) b.put(i);
    for (const uint8_t v : c) b.put(v);
    b.put(tag);
  };
  vertex(0, 0, 0.5f, {}, {1, 2, 3, 4}, -5);
  vertex(1, 0, 0, {7, 8}, {10, 20, 30, 40}, 6);
  vertex(1, 1, 0, {9}, {0, 0, 0, 255}, 7);
  vertex(0.1, 1, 0, {}, {255, 255, 255, 0}, 8);
  b.put(1.5f).put(uint16_t(3)).put(0u).put(1u).put(2u).put(uint8_t(2)).put(0.5f).put(0.25f).put(uint8_t(9));
  b.put(2.5f).put(uint16_t(4)).put(0u).put(1u).put(2u).put(3u).put(uint8_t(0)).put(uint8_t(1));
  b.put(77);
  return header(encoding == 1 ? "binary_little_endian" : "binary_big_endian", mixed) + b.s;
}

// A grid of triangles with a point and a cell field, large enough for several chunks.
DatasetPtr grid_surface(int n) {
  std::vector<float> xyz, t;
  std::vector<int32_t> ids, number;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      xyz.insert(xyz.end(), {float(i) / float(n), float(j) / 3, float(i * j) * 1e-3f}), t.push_back(float(i) + 0.1f * float(j));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i;
      ids.insert(ids.end(), {a, a + 1, a + n + 1, a + 1, a + n + 2, a + n + 1});
      number.insert(number.end(), {2 * (j * n + i), 2 * (j * n + i) + 1});
    }
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(xyz, 3);
  m.polygons.connectivity = Array::from_vector(ids);
  m.polygons.fixed = 3;
  FieldSet f;
  f.add({"T", Association::point, Array::from_vector(t), "", Role::none});
  f.add({"number", Association::cell, Array::from_vector(number), "", Role::none});
  return make_dataset(m, f);
}

bool same_surface(const DatasetPtr& a, const DatasetPtr& b) {
  if (!same_array(surface_of(a).points.xyz, surface_of(b).points.xyz) ||
      !same_array(surface_of(a).polygons.connectivity, surface_of(b).polygons.connectivity) ||
      !same_array(surface_of(a).polygons.offsets, surface_of(b).polygons.offsets) || a->fields().size() != b->fields().size())
    return false;
  for (size_t i = 0; i < a->fields().size(); ++i)
    if (a->fields()[i].name != b->fields()[i].name || !same_array(a->fields()[i].array, b->fields()[i].array)) return false;
  return true;
}

}  // namespace

TEST_CASE("ply: the three encodings of one surface, with lists and properties in any order, are the same") {
  const auto text = read_text("m.ply", mixed_file(0));
  CHECK(text->point_count() == 4);
  CHECK(text->cell_count() == 2);
  CHECK(surface_of(text).points.xyz.type() == ElementType::f64);
  CHECK(surface_of(text).points.xyz.get(3, 0) == 0.1);
  const Field& c = text->fields().require("RGBA");
  CHECK(c.role == Role::colors);
  CHECK(c.array.get(1, 2) == 30);
  CHECK(text->fields().require("tag").array.get(0) == -5);
  CHECK(text->fields().require("tag").array.type() == ElementType::i32);
  CHECK(text->fields().require("quality", Association::cell).array.get(1) == 2.5);
  CHECK(text->fields().require("flag", Association::cell).array.get(0) == 9);
  CHECK(cells_view(surface_of(text).polygons).size(1) == 4);
  CHECK(cells_view(surface_of(text).polygons).point(1, 3) == 3);
  CHECK(text->notes().at(0).second == "a remark");
  CHECK(same_surface(text, read_text("m.ply", mixed_file(1))));
  CHECK(same_surface(text, read_text("m.ply", mixed_file(2))));
}

TEST_CASE("ply: written and read back, binary and ASCII, with 1 and 4 threads") {
  const auto d = grid_surface(150);
  Context context;
  for (const bool binary : {true, false}) {
    WriteOptions o;
    o.binary = binary;
    const std::string path = temp_folder() + "w.ply";
    write_data(path, d, o, context);
    const auto one = with_threads(1, [&] { return read_file(path); });
    const auto four = with_threads(4, [&] { return read_file(path); });
    CHECK(same_surface(d, one));
    CHECK(same_surface(one, four));
  }
}

TEST_CASE("ply: normals, texture coordinates and colours come back under their roles") {
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, 3);
  m.points.origin = {1e7, 0, 0};
  m.strips.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2, 3});
  m.strips.offsets = Array::from_vector(std::vector<int32_t>{0, 4});
  FieldSet f;
  f.add({"N", Association::point, Array::from_vector(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0}, 3), "", Role::normals});
  f.add({"uv", Association::point, Array::from_vector(std::vector<float>{0, 0, 1, 0, 0, 1, 1, 1}, 2), "", Role::tcoords});
  f.add({"col", Association::point, Array::from_vector(std::vector<uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, 3), "", Role::colors});
  f.add({"a vector", Association::point, Array::from_vector(std::vector<int64_t>{1, 2, 3, 4, 5, 6, 7, 8}, 2), "", Role::none});
  Context context;
  write_data(temp_folder() + "r.ply", make_dataset(m, f), {}, context);
  const auto d = read_file(temp_folder() + "r.ply");
  CHECK(d->cell_count() == 2);
  CHECK(surface_of(d).points.at(1).x == 1e7 + 1);
  CHECK(d->fields().require("N").array.get(3, 1) == 1);
  CHECK(d->fields().require("uv").array.get(1, 0) == 1);
  CHECK(d->fields().require("col").array.get(3, 2) == 12);
  CHECK(d->fields().require("a vector").array.get(2, 1) == 6);
  for (const Field& field : f) CHECK(d->fields().require(field.name).role == field.role);
  // Without our comments the roles give the names.
  std::string text(MappedFile(temp_folder() + "r.ply").text());
  for (size_t at; (at = text.find("comment field")) != std::string::npos;) text.erase(at, text.find('\n', at) + 1 - at);
  const auto plain = read_text("plain.ply", text);
  CHECK(plain->fields().require("Normals").array.get(3, 1) == 1);
  CHECK(plain->fields().require("TCoords").array.get(1, 0) == 1);
  CHECK(plain->fields().require("RGB").array.get(3, 2) == 12);
  CHECK(plain->fields().require("a_vector_1").array.get(2) == 6);
}

TEST_CASE("ply: strips, edges, points alone, and fields on request") {
  const std::string points = "element vertex 5\nproperty float x\nproperty float y\nproperty float z\nproperty float a\nproperty float b\n";
  const std::string rows = "0 0 0 1 2\n1 0 0 1 2\n0 1 0 1 2\n1 1 0 1 2\n2 2 0 1 2\n";
  auto d = read_text(
      "s.ply", header("ascii", points + "element tristrips 1\nproperty list int int vertex_indices\n") + rows + "8 0 1 2 3 -1 2 3 4\n");
  CHECK(surface_of(d).strips.size() == 2);
  CHECK(cells_view(surface_of(d).strips).size(0) == 4);
  CHECK(cells_view(surface_of(d).strips).point(1, 2) == 4);
  d = read_text("s.ply", header("ascii", points + "element edge 2\nproperty int vertex1\nproperty int vertex2\n") + rows + "0 1\n3 4\n");
  CHECK(surface_of(d).lines.size() == 2);
  CHECK(cells_view(surface_of(d).lines).point(1, 1) == 4);
  d = read_text("s.ply", header("ascii", points) + rows);
  CHECK(d->cell_count() == 0);
  CHECK(d->fields().size() == 2);
  ReadOptions o;
  o.fields = {"b"};
  CHECK(read_text("s.ply", header("ascii", points) + rows, o)->fields().names() == std::vector<std::string>{"b"});
  o = {};
  o.header_only = true;
  CHECK(read_text("s.ply", header("ascii", points) + rows, o)->fields().size() == 0);
}

TEST_CASE("ply: faces without points are kept, so that face properties still fit") {
  const std::string h =
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face 2\nproperty list uchar int "
      "vertex_indices\nproperty uchar a\n";
  Bytes b;
  b.put(0.f).put(0.f).put(0.f).put(uint8_t(0)).put(uint8_t(5)).put(uint8_t(0)).put(uint8_t(6));
  for (const auto& d :
       {read_text("e.ply", header("binary_little_endian", h) + b.s), read_text("e.ply", header("ascii", h) + "0 0 0\n0 5\n0 6\n")}) {
    CHECK(d->cell_count() == 2);
    CHECK(d->fields().require("a").array.get(1) == 6);
  }
}

TEST_CASE("ply: numbers that are not finite are data") {
  const auto d =
      read_text("n.ply", header("ascii", "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float t\n") +
                             "0 0 0 nan\n1 0 0 inf\n0 1 0 -inf\n");
  CHECK(std::isnan(d->fields()[0].array.get(0)));
  CHECK(d->fields()[0].array.get(2) == -HUGE_VAL);
}

TEST_CASE("ply: bad files are refused") {
  const std::string xyz = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n", rows = "0 0 0\n1 0 0\n0 1 0\n";
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
  CHECK(contains(refusal("b.ply", "ply\nformat ascii 1.0\n" + xyz), "ends inside its header"));
  CHECK(contains(refusal("b.ply", "ply\nformat morse 1.0\n"), "unknown format 'morse'"));
  CHECK(contains(refusal("b.ply", "ply\nelement vertex 3\nend_header\n"), "no 'format'"));
  CHECK(contains(refusal("b.ply", header("ascii", "element vertex many\n")), "line 3"));
  CHECK(contains(refusal("b.ply", header("ascii", "property float x\n")), "precedes the first element"));
  CHECK(contains(refusal("b.ply", header("ascii", "element vertex 3\nproperty complex x\n")), "unknown type 'complex'"));
  CHECK(contains(refusal("b.ply", header("ascii", "element vertex 3\nproperty list float int x\n")), "cannot be a float"));
  CHECK(contains(refusal("b.ply", header("ascii", "elephant vertex 3\n")), "unknown keyword 'elephant'"));
  CHECK(contains(refusal("b.ply", header("ascii", "element face 0\n")), "no element 'vertex'"));
  CHECK(contains(refusal("b.ply", header("ascii", "element vertex 0\nproperty float x\n")), "no 'y'"));
  CHECK(contains(refusal("b.ply", header("ascii", xyz + "element face 1\nproperty uchar a\n") + rows + "1\n"), "no list 'vertex_indices'"));
  CHECK(contains(refusal("b.ply", header("ascii", xyz) + "0 0 0\n1 0 zero\n0 1 0\n"), "line 9: vertex 1: 'z' has no number"));
  CHECK(contains(refusal("b.ply", header("ascii", xyz) + "0 0 0\n1 0 0       \n"), "are announced"));
  CHECK(contains(refusal("b.ply", header("ascii", xyz + face) + rows + "3 0 1 7\n"), "point id 7"));
  CHECK(contains(refusal("b.ply", header("ascii", xyz + face) + rows + "3 0 1 -1\n"), "point id -1"));
  CHECK(contains(refusal("b.ply", header("ascii", xyz + face) + rows + "3 0 1\n"), "does not have the 3 numbers"));
  CHECK(contains(refusal("b.ply", header("ascii", xyz + face) + rows + "300000 0 1 2\n"), "announces 300000 entries"));
  CHECK(contains(
      refusal("b.ply", header("ascii", "element vertex 4000000000000000000\nproperty float x\nproperty float y\nproperty float z\n")),
      "do not fit"));
  CHECK(contains(
      refusal("b.ply",
              header("binary_little_endian", "element vertex 999999999\nproperty float x\nproperty float y\nproperty float z\n") + rows),
      "do not fit"));
  CHECK(contains(refusal("b.ply", header("ascii", xyz + "element tristrips 1\nproperty uchar a\n") + rows + "1\n"), "tristrips"));
  CHECK(contains(refusal("b.ply", header("ascii", xyz + "element edge 1\nproperty uchar a\n") + rows + "1\n"), "vertex1"));
  Context context;
  CHECK(contains(error_of([&] { write_data(temp_folder() + "x.ply", make_dataset(UniformGrid{}), {}, context); }), "-f 'faces'"));
}

TEST_CASE("ply: cut and damaged files give errors, never crashes") {
  for (int encoding = 0; encoding < 3; ++encoding) {
    const std::string all = mixed_file(encoding);
    CHECK(cut_and_damage("cut.ply", all) >= 61);  // the element behind the faces is not needed
  }
}

TEST_CASE("ply: fields keep their names and components through our own files, binary and ASCII") {
  DatasetParts p;
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  m.polygons.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2}), m.polygons.fixed = 3;
  p.mesh = m;
  p.fields.add({"wall normals", Association::point, Array::from_vector(std::vector<double>(9, 0.6), 3), "", Role::normals});
  p.fields.add({"Tensors_", Association::point, Array::from_vector(std::vector<float>(27, 0.25f), 9), "", Role::none});
  p.fields.add({"a b", Association::cell, Array::from_vector(std::vector<int16_t>{5}), "", Role::none});
  p.fields.add({"tint", Association::cell, Array::from_vector(std::vector<uint8_t>{1, 2, 3}, 3), "", Role::colors});
  const DatasetPtr d = make_dataset(p);
  for (const bool binary : {true, false}) {
    WriteOptions o;
    o.binary = binary;
    Context context;
    write_data(temp_folder() + "names.ply", d, o, context);
    const DatasetPtr back = read_file(temp_folder() + "names.ply");
    CHECK(back->fields().size() == d->fields().size());
    for (const Field& f : d->fields()) {
      CAPTURE(f.name);
      const Field* g = back->fields().find(f.name, f.association);
      REQUIRE(g);
      CHECK(g->array.type() == f.array.type());
      CHECK(g->components() == f.components());
      CHECK(g->role == f.role);
      CHECK(g->array.get(0, f.components() - 1) == f.array.get(0, f.components() - 1));
    }
    for (const auto& [key, text] : back->notes()) CHECK(text.find("field") == std::string::npos);
    ReadOptions one;
    one.fields = {"a b"};
    Context c;
    CHECK(std::get<DatasetPtr>(read_data(temp_folder() + "names.ply", one, c))->fields().size() == 1);
  }
  // Comments that do not fit the properties are comments.
  const std::string xyz = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float a\nproperty int b\n";
  for (const char* comment : {"field vertex a 2 ab", "field vertex a 900 ab", "field vertex x 3 ab", "field vertex q 1 ab",
                              "field vertex a 0 ab", "field vertex a -1 ab", "field face a 1 ab", "field vertex a", "field"}) {
    CAPTURE(comment);
    const DatasetPtr plain = read_file(temp_file("c.ply", header("ascii", std::string("comment ") + comment + "\n" + xyz) + "0 0 0 1 2\n"));
    CHECK(plain->fields().find("a"));
    CHECK(plain->fields().find("b"));
    CHECK(!plain->fields().find("ab"));
  }
}
