// SPDX-License-Identifier: Apache-2.0
// Helpers of the tests of formats that are several files: written into one folder, read, and damaged one at a time.
#pragma once
#include <sys/stat.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <set>

#include "io/io_files.h"

namespace sg::test {

/// Names (with folders) and bytes of the files of a case.
using CaseFiles = std::map<std::string, std::string>;

/// Without the care for a crash that write_file() takes: a thousand damaged files would be slow.
inline void write_quickly(const std::string& path, const std::string& bytes) {
  std::remove(path.c_str());  // a file that is cut and written anew may be flushed at once
  std::FILE* f = std::fopen(path.c_str(), "wb");
  REQUIRE(f != nullptr);
  std::fwrite(bytes.data(), 1, bytes.size(), f);
  std::fclose(f);
}

/// Writes the files below a folder of that name and returns the folder with '/'.
inline std::string write_case(const std::string& name, const CaseFiles& files) {
  const std::string root = temp_folder() + name + "/";
  ::mkdir(root.c_str(), 0755);
  for (const auto& [path, bytes] : files) {
    for (size_t slash = path.find('/'); slash != std::string::npos; slash = path.find('/', slash + 1))
      ::mkdir((root + path.substr(0, slash)).c_str(), 0755);
    write_quickly(root + path, bytes);
  }
  return root;
}

/// All datasets in order, with their names.
inline std::vector<std::pair<std::string, DatasetPtr>> leaves(const Data& data) {
  std::vector<std::pair<std::string, DatasetPtr>> r;
  for_each_dataset(data, [&](const std::string& name, const DatasetPtr& d) { r.emplace_back(name, d); });
  return r;
}
inline DatasetPtr leaf(const Data& data, size_t i) {
  const auto all = leaves(data);
  REQUIRE(i < all.size());
  return all[i].second;
}

inline DatasetPtr leaf_named(const Data& data, const std::string& name) {
  DatasetPtr found;
  for_each_dataset(data, [&](const std::string& path, const DatasetPtr& d) {
    if (path == name) found = d;
  });
  REQUIRE_MESSAGE(found, name);
  return found;
}

/// 1, 2, ... n.
inline std::vector<int32_t> first_numbers(int n) {
  std::vector<int32_t> v;
  for (int i = 1; i <= n; ++i) v.push_back(i);
  return v;
}

/// Reads `main` with one file of the case cut at every 1/64th, and with each of its first 200 bytes (and every 1/64th) changed:
/// every time an Error or valid data. Returns how many of the 63 cut files were refused.
inline int cut_and_damage_case(const std::string& name, const CaseFiles& files, const std::string& which, const std::string& main) {
  const std::string root = write_case(name, files);
  const std::string& bytes = files.at(which);
  int refused = 0;
  Context context;
  auto attempt = [&](const std::string& damaged) {
    write_quickly(root + which, damaged);
    try {
      for (const auto& [part, d] : leaves(read_data(root + main, {}, context)))
        for (const Field& f : d->fields()) d->stats(f);
    } catch (const Error& e) {
      CHECK((e.kind() == ErrorKind::data || e.kind() == ErrorKind::usage));
      return true;
    }
    return false;
  };
  for (size_t k = 1; k < 64; ++k) refused += attempt(bytes.substr(0, bytes.size() * k / 64));
  std::set<size_t> places;
  for (size_t i = 0; i < std::min<size_t>(bytes.size(), 200); ++i) places.insert(i);
  for (size_t k = 0; k < 64; ++k) places.insert(bytes.size() * k / 64);
  for (const size_t at : places)
    for (const char with : {'\xff', '9', '\0'}) {
      std::string damaged = bytes;
      damaged[at] = with;
      attempt(damaged);
    }
  write_quickly(root + which, bytes);
  return refused;
}

}  // namespace sg::test
