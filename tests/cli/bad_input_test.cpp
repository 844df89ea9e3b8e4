// SPDX-License-Identifier: Apache-2.0
// Every mistake: one clear line, the documented exit code, nothing left behind.
#include <algorithm>
#include <filesystem>
#include <limits>

#include "base/file/file.h"
#include "cli/program.h"
#include "io/io.h"
#include "support/test.h"

using namespace sg;
using test::fresh_folder;
using test::sightglass;

namespace {

void write_grid(const std::string& path, const std::vector<float>& values, std::array<size_t, 3> dims, const std::string& name = "T") {
  UniformGrid g;
  g.dims = dims;
  FieldSet f;
  f.add({name, Association::point, Array::from_vector(values), "", Role::scalars});
  Context context;
  write_data(path, make_dataset(g, f), {}, context);
}

std::vector<float> ramp(size_t n) {
  std::vector<float> v(n);
  for (size_t i = 0; i < n; ++i) v[i] = float(i % 7);
  return v;
}

// One line on stderr, nothing on stdout, nothing written.
void check_refused(const std::vector<std::string>& args, int status, const std::vector<std::string>& words, const std::string& folder) {
  const auto before = test::files_in(folder);
  const auto r = sightglass(args, folder);
  INFO(r.err);
  CHECK(r.status == status);
  CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
  for (const std::string& w : words) {
    INFO("wanted: " << w);
    CHECK(r.err.find(w) != std::string::npos);
  }
  CHECK(test::files_in(folder) == before);
}

}  // namespace

TEST_CASE("bad input: a missing file, a folder, an empty file, an unknown format") {
  const std::string f = fresh_folder("missing");
  check_refused({"render", "nothing.vti"}, 3, {"nothing.vti", "no such file"}, f);
  std::filesystem::create_directories(f + "folder.vti");
  check_refused({"render", "folder.vti"}, 3, {"folder.vti", "is a folder"}, f);
  write_file(f + "empty.vtu", "");
  check_refused({"info", "empty.vtu"}, 3, {"empty.vtu", "is empty"}, f);
  write_file(f + "what.blob", "hello there");
  check_refused({"info", "what.blob"}, 3, {"what.blob", "unknown format", "vti"}, f);
  write_file(f + "text.vti", "hello there");
  check_refused({"info", "text.vti"}, 3, {"text.vti"}, f);
}

TEST_CASE("bad input: truncated header and data") {
  const std::string f = fresh_folder("truncated");
  write_grid(f + "whole.vti", ramp(512), {8, 8, 8});
  const std::string bytes(MappedFile(f + "whole.vti").text());
  write_file(f + "header.vti", bytes.substr(0, 120));
  check_refused({"render", "header.vti", "-o", "x.png"}, 3, {"header.vti"}, f);
  write_file(f + "data.vti", bytes.substr(0, bytes.size() - 900));
  check_refused({"render", "data.vti", "-o", "x.png"}, 3, {"data.vti"}, f);
  write_file(
      f + "legacy.vtk",
      "# vtk DataFile Version 3.0\nx\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 8 8 8\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 512\n"
      "SCALARS T float 1\nLOOKUP_TABLE default\nabcd");
  check_refused({"render", "legacy.vtk", "-o", "x.png"}, 3, {"legacy.vtk"}, f);
}

TEST_CASE("bad input: sizes that overflow or exceed the file") {
  const std::string f = fresh_folder("sizes");
  write_file(f + "huge.vtk",
             "# vtk DataFile Version 3.0\nx\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 4000000000 4000000000 4000000000\nORIGIN 0 0 0\n"
             "SPACING 1 1 1\nPOINT_DATA 8\nSCALARS T float 1\nLOOKUP_TABLE default\nabcd");
  check_refused({"info", "huge.vtk"}, 3, {"huge.vtk"}, f);
  write_file(f + "huge.nrrd",
             "NRRD0004\ntype: float\ndimension: 3\nsizes: 2147483647 2147483647 2147483647\nencoding: raw\nendian: little\n\nabcd");
  check_refused({"info", "huge.nrrd"}, 3, {"huge.nrrd"}, f);
  write_file(f + "small.raw", "abcdefgh");
  check_refused({"info", "small.raw", "--dims", "100,100,100", "--type", "u8"}, 3, {"small.raw", "1000000"}, f);
  check_refused({"info", "small.raw"}, 2, {"small.raw", "--dims"}, f);
}

TEST_CASE("bad input: unknown fields, operations, parameters and ways to show, with the nearest name") {
  const std::string f = fresh_folder("names");
  write_grid(f + "a.vti", ramp(512), {8, 8, 8}, "temperature");
  check_refused({"render", "a.vti", "-f", "contour field=tempe", "-o", "x.png"}, 2, {"tempe", "did you mean 'temperature'"}, f);
  check_refused({"render", "a.vti", "-f", "contuor", "-o", "x.png"}, 2, {"contuor", "did you mean 'contour'"}, f);
  check_refused({"render", "a.vti", "-f", "contour vlaues=1", "-o", "x.png"}, 2, {"vlaues", "did you mean 'values'"}, f);
  check_refused({"render", "a.vti", "-f", "contour values=abc", "-o", "x.png"}, 2, {"abc", "number"}, f);
  check_refused({"render", "a.vti", "--show", "surfcae", "-o", "x.png"}, 2, {"surfcae", "did you mean 'surface'"}, f);
  check_refused({"render", "a.vti", "--field", "pressure", "-o", "x.png"}, 2, {"pressure", "temperature"}, f);
  check_refused({"render", "a.vti", "--map", "viridsi", "-o", "x.png"}, 2, {"viridsi"}, f);
  check_refused({"rendre", "a.vti"}, 2, {"rendre", "did you mean 'render'"}, f);
}

TEST_CASE("bad input: a pipeline file is run, not read") {
  const std::string path = test::temp_folder() + "picture.yaml";
  write_file(path, "sightglass: 1\nsteps: {a: {sphere: {}}}\n");
  const auto r = sightglass({"render", path});
  CHECK(r.status == 2);
  CHECK(test::contains(r.err, "sightglass run"));
}

TEST_CASE("bad input: unreadable options") {
  const std::string f = fresh_folder("options");
  write_grid(f + "a.vti", ramp(512), {8, 8, 8});
  check_refused({"render", "a.vti", "--sise", "100x100"}, 2, {"--sise", "--size"}, f);
  check_refused({"render", "a.vti", "--size", "big", "-o", "x.png"}, 2, {"big", "1280x720"}, f);
  check_refused({"render", "a.vti", "--size", "0x10", "-o", "x.png"}, 2, {"0x10"}, f);
  check_refused({"render", "a.vti", "--camera", "azimut=3", "-o", "x.png"}, 2, {"azimut", "did you mean 'azimuth'"}, f);
  check_refused({"render", "a.vti", "--threads", "many"}, 2, {"many"}, f);
  check_refused({"render", "a.vti", "--background", "purpel", "-o", "x.png"}, 2, {"purpel", "purple"}, f);
  check_refused({"render", "a.vti", "--threads", "-2", "-o", "x.png"}, 2, {"-2", "0 (all cores)"}, f);
  check_refused({"render", "a.vti", "--memory", "1K", "-o", "x.png"}, 2, {"--memory", "1.0 KiB", "--explain"}, f);
  check_refused({"render"}, 2, {"file"}, f);
}

TEST_CASE("bad input: output in a missing folder, with an unknown extension, onto a folder, on a full disk") {
  const std::string f = fresh_folder("output");
  write_grid(f + "a.vti", ramp(512), {8, 8, 8});
  check_refused({"render", "a.vti", "-o", "no/such/x.png"}, 3, {"no/such/x.png", "folder does not exist"}, f);
  check_refused({"render", "a.vti", "-o", "x.xyz"}, 2, {"xyz", "png"}, f);
  std::filesystem::create_directories(f + "x.png");
  check_refused({"render", "a.vti", "-o", "x.png"}, 3, {"x.png", "folder"}, f);
  check_refused({"convert", "a.vti", "-o", "no/such/x.vti"}, 3, {"no/such/x.vti", "folder does not exist"}, f);
  check_refused({"convert", "a.vti", "-o", "x.vtu"}, 2, {"x.vtu", "vti"}, f);
}

TEST_CASE("bad input: a full disk leaves no partial file") {
  const std::string f = fresh_folder("full");
  write_grid(f + "a.vti", ramp(32768), {32, 32, 32});
  const auto before = test::files_in(f);
  for (const auto& args :
       {std::vector<std::string>{"render", "a.vti", "-o", "x.png"}, std::vector<std::string>{"convert", "a.vti", "-o", "x.nrrd"}}) {
    const auto r = sightglass(args, f, 2048);
    INFO(r.err);
    CHECK(r.status == 3);
    CHECK(r.err.find(args[3]) != std::string::npos);
    CHECK(r.err.find("write failed") != std::string::npos);
    CHECK(test::files_in(f) == before);
  }
}

TEST_CASE("odd data: NaN-only, constant and zero-cell inputs give a picture and a note") {
  const std::string f = fresh_folder("odd");
  write_grid(f + "nan.vti", std::vector<float>(512, std::numeric_limits<float>::quiet_NaN()), {8, 8, 8});
  auto r = sightglass({"render", "nan.vti", "-o", "nan.png"}, f);
  INFO(r.err);
  CHECK(r.status == 0);
  CHECK(r.err.find("no finite value") != std::string::npos);
  CHECK(file_exists(f + "nan.png"));

  write_grid(f + "constant.vti", std::vector<float>(512, 3.f), {8, 8, 8});
  r = sightglass({"render", "constant.vti", "-o", "constant.png"}, f);
  CHECK(r.status == 0);
  CHECK(file_exists(f + "constant.png"));
  r = sightglass({"render", "constant.vti", "-f", "contour values=3.5", "-o", "none.png"}, f);
  CHECK(r.status == 0);
  CHECK(r.err.find("empty") != std::string::npos);

  write_file(f + "zero.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 0 float\nCELLS 0 0\nCELL_TYPES 0\n");
  r = sightglass({"render", "zero.vtk", "-o", "zero.png"}, f);
  INFO(r.err);
  CHECK(r.status == 0);
  CHECK(r.err.find("empty") != std::string::npos);
  CHECK(file_exists(f + "zero.png"));
}
