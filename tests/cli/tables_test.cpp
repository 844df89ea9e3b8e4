// SPDX-License-Identifier: Apache-2.0
// Tables and files of colours where meshes are expected, and colours of a file in a picture.
#include "base/file/file.h"
#include "cli/program.h"
#include "image/codec.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::fresh_folder;
using test::sightglass;

TEST_CASE("render: a table is refused with the filter that makes points of it") {
  const std::string f = fresh_folder("tables");
  write_file(f + "t.csv", "name,mass,age\na,1,2\nb,3,4\n");
  for (const std::vector<std::string>& args : {std::vector<std::string>{"render", "t.csv", "-o", "t.png"},
                                               {"render", "t.csv", "--show", "points", "-o", "t.png"},
                                               {"render", "t.csv", "-f", "faces", "-o", "t.png"}}) {
    const auto r = sightglass(args, f);
    INFO(r.err);
    CHECK(r.status == 2);
    CHECK(contains(r.err, "table"));
  }
  CHECK(contains(sightglass({"render", "t.csv", "-o", "t.png"}, f).err, "table_to_points x='mass' y='age'"));
  CHECK(sightglass({"render", "t.csv", "-f", "table_to_points x='mass' y='age'", "-o", "t.png", "-q"}, f).status == 0);
  write_file(f + "g.gml", "graph [ node [ id 1 ] edge [ source 1 target 1 ] ]");
  CHECK(contains(sightglass({"render", "g.gml", "-o", "g.png"}, f).err, "tables (nodes, edges)"));
}

TEST_CASE("demo: tables and colour maps in a folder are passed over with a word, each file once") {
  const std::string f = fresh_folder("mixed");
  write_file(f + "t.csv", "mass,age\n1,2\n3,4\n");
  write_file(f + "rows.json", "[{\"a\":1},{\"a\":2}]");
  write_file(f + "map.json", "{\"R\":[0,255],\"G\":[0,255],\"B\":[0,255]}");
  write_file(f + "map.cpt", "0 red 1 blue\n");
  write_file(f + "g.gml", "graph [ node [ id 1 ] ]");
  write_file(f + "broken.gltf", "{");
  write_file(f + "s.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const auto r = sightglass({"demo", f, "--sheet", "sheet.png"}, fresh_folder("sheet"));
  INFO(r.out << r.err);
  CHECK(r.status == 0);
  CHECK(contains(r.out, "t.csv: skipped: a table"));
  CHECK(contains(r.out, "rows.json: skipped: a table"));
  CHECK(contains(r.out, "map.json: skipped: colour maps (1)"));
  CHECK(contains(r.out, "g.gml: skipped"));
  CHECK(contains(r.out, "broken.gltf: refused"));
  CHECK(contains(r.out, "6 files, 1 refused, 4 skipped"));
}

TEST_CASE("colour maps of files: in a picture, its recipe, and the listing") {
  const std::string f = fresh_folder("maps");
  write_file(f + "two.cpt", "0 255/0/0 1 255/0/0\n");
  const auto r =
      sightglass({"render", "-s", "gyroid size=8", "--show", "surface lit=false map=two.cpt", "-o", "a.png", "-q", "--size", "160x120"}, f);
  INFO(r.err);
  REQUIRE(r.status == 0);
  const Image a = read_png(f + "a.png");
  size_t red = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) red += a.at(x, y)[0] > 240 && a.at(x, y)[1] < 15 && a.at(x, y)[2] < 15;
  CHECK(red > 1000);
  CHECK(sightglass({"open", "a.png", "-o", "b.png", "-q"}, f).status == 0);
  CHECK(sightglass({"colormap", "two.cpt"}, f).out.find("1 entries in RGB") != std::string::npos);
  const auto bad = sightglass({"render", "-s", "gyroid size=8", "--map", "none.cpt", "-o", "c.png"}, f);
  CHECK(bad.status != 0);
  CHECK(contains(bad.err, "none.cpt"));
}

TEST_CASE("convert: sets of sides are left out, with a word, where one mesh is to be written, and kept where parts are") {
  const std::string f = fresh_folder("sets");
  for (const auto& [name, size] : {std::pair("block", "3"), std::pair("set", "2")})
    REQUIRE(sightglass({"convert", "-s", std::string("gyroid size=") + size, "-o", std::string(name) + ".vti", "-q"}, f).status == 0);
  const auto group = [](const std::string& name, const std::string& file) {
    return "<Block name=\"" + name + "\"><DataSet name=\"one\" file=\"" + file + "\"/></Block>";
  };
  write_file(f + "both.vtm", "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\"><vtkMultiBlockDataSet>" +
                                 group("Element Blocks", "block.vti") + group("Side Sets", "set.vti") +
                                 "</vtkMultiBlockDataSet></VTKFile>");
  const auto line = sightglass({"convert", "both.vtm", "-f", "probe_at from=-1,0,0 to=1,0,0 count=5", "-o", "line.csv"}, f);
  INFO(line.err);
  CHECK(line.status == 0);
  CHECK(contains(line.err, "sets of sides and nodes"));
  const auto one = sightglass({"convert", "both.vtm", "-o", "one.vti"}, f);
  CHECK(one.status == 0);
  CHECK(contains(sightglass({"info", "one.vti"}, f).out, "27 points"));
  const auto parts = sightglass({"convert", "both.vtm", "-o", "all.vtm"}, f);
  CHECK(parts.status == 0);
  CHECK_FALSE(contains(parts.err, "sets of sides"));
  CHECK(contains(sightglass({"info", "all.vtm"}, f).out, "8 points"));
}
