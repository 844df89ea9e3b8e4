// SPDX-License-Identifier: Apache-2.0
// Small files that ask for much memory: refused before it is taken, with what it would take and the word that allows it.
#include <fmt/core.h>
#include <zlib.h>

#include <cstring>
#include <filesystem>

#include "base/file/file.h"
#include "data/memory/memory_budget.h"
#include "io/bytes/inflate.h"
#include "io/corpus.h"
#include "io/io.h"
#include "memory_cap.h"
#include "support/test.h"

using namespace sg;

namespace {

std::string at(const std::string& name) { return test::temp_folder() + name; }

std::string error_of_file(const std::string& path) {
  Context context;
  const test::OneThread one;
  const test::MemoryCap cap(size_t(1) << 30);
  return test::error_of([&] { read_data(path, {}, context); });
}

bool says(const std::string& error, const std::string& name) {
  INFO(error);
  return error.find(name) != std::string::npos && error.find("--memory") != std::string::npos;
}

std::string gzip_member(const std::string& bytes) {
  const std::vector<std::byte> packed = pack_gzip(std::as_bytes(std::span(bytes)));
  return std::string(reinterpret_cast<const char*>(packed.data()), packed.size());
}

template <class T>
void put(std::string& s, size_t place, T v) {
  std::memcpy(s.data() + place, &v, sizeof v);
}

}  // namespace

TEST_CASE("memory of files: a TIFF of a few hundred bytes with a tile of two gigabytes") {
  if (test::missing("tiff")) return;
  uLongf packed = 200;
  std::string data(packed, '\0');
  const std::string zeros(100, '\0');
  REQUIRE(compress(reinterpret_cast<Bytef*>(data.data()), &packed, reinterpret_cast<const Bytef*>(zeros.data()), 100) == Z_OK);
  data.resize(packed);
  struct Tag {
    uint16_t tag, type;
    uint32_t count, value;
  };
  Tag tags[] = {{256, 4, 1, 300}, {257, 4, 1, 300},   {258, 3, 1, 8},     {259, 3, 1, 8}, {262, 3, 1, 1},
                {277, 3, 1, 1},   {322, 4, 1, 46336}, {323, 4, 1, 46336}, {324, 4, 1, 0}, {325, 4, 1, uint32_t(packed)}};
  tags[8].value = uint32_t(8 + 2 + sizeof tags + 4);
  std::string tiff("II*\0\x08\0\0\0", 8);
  tiff += std::string("\x0a\0", 2) + std::string(reinterpret_cast<const char*>(tags), sizeof tags) + std::string(4, '\0') + data;
  write_file(at("tile.tif"), tiff);
  CHECK(says(error_of_file(at("tile.tif")), "tile.tif"));
}

TEST_CASE("memory of files: a table whose rows have ever other lengths") {
  std::string text;
  for (int i = 0; i < 50000; ++i) text += i ? ",1" : "1";
  for (int i = 0; i < 50000; ++i) text += "\n1";
  write_file(at("ragged.csv"), text);
  const std::string error = error_of_file(at("ragged.csv"));
  CHECK(error.find("ragged.csv") != std::string::npos);
  CHECK(error.find("nearly all of them empty") != std::string::npos);
  write_file(at("one_long_row.csv"), "a,b\n1,2\n" + text.substr(0, 19999) + "\n3,4\n");  // a mistake in a line is no reason
  Context context;
  CHECK(std::get<TablePtr>(read_data(at("one_long_row.csv"), {}, context))->columns.size() == 10000);
}

TEST_CASE("memory of files: a Zarr array of one small chunk") {
  const std::string path = at("one.zarr");
  std::filesystem::create_directories(path);
  write_file(path + "/.zarray", R"({"zarr_format": 2, "shape": [800, 800, 800], "chunks": [16, 16, 16], "dtype": "<f4", "compressor": null,
                                    "order": "C", "fill_value": 0})");
  write_file(path + "/0.0.0", std::string(16384, '\1'));
  CHECK(says(error_of_file(path), "one.zarr"));
}

TEST_CASE("memory of files: a gzipped volume of nothing but zeros, unless its size is allowed") {
  std::string head(352, '\0');
  put<int32_t>(head, 0, 348);
  for (const auto& [place, v] : {std::pair{40, 3}, {42, 1024}, {44, 1024}, {46, 300}, {48, 1}, {50, 1}, {52, 1}, {54, 1}, {70, 2}, {72, 8}})
    put<int16_t>(head, size_t(place), int16_t(v));
  for (size_t k = 0; k < 8; ++k) put<float>(head, 76 + 4 * k, 1);
  put<float>(head, 108, 352);
  head.replace(344, 4, std::string("n+1\0", 4));
  std::string packed = gzip_member(head);
  const std::string mebibyte = gzip_member(std::string(1 << 20, '\0'));
  for (int i = 0; i < 300; ++i) packed += mebibyte;
  write_file(at("zeros.nii.gz"), packed);
  CHECK(MappedFile(at("zeros.nii.gz")).size() < size_t(400) << 10);
  CHECK(says(error_of_file(at("zeros.nii.gz")), "zeros.nii.gz"));
  Context context;
  set_memory_limit(size_t(1) << 30);
  const Data data = read_data(at("zeros.nii.gz"), {}, context);
  set_memory_limit(0);
  CHECK(std::get<DatasetPtr>(data)->point_count() == size_t(300) << 20);
}

TEST_CASE("memory of files: one array that is named a hundred times counts a hundred times") {
  const size_t n = size_t(4) << 20;  // numbers of each
  const std::string zeros(n * 4, '\0');
  uLongf packed = compressBound(zeros.size());
  std::string data(packed, '\0');
  REQUIRE(compress(reinterpret_cast<Bytef*>(data.data()), &packed, reinterpret_cast<const Bytef*>(zeros.data()), zeros.size()) == Z_OK);
  data.resize(packed);
  const uint64_t sizes[] = {1, zeros.size(), 0, packed};
  std::string text =
      "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">"
      "<ImageData WholeExtent=\"0 255 0 255 0 63\"><Piece Extent=\"0 255 0 255 0 63\"><PointData>";
  for (int i = 0; i < 100; ++i) text += fmt::format("<DataArray type=\"Float32\" Name=\"f{}\" format=\"appended\" offset=\"0\"/>", i);
  text += "</PointData></Piece></ImageData><AppendedData encoding=\"raw\">_" +
          std::string(reinterpret_cast<const char*>(sizes), sizeof sizes) + data + "</AppendedData></VTKFile>";
  write_file(at("hundred.vti"), text);
  CHECK(says(error_of_file(at("hundred.vti")), "hundred.vti"));
}

TEST_CASE("memory of files: a few small files that name each other a million times") {
  write_file(at("leaf.stl"),
             "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n");
  std::string named = "leaf.stl";
  for (int level = 0; level < 4; ++level) {
    std::string text = "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\"><vtkMultiBlockDataSet>";
    for (int i = 0; i < 31; ++i) text += fmt::format("<DataSet index=\"{}\" file=\"{}\"/>", i, named);
    named = fmt::format("level{}.vtm", level);
    write_file(at(named), text + "</vtkMultiBlockDataSet></VTKFile>");
  }
  const std::string error = error_of_file(at(named));
  CHECK(error.find("named repeatedly") != std::string::npos);
  CHECK(error.find(named) != std::string::npos);
}
