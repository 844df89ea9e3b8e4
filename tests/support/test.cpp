// SPDX-License-Identifier: Apache-2.0
#include "support/test.h"

#include <stdlib.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "base/file/file.h"

namespace sg::test {

const std::string& data_folder() {
  static const std::string folder = [] {
    const char* env = std::getenv("SIGHTGLASS_DATA");
    std::vector<std::string> places;
    if (env && *env) places.push_back(env);
    places.push_back("../shared/data");
    std::error_code ignored;
    for (std::filesystem::path p = std::filesystem::current_path(ignored); p.has_relative_path(); p = p.parent_path())
      places.push_back((p / "shared/data").string());
    for (const std::string& p : places)
      if (file_exists(p + "/manifest.json")) return p + "/";
    return std::string();
  }();
  return folder;
}

std::string data_file(const std::string& name) { return data_folder() + name; }

const char* source_folder() { return SG_SOURCE_DIR; }
const char* build_folder() { return SG_BINARY_DIR; }

const std::string& temp_folder() {
  struct Folder {
    std::string path;
    Folder() {
      std::string pattern = (std::filesystem::temp_directory_path() / "sightglass-test-XXXXXX").string();
      if (!::mkdtemp(pattern.data())) fail_internal("no temporary folder");
      path = pattern + "/";
    }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
  };
  static const Folder folder;
  return folder.path;
}

std::string fresh_folder(const std::string& name) {
  const std::string folder = temp_folder() + name + "/";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

double observed_order(const double* h, const double* error, int n) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (int i = 0; i < n; ++i) {
    const double x = std::log(h[i]), y = std::log(error[i]);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace sg::test
