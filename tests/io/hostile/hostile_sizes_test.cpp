// SPDX-License-Identifier: Apache-2.0
// Sizes that no file backs, at every place of the fuzz target's seeds: 2^31, 2^63-1 and -1 in each count, whatever its width and order.
#include "io/corpus.h"
#include "memory_cap.h"

using namespace sg;

namespace {

// Reading may say anything but that there was not enough memory: then it had asked for what the size said.
void try_it(test::Seed& seed, const std::string& bytes, size_t at) {
  try {
    const std::string said = seed.read(bytes);
    if (said.find("not enough memory") != std::string::npos) FAIL_CHECK("at ", at, ": ", said);
  } catch (const std::bad_alloc&) {
    FAIL_CHECK("asks for too much memory when the size at ", at, " is changed");
  }
}

// The binary forms: 4 and 8 bytes wide, both byte orders.
std::vector<std::string> binary_sizes() {
  std::vector<std::string> sizes;
  auto put = [&](uint64_t v, size_t width) {
    std::string little(width, '\0'), big(width, '\0');
    for (size_t i = 0; i < width; ++i) little[i] = big[width - 1 - i] = char(v >> (8 * i));
    sizes.push_back(little);
    if (big != little) sizes.push_back(big);
  };
  for (const size_t width : {4, 8}) put(uint64_t(1) << 31, width), put(UINT64_MAX, width);
  put(INT32_MAX, 4), put(INT64_MAX, 8);
  return sizes;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

void check_text_sizes(test::Seed& seed, size_t most) {
  const std::string& whole = seed.bytes();
  size_t numbers = 0;
  for (size_t i = 0; i < whole.size() && numbers < most; ++i) {
    if (!is_digit(whole[i]) || (i > 0 && (is_digit(whole[i - 1]) || whole[i - 1] == '.'))) continue;
    size_t end = i;
    while (end < whole.size() && is_digit(whole[end])) ++end;
    ++numbers;
    for (const char* size : {"2147483648", "9223372036854775807", "-1"}) {
      std::string bytes = whole;
      bytes.replace(i, end - i, size);
      try_it(seed, bytes, i);
    }
  }
}

void check_binary_sizes(test::Seed& seed, size_t dense, size_t most, size_t step) {
  static const std::vector<std::string> sizes = binary_sizes();
  const std::string& whole = seed.bytes();
  for (size_t i = 0; i < std::min(whole.size(), most); i += i < dense ? 1 : step)
    for (const std::string& size : sizes) {
      if (i + size.size() > whole.size()) continue;
      std::string bytes = whole;
      bytes.replace(i, size.size(), size);
      try_it(seed, bytes, i);
    }
}

bool is_binary(const std::string& bytes) { return bytes.find('\0') != std::string::npos; }

void check_sizes(std::string_view plugin, size_t numbers, size_t dense, size_t most, size_t step) {
  const test::OneThread one;
  // The first reading loads the plug-in and starts what stays.
  test::for_seeds(plugin, [&](test::Seed& seed, const std::string&) { CHECK(seed.read(seed.bytes()) == ""); });
  const test::MemoryCap cap(size_t(1) << 30);
  size_t binary = 0;
  CHECK(test::for_seeds(plugin, [&](test::Seed& seed, const std::string&) {
          check_text_sizes(seed, numbers);
          if (!is_binary(seed.bytes())) return;
          ++binary;
          check_binary_sizes(seed, dense, most, step);
        }) > 0);
  CHECK(binary > 0);
}

}  // namespace

TEST_CASE("hostile sizes: our own readers ask for no memory that the file does not back") { check_sizes("", 40, 64, 400, 4); }
TEST_CASE("hostile sizes: DICOM" * doctest::skip(test::missing("gdcm"))) { check_sizes("gdcm", 0, 0, 500, 8); }
// These start a process for each attempt: fewer of them. tests/hdf5 has counts of VTKHDF by name.
TEST_CASE("hostile sizes: netCDF, Exodus II, MINC" * doctest::skip(test::missing("netcdf"))) { check_sizes("netcdf", 0, 0, 600, 44); }
TEST_CASE("hostile sizes: TIFF" * doctest::skip(test::missing("tiff"))) { check_sizes("tiff", 0, 0, 400, 26); }
TEST_CASE("hostile sizes: VTKHDF, MINC 2, ENZO, XDMF" * doctest::skip(test::missing("hdf5"))) { check_sizes("hdf5", 5, 0, 600, 64); }
TEST_CASE("hostile sizes: CGNS" * doctest::skip(test::missing("cgns"))) { check_sizes("cgns", 0, 0, 800, 128); }
TEST_CASE("hostile sizes: OpenVDB" * doctest::skip(test::missing("openvdb"))) { check_sizes("openvdb", 0, 0, 300, 60); }
