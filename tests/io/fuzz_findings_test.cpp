// SPDX-License-Identifier: Apache-2.0
// What the fuzzer found, each as a small case.
#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "base/file.h"
#include "io/io.h"
#include "io/isolated.h"
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
  CHECK((error.find("a name of 300 bytes") != std::string::npos || error.find("not installed") != std::string::npos));
}

TEST_CASE("try in a child: a library that dies is an error of the file, one that throws is not") {
  const std::string path = test::temp_folder() + "x.bin";
  write_file(path, "x");
  CHECK(test::error_of([&] { try_in_child(path, "Test", [] { std::abort(); }); }).find("does not survive reading it") != std::string::npos);
  CHECK(test::error_of([&] { try_in_child(path, "Test", [] { std::raise(SIGSEGV); }); }).find(path) != std::string::npos);
  try_in_child(path, "Test", [] { throw std::runtime_error("said again in the parent"); });
  try_in_child(path, "Test", [] {});
}
