// SPDX-License-Identifier: Apache-2.0
// Damaged HDF5 files: read or refused, never a crash. What the library itself cannot stand is kept from it (see h5_data.h, guarded.h).
#include <fmt/core.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>

#include "base/file/file.h"
#include "samples.h"

using namespace sg;
using test::contains;
using test::H5Sample;

namespace {

// Read or refused by an Error(data); true when refused.
bool refused(const std::string& path) {
  try {
    test::read_any(path);
  } catch (const Error& e) {
    CHECK((e.kind() == ErrorKind::data || e.kind() == ErrorKind::usage));
    return true;
  }
  return false;
}

// One partition with packed points and fields; the type is a fixed string or one in the global heap.
std::string sample(bool variable_length) {
  H5Sample h("damage_source.vtkhdf");
  h.vtkhdf("/VTKHDF", "UnstructuredGrid", variable_length);
  h.data<int64_t>("/VTKHDF/NumberOfPoints", {4});
  h.data<int64_t>("/VTKHDF/NumberOfCells", {1});
  h.data<int64_t>("/VTKHDF/NumberOfConnectivityIds", {4});
  h.data<double>("/VTKHDF/Points", {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, {4, 3}, {{2, 3}, true, true, true});
  h.data<int64_t>("/VTKHDF/Connectivity", {0, 1, 2, 3});
  h.data<int64_t>("/VTKHDF/Offsets", {0, 4}, {}, {{1}});
  h.data<uint8_t>("/VTKHDF/Types", {10});
  h.group("/VTKHDF/PointData");
  h.data<float>("/VTKHDF/PointData/p", {1, 2, 3, 4});
  h.close();
  return test::bytes_of(h.path);
}

}  // namespace

TEST_CASE("hdf5: a file cut anywhere is refused") {
  const std::string whole = sample(false);
  for (size_t k = 1; k < 64; ++k) CHECK(refused(test::temp_file("cut.vtkhdf", std::string_view(whole).substr(0, whole.size() * k / 64))));
}

TEST_CASE("hdf5: a file with any byte of its head changed, or any 1/64th, is read or refused") {
  for (const bool variable_length : {false, true}) {
    const std::string whole = sample(variable_length);
    std::vector<size_t> places;
    for (size_t i = 0; i < 200; i += variable_length ? 5 : 1) places.push_back(i);  // texts in the heap cost a process each
    for (size_t k = 0; k < 64; ++k) places.push_back(whole.size() * k / 64);
    int bad = 0;
    for (const size_t at : places)
      for (const char with : {'\xff', '\0', char(whole[at] ^ 1)}) {
        std::string damaged = whole;
        damaged[at] = with;
        bad += refused(test::temp_file("damaged.vtkhdf", damaged));
      }
    CHECK(bad > 30);
  }
}

TEST_CASE("hdf5: lengths in the global heap that lead out of the file are refused") {
  const std::string whole = sample(true);
  const size_t heap = whole.find("GCOL");
  REQUIRE(heap != std::string::npos);
  REQUIRE(!refused(test::temp_file("heap.vtkhdf", whole)));
  for (size_t i = 9; i < 32; i += 5) {
    std::string damaged = whole;
    damaged[heap + i] = char(damaged[heap + i] ^ 0x7f);
    refused(test::temp_file("heap.vtkhdf", damaged));
  }
  std::string damaged = whole;
  damaged[heap + 16 + 8 + 4] = 0x7f;  // the length of the first object
  CHECK(refused(test::temp_file("heap.vtkhdf", damaged)));
}

TEST_CASE("hdf5: more numbers than the file can back are refused before memory is asked for") {
  H5Sample h("huge.vtkhdf");
  h.vtkhdf("/VTKHDF", "ImageData");
  const int64_t n = 1 << 13;
  h.numbers<int64_t>("/VTKHDF", "WholeExtent", {0, n - 1, 0, n - 1, 0, n - 1});
  h.group("/VTKHDF/PointData");
  h.data<double>("/VTKHDF/PointData/p", {}, {hsize_t(n), hsize_t(n), hsize_t(n)}, {{1, 64, 64}, true});  // no chunk was ever written
  h.close();
  CHECK(contains(test::error_of([&] { test::read_any(h.path); }), "more than its stored data can give"));
}

TEST_CASE("hdf5: counts and offsets that do not fit are refused by name") {
  const auto with = [&](auto change) {
    H5Sample h("counts.vtkhdf");
    h.vtkhdf("/VTKHDF", "UnstructuredGrid");
    std::vector<int64_t> points{3}, cells{1}, ids{3}, offsets{0, 3};
    change(points, cells, ids, offsets);
    h.data("/VTKHDF/NumberOfPoints", points), h.data("/VTKHDF/NumberOfCells", cells), h.data("/VTKHDF/NumberOfConnectivityIds", ids);
    h.data<float>("/VTKHDF/Points", {0, 0, 0, 1, 0, 0, 0, 1, 0}, {3, 3});
    h.data<int64_t>("/VTKHDF/Connectivity", {0, 1, 2});
    h.data("/VTKHDF/Offsets", offsets);
    h.data<uint8_t>("/VTKHDF/Types", {5});
    h.close();
    return test::error_of([&] { test::read_any(h.path); });
  };
  using L = std::vector<int64_t>&;
  CHECK(contains(with([](L p, L, L, L) { p = {-1}; }), "'/VTKHDF/NumberOfPoints': holds the count -1"));
  CHECK(contains(with([](L p, L, L, L) { p = {1 << 30}; }), "'/VTKHDF/Points': has 3 rows"));
  CHECK(contains(with([](L p, L, L, L) { p = {INT64_MAX}; }), "holds the count"));
  CHECK(contains(with([](L, L c, L, L) { c = {7}; }), "'/VTKHDF/Offsets': has 2 rows"));
  CHECK(contains(with([](L, L, L i, L) { i = {2}; }), "need more than 2 point ids"));
  CHECK(contains(with([](L, L, L, L o) { o = {0, -3}; }), "the offsets of cells decrease"));
  CHECK(contains(with([](L, L, L, L o) { o = {1, 3}; }), "begin at 1, not 0"));
}

TEST_CASE("hdf5: layouts of every kind hold the same numbers") {
  // Read through XDMF, which takes any array: user block, both byte orders, chunks with every filter, holes, blocks.
  H5Sample h("layouts.h5", 512);
  std::vector<double> v(5 * 6 * 7);
  for (size_t i = 0; i < v.size(); ++i) v[i] = std::floor(1000 * std::sin(double(i)));
  h.data("/plain", v, {5, 6, 7});
  h.data("/big", v, {5, 6, 7}, {{}, false, false, false, H5T_IEEE_F64BE});
  h.data("/short", v, {5, 6, 7}, {{2, 3, 4}, true, true, false, H5T_STD_I16BE});
  h.data("/checked", v, {5, 6, 7}, {{2, 6, 3}, true, true, true});
  h.data("/bare", v, {5, 6, 7}, {{3, 4, 5}});
  h.data<double>("/holes", {}, {5, 6, 7}, {{3, 4, 5}});
  h.close();
  const auto read = [&](const std::string& item) {
    return test::read_text("layouts.xdmf",
                           "<Xdmf><Domain><Grid><Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"2 2 2\"/><Geometry "
                           "GeometryType=\"ORIGIN_DXDYDZ\"><DataItem Dimensions=\"3\">0 0 0</DataItem><DataItem "
                           "Dimensions=\"3\">1 1 1</DataItem></Geometry><Attribute Name=\"a\" Center=\"Grid\">" +
                               item + "</Attribute></Grid></Domain></Xdmf>")
        ->fields()
        .require("a")
        .array;
  };
  for (const char* name : {"plain", "big", "short", "checked", "bare", "holes"}) {
    CAPTURE(std::string(name));
    const std::string whole = fmt::format("<DataItem Format=\"HDF\" Dimensions=\"5 6 7\">layouts.h5:/{}</DataItem>", name);
    const Array all = read(whole);
    REQUIRE(all.count() == v.size());
    const bool zero = std::string_view(name) == "holes";
    for (size_t i = 0; i < v.size(); ++i) CHECK(all.get(i) == (zero ? 0 : v[i]));
    const Array part =
        read("<DataItem ItemType=\"HyperSlab\" Dimensions=\"2 2 3\"><DataItem Dimensions=\"3 3\">1 2 0 3 2 3 2 2 3</DataItem>" + whole +
             "</DataItem>");
    REQUIRE(part.count() == 12);
    for (size_t i = 0; i < 12; ++i) {
      const size_t x = i % 3 * 3, y = 2 + i / 3 % 2 * 2, z = 1 + i / 6 * 3;
      CHECK(part.get(i) == (zero ? 0 : v[x + 7 * (y + 6 * z)]));
    }
  }
}

TEST_CASE("hdf5: groups that hold themselves by links are refused, or end") {
  for (const bool hard : {false, true}) {
    H5Sample h("circle.vtkhdf");
    h.vtkhdf("/VTKHDF", "MultiBlockDataSet");
    h.group("/VTKHDF/Assembly");
    if (hard) REQUIRE(H5Lcreate_hard(h.id(), "/VTKHDF/Assembly", h.id(), "/VTKHDF/Assembly/again", H5P_DEFAULT, H5P_DEFAULT) >= 0);
    else H5Lcreate_soft("/VTKHDF/Assembly", h.id(), "/VTKHDF/Assembly/again", H5P_DEFAULT, H5P_DEFAULT);
    h.close();
    if (hard) CHECK(contains(test::error_of([&] { test::read_any(h.path); }), "nests blocks too deeply"));
    else refused(h.path);  // the library follows 16 soft links, then there is no such group
  }
  H5Sample h("soft.vtkhdf");
  H5Lcreate_soft("/b", h.id(), "/VTKHDF", H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_soft("/VTKHDF", h.id(), "/b", H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_external("soft.vtkhdf", "/c", h.id(), "/c", H5P_DEFAULT, H5P_DEFAULT);
  h.close();
  CHECK(refused(h.path));
}

TEST_CASE("hdf5: a header that the library does not survive is met by a child process") {
  const std::string whole = sample(false);
  size_t places = 0;
  for (size_t at = 0; at + 10 < whole.size(); ++at) {
    // A message of a chunked layout, version 3: version 2 has its fields elsewhere, and HDF5 1.10 falls over one of the two here.
    if (whole.compare(at, 2, std::string("\x08\0", 2)) != 0 || whole.compare(at + 8, 2, "\x03\x02") != 0) continue;
    ++places;
    std::string damaged = whole;
    damaged[at + 8] = 2;
    CHECK(refused(test::temp_file("layout.vtkhdf", damaged)));
  }
  CHECK(places == 2);
}

TEST_CASE("hdf5: external links lead below the folder of the file or the working folder, to files, and nowhere else") {
  const std::string inside = test::temp_folder() + "elinks/";
  std::filesystem::create_directories(inside);
  const auto linked = [&](const std::string& to) {
    H5Sample h("elinks/here.vtkhdf");
    H5Lcreate_external(to.c_str(), "/VTKHDF", h.id(), "/VTKHDF", H5P_DEFAULT, H5P_DEFAULT);
    h.close();
    try {
      test::read_any(h.path);
      return true;
    } catch (const Error&) {
      return false;
    }
  };
  const std::string grid = sample(false);
  for (const char* name : {"elinks_outside.vtkhdf", "elinks/inside.vtkhdf"}) sg::write_file(test::temp_folder() + name, grid);
  CHECK(linked("inside.vtkhdf"));
  CHECK_FALSE(linked("../elinks_outside.vtkhdf"));
  CHECK_FALSE(linked(test::temp_folder() + "elinks_outside.vtkhdf"));
  ::setenv("SIGHTGLASS_READ_ANYWHERE", "1", 1);
  CHECK(linked("../elinks_outside.vtkhdf"));
  ::unsetenv("SIGHTGLASS_READ_ANYWHERE");
  REQUIRE(::mkfifo((inside + "pipe").c_str(), 0600) == 0);
  CHECK_FALSE(linked("pipe"));
}
