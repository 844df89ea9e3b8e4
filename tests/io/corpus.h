// SPDX-License-Identifier: Apache-2.0
// The seeds of the fuzz target, fuzz/corpus/FORMAT, for tests that read them as it does.
#pragma once
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "../../fuzz/fuzz.h"
#include "base/file/file.h"
#include "support/test.h"

namespace sg::test {

// Formats whose seeds need a plug-in; all others are read by the library itself. XDMF needs one for a part of its seeds.
struct PluginRow {
  std::string_view plugin, formats;
};
inline constexpr PluginRow plugins[] = {{"hdf5", "vtkhdf minc-2 enzo xdmf"},
                                        {"netcdf", "netcdf exodus-ii minc"},
                                        {"cgns", "cgns"},
                                        {"gdcm", "dicom dicom-without-preamble"},
                                        {"openvdb", "openvdb"},
                                        {"tiff", "tiff"}};

inline std::string_view plugin_of(const std::string& slug) {
  for (const PluginRow& row : plugins)
    for (std::string_view f : words(row.formats))
      if (f == slug) return row.plugin;
  return "";
}

/// For docskip: the plug-in was not built here.
inline bool missing(const std::string& plugin) {
  return !file_exists(std::string(build_folder()) + "/plugins/sightglass_" + plugin + ".so");
}

/// Paths of the seeds of a format, sorted.
inline std::vector<std::string> seeds_of(const std::string& slug) {
  std::vector<std::string> seeds;
  std::error_code none;
  for (const auto& e : std::filesystem::directory_iterator(std::string(source_folder()) + "/fuzz/corpus/" + slug, none))
    if (e.is_regular_file()) seeds.push_back(e.path());
  std::sort(seeds.begin(), seeds.end());
  return seeds;
}

/// A folder in memory where there is one: thousands of small files come and go. Removed when the program ends.
inline const std::string& corpus_folder() {
  struct Folder {
    std::string path;
    Folder() {
      char pattern[] = "/dev/shm/sightglass-corpus-XXXXXX";
      path = ::mkdtemp(pattern) ? std::string(pattern) + "/" : temp_folder() + "corpus/";
      std::filesystem::create_directories(path);
    }
    ~Folder() {
      std::error_code none;
      std::filesystem::remove_all(path, none);
    }
  };
  static const Folder folder;
  return folder.path;
}

class Seed {
 public:
  Seed(const Format& format, const std::string& path) : format_(format), whole_(MappedFile(path).text()) {}

  const std::string& bytes() const { return whole_; }

  /// "" when `bytes` were read as the format, else what was said. Errors of kind internal fail the test, other exceptions pass through.
  std::string read(std::string_view bytes, const ReadOptions& options) {
    if (dirty_) std::filesystem::remove_all(folder_), std::filesystem::create_directories(folder_);
    dirty_ = bytes.starts_with("@@ ");
    const std::string path = fuzz::put_seed(folder_, fuzz::file_name(format_), bytes);
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
  std::string read(std::string_view bytes) { return read(bytes, fuzz::options_of(format_, bytes)); }
  std::string read_rarer(std::string_view bytes, size_t which) { return read(bytes, fuzz::rarer_options_of(format_, bytes, which)); }

 private:
  const Format& format_;
  std::string whole_, folder_ = corpus_folder() + "seed/";
  bool dirty_ = true;
};

/// Calls f(seed, slug) for the seeds of the formats of a plug-in, "" = of none. Returns how many there are.
template <class F>
size_t for_seeds(std::string_view plugin, F&& f) {
  size_t n = 0;
  for (const Format& format : formats()) {
    const std::string slug = fuzz::slug(format.name);
    if (!format.read || plugin_of(slug) != plugin) continue;
    for (const std::string& path : seeds_of(slug)) {
      CAPTURE(path);
      Seed seed(format, path);
      f(seed, slug);
      ++n;
    }
  }
  return n;
}

}  // namespace sg::test
