// SPDX-License-Identifier: Apache-2.0
// The seeds of the fuzz target (fuzz/corpus/FORMAT), read as it reads them: whole, cut, and with bytes changed.
#include <filesystem>

#include "../../fuzz/fuzz.h"
#include "base/file.h"
#include "base/random.h"
#include "support/test.h"

using namespace sg;

namespace {

// Formats whose seeds need a plug-in; all others are read by the library itself. XDMF needs one for a part of its seeds.
struct PluginRow {
  std::string_view plugin, formats;
};
constexpr PluginRow plugins[] = {{"hdf5", "vtkhdf enzo xdmf"},
                                 {"netcdf", "netcdf exodus-ii minc"},
                                 {"cgns", "cgns"},
                                 {"gdcm", "dicom dicom-without-preamble"},
                                 {"openvdb", "openvdb"},
                                 {"tiff", "tiff"}};

std::string_view plugin_of(const std::string& slug) {
  for (const PluginRow& row : plugins)
    for (std::string_view f : words(row.formats))
      if (f == slug) return row.plugin;
  return "";
}

bool missing(const std::string& plugin) {
  return !file_exists(std::string(test::build_folder()) + "/plugins/sightglass_" + plugin + ".so");
}

std::vector<std::string> seeds_of(const std::string& slug) {
  std::vector<std::string> seeds;
  std::error_code none;
  for (const auto& e : std::filesystem::directory_iterator(std::string(test::source_folder()) + "/fuzz/corpus/" + slug, none))
    if (e.is_regular_file()) seeds.push_back(e.path());
  std::sort(seeds.begin(), seeds.end());
  return seeds;
}

struct Damage {
  size_t cuts = 64, first = 256, later = 64;  ///< pieces that it is cut at, bytes changed one by one from the start on, and further ones
};

class Seed {
 public:
  Seed(const Format& format, const std::string& path)
      : format_(format), whole_(MappedFile(path).text()), folder_(test::temp_folder() + "corpus/") {}

  const std::string& bytes() const { return whole_; }

  // "" when it was read, else what was said. Any other exception than Error, and an internal one, fails the test.
  std::string read(std::string_view bytes, bool rarer, size_t which) {
    if (dirty_) std::filesystem::remove_all(folder_), std::filesystem::create_directories(folder_);
    dirty_ = bytes.starts_with("@@ ");
    const std::string path = fuzz::put_seed(folder_, fuzz::file_name(format_), bytes);
    const ReadOptions options = rarer ? fuzz::rarer_options_of(format_, bytes, which) : fuzz::options_of(format_, bytes);
    Context context;
    try {
      if (format_.times) (void)format_.times(path, options, context);
      fuzz::look_at(format_.read(path, options, context));
    } catch (const Error& e) {
      if (e.kind() == ErrorKind::internal) FAIL_CHECK(e.what());
      return *e.what() ? e.what() : "?";
    }
    return "";
  }

  void check_damaged(const Damage& damage, size_t& read_all, size_t& refused) {
    size_t attempt = 0;
    auto try_it = [&](std::string_view bytes) {
      const bool good = read(bytes, attempt % 4 == 3, attempt / 4).empty();
      ++attempt;
      ++(good ? read_all : refused);
    };
    for (size_t k = 0; k < damage.cuts; ++k) try_it(std::string_view(whole_).substr(0, whole_.size() * k / damage.cuts));
    auto change = [&](size_t at, uint64_t bits) {
      constexpr unsigned char masks[] = {0x01, 0x80, 0xff, 0x20};
      std::string bytes = whole_;
      bytes[at] = char(static_cast<unsigned char>(bytes[at]) ^ masks[bits % 4]);
      try_it(bytes);
    };
    const size_t first = std::min(damage.first, whole_.size());
    for (size_t i = 0; i < first; ++i) change(i, i);
    if (whole_.size() > first)
      for (size_t i = 0; i < damage.later; ++i) change(first + random_bits(1, i) % (whole_.size() - first), random_bits(2, i));
  }

 private:
  const Format& format_;
  std::string whole_, folder_;
  bool dirty_ = true;
};

void check_formats(std::string_view plugin, const Damage& damage) {
  size_t formats_seen = 0;
  for (const Format& f : formats()) {
    const std::string slug = fuzz::slug(f.name);
    if (!f.read || plugin_of(slug) != plugin) continue;
    ++formats_seen;
    size_t read = 0, refused = 0;
    for (const std::string& path : seeds_of(slug)) {
      CAPTURE(path);
      Seed seed(f, path);
      CHECK(seed.read(seed.bytes(), false, 0) == "");
      seed.check_damaged(damage, read, refused);
    }
    CAPTURE(slug);
    CHECK(refused > 0);
    CHECK(read + refused > damage.cuts);
  }
  CHECK(formats_seen > 0);
}

}  // namespace

TEST_CASE("corpus: every format has a seed, and every folder of seeds a format") {
  std::vector<std::string> known;
  for (const Format& f : formats())
    if (f.read) {
      known.push_back(fuzz::slug(f.name));
      CAPTURE(known.back());
      CHECK(!seeds_of(known.back()).empty());
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
TEST_CASE("corpus: netCDF, Exodus II, MINC" * doctest::skip(missing("netcdf"))) { check_formats("netcdf", {}); }
TEST_CASE("corpus: DICOM" * doctest::skip(missing("gdcm"))) { check_formats("gdcm", {}); }
TEST_CASE("corpus: TIFF" * doctest::skip(missing("tiff"))) { check_formats("tiff", {}); }
// These start a process for each attempt: fewer of them.
TEST_CASE("corpus: VTKHDF, ENZO, XDMF" * doctest::skip(missing("hdf5"))) { check_formats("hdf5", {16, 32, 32}); }
TEST_CASE("corpus: CGNS" * doctest::skip(missing("cgns"))) { check_formats("cgns", {16, 32, 32}); }
TEST_CASE("corpus: OpenVDB" * doctest::skip(missing("openvdb"))) { check_formats("openvdb", {16, 32, 32}); }
