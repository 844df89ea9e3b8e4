// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "io/io_files.h"

using namespace sg;
using namespace sg::test;

namespace {

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

}  // namespace

TEST_CASE("obj: faces, lines and points with absolute and relative indices") {
  const auto d =
      read_text("a.obj", "# a remark\n" + square + "f 1 2 3 4\nf -4 -3 \\\n -2\nl 1 2 3\np 4\nv 5 5 5 1.0\nf 1 -1 2 # the last one\n");
  CHECK(d->point_count() == 5);
  const SurfaceMesh& s = surface_of(d);
  REQUIRE(s.polygons.size() == 3);
  const CellsView v = cells_view(s.polygons);
  CHECK(v.size(0) == 4);
  CHECK(v.size(1) == 3);
  CHECK(v.point(1, 0) == 0);
  CHECK(v.point(2, 1) == 4);
  CHECK(s.lines.size() == 1);
  CHECK(cells_view(s.lines).size(0) == 3);
  CHECK(s.vertices.size() == 1);
  CHECK(cells_view(s.vertices).point(0, 0) == 3);
}

TEST_CASE("obj: corners become points where their texture or normal is not their vertex's own") {
  const std::string t = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n", n = "vn 0 0 1\nvn 1 0 0\n";
  auto d = read_text("t.obj", square + t + "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
  CHECK(d->point_count() == 4);
  CHECK(d->fields().require("TCoords").array.get(3, 1) == 1);
  d = read_text("t.obj", square + t + n + "f 1/4/1 2/3/1 3/2/1\nf 1/4/2 3/2/2 4//2\n");
  CHECK(d->point_count() == 6);
  CHECK(d->cell_count() == 2);
  CHECK(d->fields().require("TCoords").array.get(0, 1) == 1);
  CHECK(std::isnan(d->fields().require("TCoords").array.get(5, 0)));
  CHECK(d->fields().require("Normals").array.get(5, 0) == 1);
  CHECK(d->bounds().hi == Vec3(1, 1, 0));
  // The last corner alone has a normal of another number.
  d = read_text("t.obj", square + n + "f 1//1 2//2 3//2\n");
  CHECK(d->point_count() == 3);
  // Texture coordinates that no face names are not there.
  CHECK(read_text("t.obj", square + t + "f 1 2 3\n")->fields().find("TCoords") == nullptr);
}

TEST_CASE("obj: groups and materials become cell fields, and their names notes") {
  const auto d =
      read_text("g.obj", "mtllib m.mtl\n" + square +
                             "f 1 2 3\ng one\nusemtl red\nf 1 2 4\nl 1 2\ng two\nf 2 3 4\nusemtl blue\nf 1 3 4\nusemtl red\nf 1 2 3 4\n");
  const Array &g = d->fields().require("GroupIds", Association::cell).array,
              &m = d->fields().require("MaterialIds", Association::cell).array;
  REQUIRE(g.count() == 6);
  const double groups[] = {1, 0, 1, 2, 2, 2};  // the line first, as cells are numbered
  const double materials[] = {0, 1, 0, 0, 2, 0};
  for (size_t i = 0; i < 6; ++i) {
    CHECK(g.get(i) == groups[i]);
    CHECK(m.get(i) == materials[i]);
  }
  CHECK(d->fields().active(1)->name == "MaterialIds");
  CHECK(read_text("g.obj", square + "g a\nf 1 2 3\n")->fields().active(1) == nullptr);
  std::string text;
  for (const auto& [key, value] : d->notes()) text += key + "=" + value + ";";
  CHECK(text == "MaterialLibrary=m.mtl;MaterialNames=0 red\n2 blue;labels of MaterialIds=0=red\n2=blue;GroupNames=0 \n1 one\n2 two;");
}

TEST_CASE("obj: materials have the diffuse colours of their library, which lies below the file's folder") {
  const std::string cells = square + "usemtl red\nf 1 2 3\nusemtl my grey\nf 1 2 4\nusemtl unknown\nf 2 3 4\n";
  write_file(temp_folder() + "m.mtl",
             "newmtl red\nKa 1 1 1\nKd 1 0.25 0 # dark\nd 1\n\nnewmtl my grey\nKd 0.5\nKd spectral x.rfl\nnewmtl odd\nKd a b c\n");
  const auto d = read_text("g.obj", "mtllib m.mtl\n" + cells);
  const Field& c = d->fields().require("MaterialColors", Association::cell);
  CHECK(c.role == Role::colors);
  const int rgb[3][3] = {{255, 64, 0}, {128, 128, 128}, {204, 204, 204}};
  for (size_t i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) CHECK(c.array.get(i, k) == rgb[i][k]);
  CHECK(!read_text("g.obj", "mtllib missing.mtl\n" + cells)->fields().find("MaterialColors"));
  CHECK(!read_text("g.obj", "mtllib ../../../etc/m.mtl\n" + cells)->fields().find("MaterialColors"));
  CHECK(!read_text("g.obj", "mtllib m.mtl\n" + square + "f 1 2 3\n")->fields().find("MaterialColors"));
}

TEST_CASE("obj: vertex colours") {
  const auto d = read_text("c.obj", "v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0 0 0 1\nf 1 2 3\n");
  const Field& c = d->fields().require("RGB");
  CHECK(c.role == Role::colors);
  CHECK(c.array.get(0, 1) == 128);
  CHECK(c.array.get(1, 0) == 255);  // none given: white
  CHECK(c.array.get(2, 2) == 255);
}

TEST_CASE("obj: a file of many chunks is the same for 1 and 4 threads, and comes back from writing") {
  const int n = 160;
  std::string text;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      // Vertices and faces alternate, so relative indices cross the chunks' borders.
      text += fmt::format("v {} {} {}\nvt {} {}\n", i * 0.1, j * 0.3, (i * j) % 7, i, j);
      const int a = j * n + i + 1;
      if (i > 0 && j > 0)
        text += (i + j) % 2 ? fmt::format("f {0}/{0} {1}/{1} {2}/{2}\n", a, a - 1, a - n)
                            : fmt::format("f -1/-1 -2/-2 {0}/{0} {1}/{1}\n", -n - 2, -n - 1);
      if (a % 1000 == 0) text += fmt::format("g part{}\nusemtl m{}\n", a, a % 3000);
    }
  const std::string path = temp_file("big.obj", text);
  const auto one = with_threads(1, [&] { return read_file(path); });
  const auto four = with_threads(4, [&] { return read_file(path); });
  CHECK(text.size() > (1 << 20));
  CHECK(one->point_count() == size_t(n * n));
  CHECK(one->cell_count() == size_t((n - 1) * (n - 1)));
  auto same = [](const DatasetPtr& a, const DatasetPtr& b) {
    CHECK(same_array(surface_of(a).points.xyz, surface_of(b).points.xyz));
    CHECK(same_array(surface_of(a).polygons.connectivity, surface_of(b).polygons.connectivity));
    CHECK(same_array(surface_of(a).polygons.offsets, surface_of(b).polygons.offsets));
    CHECK(same_array(a->fields().require("TCoords").array, b->fields().require("TCoords").array));
  };
  same(one, four);
  CHECK(same_array(one->fields().require("GroupIds").array, four->fields().require("GroupIds").array));
  CHECK(same_array(one->fields().require("MaterialIds").array, four->fields().require("MaterialIds").array));
  const CellsView v = cells_view(surface_of(one).polygons);
  bool right = true;
  for (size_t j = 1, c = 0; j < size_t(n); ++j)
    for (size_t i = 1; i < size_t(n); ++i, ++c)
      right = right && v.point(c, 0) == int64_t(j * size_t(n) + i) && v.size(c) == ((i + j) % 2 ? 3u : 4u);
  CHECK(right);
  Context context;
  write_data(temp_folder() + "back.obj", one, {}, context);
  const auto back = read_file(temp_folder() + "back.obj");
  same(one, back);
  CHECK(same_array(one->fields().require("GroupIds").array, back->fields().require("GroupIds").array));
}

TEST_CASE("obj: bad files are refused with their line") {
  CHECK(contains(refusal("b.obj", square + "f 1 2\n"), "line 5: a face has 2 corners"));
  CHECK(contains(refusal("b.obj", square + "f 1 2 5\n"), "line 5: vertex 5 does not exist"));
  CHECK(contains(refusal("b.obj", square + "f 1 2 3\nf 1 2 -5\n"), "line 6: vertex 0 does not exist"));
  CHECK(contains(refusal("b.obj", square + "f 0 1 2\n"), "line 5: the vertex index is 0"));
  CHECK(contains(refusal("b.obj", square + "f 1 2 x\n"), "line 5: 'x' is not a valid vertex index"));
  CHECK(contains(refusal("b.obj", square + "f 1 2 3.5\n"), "'.5' follows an index"));
  CHECK(contains(refusal("b.obj", square + "f 1 2 99999999999\n"), "out of range"));
  CHECK(contains(refusal("b.obj", square + "vt 0 0\nf 1/1 2/2 3/1\n"), "line 6: texture coordinate 2 does not exist"));
  CHECK(contains(refusal("b.obj", square + "vn 0 0 1\nf 1//1 2//1 3//9\n"), "line 6: normal 9 does not exist"));
  CHECK(contains(refusal("b.obj", square + "l 1\n"), "a line has 1 corner"));
  CHECK(contains(refusal("b.obj", square + "p\n"), "a point has 0 corners"));
  CHECK(contains(refusal("b.obj", "v 1 2\n"), "line 1: a vertex has 2 numbers"));
  CHECK(contains(refusal("b.obj", "v 1 2 nan\n"), "not finite"));
  CHECK(contains(refusal("b.obj", "v 1 2 1.#IND\n"), "'1.#IND' is not a number"));
  CHECK(contains(refusal("b.obj", "v 1 2 3\nvn 1 2\n"), "line 2: a normal needs three numbers"));
  CHECK(contains(refusal("b.obj", "v 1 2 3\nvt\n"), "line 2: a texture coordinate"));
  CHECK(contains(refusal("b.obj", "nothing of use\n"), "no vertices"));
  Context context;
  CHECK(contains(error_of([&] { write_data(temp_folder() + "x.obj", make_dataset(UniformGrid{}), {}, context); }), "-f 'faces'"));
}

TEST_CASE("obj: cut and damaged files give errors or what is left, never crashes") {
  // A cut OBJ file may be a whole one: its format has no end. A cut within a number or a face shows only there.
  std::string text = square + "vt 0 0\nvn 0 0 1\ng a b\nusemtl c\n";
  for (int i = 0; i < 20; ++i) text += "f 1/1/1 2/1/1 -2/-1/-1 4\\\n/1/1\nl 1 2 3\n";
  const int refused = cut_and_damage("cut.obj", text);
  CHECK(refused > 5);
}
