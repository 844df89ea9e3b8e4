// SPDX-License-Identifier: Apache-2.0
// Strings in legacy VTK files: categories of points and cells, notes of the whole dataset.
#include <fmt/core.h>

#include "io/io_files.h"

using namespace sg;
using namespace test;

namespace {

const std::string four_points = "DATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 1 1 0 0 1 0\nPOLYGONS 2 8\n3 0 1 2\n3 0 2 3\n";
const std::string text_head = "# vtk DataFile Version 4.0\nstrings\nASCII\n";

std::string note_named(const DatasetPtr& d, const std::string& name) {
  for (const auto& [key, text] : d->notes())
    if (key == name) return text;
  return "none";
}

}  // namespace

TEST_CASE("vtk legacy: words of points and cells are categories with names, those of the whole a note") {
  const std::string text = text_head + four_points +
                           "FIELD FieldData 2\nauthor 1 2 string\nA%20B\n\nsizes 1 1 int\n7\n"
                           "POINT_DATA 4\nFIELD FieldData 2\nsite 1 4 string\ntin%20mine\n\nlead\ntin%20mine\nT 1 4 float\n1 2 3 4\n"
                           "CELL_DATA 2\nPEDIGREE_IDS who utf8_string\nb\na\n";
  const DatasetPtr d = read_text("s.vtk", text);
  const Field& site = d->fields().require("site", Association::point);
  CHECK(site.role == Role::labels);
  CHECK(site.array.type() == ElementType::i32);
  CHECK(site.array.get(0) == 2);
  CHECK(site.array.get(1) == 0);
  CHECK(site.array.get(2) == 1);
  CHECK(note_named(d, "labels of site") == "0=\n1=lead\n2=tin mine");
  CHECK(d->fields().require("T").array.get(3) == 4);
  CHECK(d->fields().require("who", Association::cell).array.get(0) == 1);
  CHECK(note_named(d, "author") == "A B\n");
  CHECK(d->fields().require("sizes", Association::whole).array.get(0) == 7);
  check_names_alone(temp_file("s.vtk", text));
  ReadOptions one;
  one.fields = {"T"};
  CHECK(read_text("s.vtk", text, one)->fields().names() == std::vector<std::string>{"T"});
}

TEST_CASE("vtk legacy: strings in binary files, with metadata behind them") {
  std::string bytes = "# vtk DataFile Version 4.0\nstrings\nBINARY\nDATASET POLYDATA\nPOINTS 2 float\n";
  for (const float v : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f}) put_bytes(bytes, v, true);
  bytes += "\nPOINT_DATA 2\nFIELD FieldData 2\nword 1 2 string\n";
  bytes += std::string("\xc2no", 3) + std::string("\x80\x03yes", 5);  // lengths of one and of two bytes
  bytes += "\nMETADATA\nINFORMATION 0\n\nT 1 2 float\n";
  for (const float v : {3.f, 4.f}) put_bytes(bytes, v, true);
  const DatasetPtr d = read_text("b.vtk", bytes + "\n");
  CHECK(note_named(d, "labels of word") == "0=no\n1=yes");
  CHECK(d->fields().require("T").array.get(1) == 4);
  CHECK(cut_and_damage("b.vtk", bytes) > 50);
}

TEST_CASE("vtk legacy: strings that fit no points, are too many, or end too early") {
  const std::string points = text_head + four_points + "POINT_DATA 4\nFIELD f 1\n";
  CHECK(note_named(read_text("s.vtk", points + "w 1 2 string\na\nb\n"), "w") == "a\nb");
  CHECK_FALSE(read_text("s.vtk", points + "w 2 4 string\n1\n2\n3\n4\n5\n6\n7\n8\n")->fields().find("w"));
  CHECK(contains(refusal("s.vtk", points + "w 1 4000000000 string\na\n"), "4000000000 strings"));
  CHECK(contains(refusal("s.vtk", points + "w 4294967296 4294967296 string\na\n"), "more strings than the file can hold"));
  CHECK(contains(refusal("s.vtk", points + "w 1 4 string\na long one\nb\n"), "ends after 2 of 4 strings"));
  std::string many = text_head + "DATASET POLYDATA\nPOINTS 5000 float\n";
  for (int i = 0; i < 5000; ++i) many += "0 0 0\n";
  many += "POINT_DATA 5000\nFIELD f 1\nw 1 5000 string\n";
  for (int i = 0; i < 5000; ++i) many += fmt::format("w{}\n", i);
  CHECK(read_text("s.vtk", many)->fields().empty());
}
