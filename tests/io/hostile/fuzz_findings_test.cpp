// SPDX-License-Identifier: Apache-2.0
// What the fuzzer found, each as a small case.
#include <zlib.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "base/file/file.h"
#include "io/io.h"
#include "io/isolated/isolated.h"
#include "memory_cap.h"
#include "support/test.h"

using namespace sg;

namespace {

std::string error_of_file(const std::string& name, const std::string& bytes) {
  const std::string path = test::temp_folder() + name;
  write_file(path, bytes);
  Context context;
  return test::error_of([&] { read_data(path, {}, context); });
}

}  // namespace

TEST_CASE("tecplot: variables that are named again after a zone are refused") {
  const std::string text = "VARIABLES = \"X\" \"Y\"\nZONE I=2, J=1, F=POINT\n0 0\n1 0\nVARIABLES = \"T\"\n";
  CHECK(error_of_file("twice.tec", text).find("VARIABLES names") != std::string::npos);
}

TEST_CASE("netcdf: a name longer than the library's buffers is refused before the library sees it") {
  auto word = [](uint32_t v) { return std::string{char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; };
  std::string bytes = std::string("CDF\1", 4) + word(0) + word(10) + word(1);  // no records, one dimension
  bytes += word(300) + std::string(300, 'n') + word(4) + word(0) + word(0) + word(0) + word(0);
  const std::string error = error_of_file("long.nc", bytes);
  CHECK((error.find("a name has 300 bytes") != std::string::npos || error.find("not installed") != std::string::npos));
}

TEST_CASE("try in a child: a library that dies is an error of the file, one that throws is not") {
  const std::string path = test::temp_folder() + "x.bin";
  write_file(path, "x");
  CHECK(test::error_of([&] { try_in_child(path, "Test", [] { std::abort(); }); }).find("crashed while reading it") != std::string::npos);
  CHECK(test::error_of([&] { try_in_child(path, "Test", [] { std::raise(SIGSEGV); }); }).find(path) != std::string::npos);
  try_in_child(path, "Test", [] { throw std::runtime_error("said again in the parent"); });
  try_in_child(path, "Test", [] {});
}

TEST_CASE("vtk xml: a single compressed block takes the memory of what it holds, whatever the size of a block is said to be") {
  std::vector<float> values(48);
  for (size_t i = 0; i < values.size(); ++i) values[i] = float(i * i);
  uLongf size = 1000;
  std::string packed(size, '\0');
  REQUIRE(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(values.data()), values.size() * 4) ==
          Z_OK);
  packed.resize(size);
  const uint64_t head[] = {1, uint64_t(1) << 36, values.size() * 4, size};  // blocks, bytes of each, bytes of the last, packed bytes
  const std::string path = test::temp_folder() + "block.vti";
  write_file(
      path,
      "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">"
      "<ImageData WholeExtent=\"0 3 0 3 0 2\"><Piece Extent=\"0 3 0 3 0 2\"><PointData><DataArray type=\"Float32\" Name=\"T\" "
      "format=\"appended\" offset=\"0\"/></PointData></Piece></ImageData><AppendedData encoding=\"raw\">_" +
          std::string(reinterpret_cast<const char*>(head), sizeof head) + packed + "</AppendedData></VTKFile>");
  const test::OneThread one;
  const test::MemoryCap cap(size_t(256) << 20);
  Context context;
  ReadOptions part;
  part.region.lo = {1, 0, 1}, part.region.hi = {2, 3, 1};
  for (const bool whole : {true, false}) {
    const Data data = read_data(path, whole ? ReadOptions{} : part, context);
    const Array a = std::get<DatasetPtr>(data)->fields().require("T").array;
    REQUIRE(a.count() == (whole ? 48 : 8));
    CHECK(a.get(1) == (whole ? 1 : 18 * 18));
  }
}
