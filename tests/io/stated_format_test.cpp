// SPDX-License-Identifier: Apache-2.0
// Files whose name says nothing about their format: recognized by content, or stated.
#include "io/stated_format.h"

#include "io/io_files.h"
#include "io/options.h"

using namespace sg;
using test::contains;

namespace {

const std::string obj = "# a triangle\no one\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string stl =
    "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid one\n";

std::string found(std::string_view text) {
  const Format* f = recognized({reinterpret_cast<const std::byte*>(text.data()), text.size()});
  return f ? std::string(f->name) : "";
}

ReadOptions stated(const std::string& format) {
  ReadOptions o;
  o.format = format;
  return o;
}

}  // namespace

TEST_CASE("formats without a name: OBJ, STL, tables of cells and JSON are recognized by their content") {
  CHECK(test::read_text("unnamed", obj)->cell_count() == 1);
  CHECK(test::read_text("unnamed", stl)->point_count() == 3);
  const auto columns = [](std::string_view text) { return std::get<TablePtr>(test::read_bytes("unnamed", text))->columns; };
  CHECK(columns("a,b\n1,2\n3,4\n").at(1).array.get(1) == 4);
  CHECK(columns("a\tb\tc\n1\t2\t\n").size() == 3);
  CHECK(columns("\"a,b\";c\r\n1;2\r\n").at(0).name == "a,b");
  CHECK(columns(R"([{"a": 1}, {"a": 5}])").at(0).array.get(1) == 5);
  std::string binary(80, 'x');
  binary += std::string("\1\0\0\0", 4) + std::string(50, '\0');
  CHECK(found(binary) == "STL");
  CHECK(found(R"({"asset": {"version": "2.0"}, "scenes": []})") == "glTF");
}

TEST_CASE("formats without a name: other texts are not taken for one of them") {
  for (const char* other : {"", "hello", "One, two.\nThree, four.\n", "1 2 3\n4 5 6\n", "v\n", "v 1 2\nf 1 2 3\n", "v 0 0 0\nhello\n",
                            "solid as a rock\n", "{", "[1", "{hello}", "a,b\n1,2,3\n", "graph [\n node [ id 1 ]\n]\n"}) {
    CAPTURE(other);
    CHECK(found(other).empty());
  }
  CHECK(found(std::string("a,b\n1,2\n\0", 9)).empty());
  // A long text is judged by its first lines, of which the last is cut.
  std::string rows = "a,b\n";
  while (rows.size() < 40000) rows += "1,2\n";
  CHECK(found(rows) == "delimited text");
  const std::string error = test::refusal("unnamed", "hello");
  CHECK(contains(error, "unknown format"));
  CHECK(contains(error, "--input-format"));
}

TEST_CASE("format=NAME: reads a file of another suffix, and what does not suit it is refused by name") {
  CHECK(test::read_text("a.txt", obj, stated("obj"))->cell_count() == 1);
  CHECK(test::read_text("a.ply", stl, stated(".STL"))->cell_count() == 1);
  CHECK(std::get<TablePtr>(test::read_bytes("a.obj", "x y\nu v\n", stated("Delimited Text")))->columns.size() == 2);
  const std::string wrong = test::refusal("a.bin", obj, stated("ply"));
  CHECK(contains(wrong, "stated to be PLY"));
  CHECK(contains(wrong, "looks like OBJ"));
  CHECK(contains(wrong, "--input-format obj"));
  CHECK(contains(test::refusal("a.ply", obj), "looks like OBJ"));
  CHECK(contains(test::error_of([] { check(stated("objj")); }), "'obj'"));
  for (const char* known : {"nii.gz", "AMReX plotfile", ""}) CHECK_NOTHROW(check(stated(known)));
  CHECK(contains(test::error_of([] { test::read_any(test::empty_folder("a_folder"), stated("obj")); }), "folder"));
}

TEST_CASE("format=NAME: each file of a series is read so") {
  test::temp_file("step_1.dat", obj), test::temp_file("step_2.dat", obj);
  const std::string series = test::temp_folder() + "step_{n}.dat";
  CHECK(test::read_file(series, stated("obj"))->cell_count() == 1);
  Context context;
  CHECK(file_times(series, stated("obj"), context) == std::vector<double>{0, 1});
}
