// SPDX-License-Identifier: Apache-2.0
// The seeds of the fuzz target are read whole, cut, and with bytes changed.
#include "corpus.h"

#include <algorithm>
#include <map>

#include "base/random.h"

using namespace sg;

namespace {

struct Damage {
  size_t cuts = 64, first = 256, later = 64;  ///< pieces that it is cut at, bytes changed one by one from the start on, and further ones
};

// How many of the damaged forms were read, and refused.
std::pair<size_t, size_t> damage_seed(test::Seed& seed, const Damage& damage) {
  const std::string& whole = seed.bytes();
  size_t attempt = 0, read = 0, refused = 0;
  auto try_it = [&](std::string_view bytes) {
    const bool good = (attempt % 4 == 3 ? seed.read_rarer(bytes, attempt / 4) : seed.read(bytes)).empty();
    ++attempt;
    ++(good ? read : refused);
  };
  for (size_t k = 0; k < damage.cuts; ++k) try_it(std::string_view(whole).substr(0, whole.size() * k / damage.cuts));
  auto change = [&](size_t at, uint64_t bits) {
    constexpr unsigned char masks[] = {0x01, 0x80, 0xff, 0x20};
    std::string bytes = whole;
    bytes[at] = char(static_cast<unsigned char>(bytes[at]) ^ masks[bits % 4]);
    try_it(bytes);
  };
  const size_t first = std::min(damage.first, whole.size());
  for (size_t i = 0; i < first; ++i) change(i, i);
  if (whole.size() > first)
    for (size_t i = 0; i < damage.later; ++i) change(first + random_bits(1, i) % (whole.size() - first), random_bits(2, i));
  return {read, refused};
}

void check_formats(std::string_view plugin, const Damage& damage) {
  std::map<std::string, size_t> refused;
  const size_t seeds = test::for_seeds(plugin, [&](test::Seed& seed, const std::string& slug) {
    CHECK(seed.read(seed.bytes()) == "");
    refused[slug] += damage_seed(seed, damage).second;
  });
  CHECK(seeds > 0);
  for (const auto& [slug, n] : refused) {
    CAPTURE(slug);
    CHECK(n > 0);
  }
}

}  // namespace

TEST_CASE("corpus: every format has a seed, and every folder of seeds a format") {
  std::vector<std::string> known;
  for (const Format& f : formats())
    if (f.read) {
      known.push_back(fuzz::slug(f.name));
      CAPTURE(known.back());
      CHECK(!test::seeds_of(known.back()).empty());
    }
  size_t folders = 0;
  for (const auto& e : std::filesystem::directory_iterator(std::string(test::source_folder()) + "/fuzz/corpus")) {
    ++folders;
    CAPTURE(e.path().string());
    CHECK(std::find(known.begin(), known.end(), e.path().filename()) != known.end());
  }
  CHECK(folders == known.size());
}

TEST_CASE("corpus: whole, cut and damaged seeds of our own readers are read or refused") { check_formats("", {}); }
TEST_CASE("corpus: DICOM" * doctest::skip(test::missing("gdcm"))) { check_formats("gdcm", {}); }
// These start a process for each attempt: fewer of them.
TEST_CASE("corpus: netCDF, Exodus II, MINC" * doctest::skip(test::missing("netcdf"))) { check_formats("netcdf", {16, 32, 32}); }
TEST_CASE("corpus: TIFF" * doctest::skip(test::missing("tiff"))) { check_formats("tiff", {16, 64, 32}); }
TEST_CASE("corpus: VTKHDF, MINC 2, ENZO, XDMF" * doctest::skip(test::missing("hdf5"))) { check_formats("hdf5", {16, 32, 32}); }
TEST_CASE("corpus: CGNS" * doctest::skip(test::missing("cgns"))) { check_formats("cgns", {16, 32, 32}); }
TEST_CASE("corpus: OpenVDB" * doctest::skip(test::missing("openvdb"))) { check_formats("openvdb", {16, 32, 32}); }
