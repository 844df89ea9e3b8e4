// SPDX-License-Identifier: Apache-2.0
// One seed that stands for several files: it begins with "@@ NAME", each file follows its own such line, and the first one is what is
// read ("@@ ." = the folder itself). Any bytes make a bundle, so that the fuzzer may change names and borders too.
#pragma once
#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

namespace sg::fuzz {

struct BundleFile {
  std::string name;
  std::string_view bytes;
};

/// The files of a bundle; empty when `bytes` is none. Names leave no way out of the folder.
inline std::vector<BundleFile> bundle_files(std::string_view bytes) {
  std::vector<BundleFile> files;
  if (!bytes.starts_with("@@ ")) return files;
  for (size_t at = 0; at != std::string_view::npos && files.size() < 32;) {
    const size_t line = bytes.find('\n', at), begin = line == std::string_view::npos ? bytes.size() : line + 1;
    const size_t next = bytes.find("\n@@ ", begin ? begin - 1 : 0);
    std::string name(bytes.substr(at + 3, std::min<size_t>(begin - at - 3, 80)));
    while (!name.empty() && name.back() == '\n') name.pop_back();
    for (char& c : name) {
      const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
      if (!letter && c != '/' && c != '_' && c != '-' && c != '.') c = '_';
    }
    for (size_t k = name.find(".."); k != std::string::npos; k = name.find("..")) name[k] = '_';
    const size_t end = next == std::string_view::npos ? bytes.size() : std::max(next, begin);
    files.push_back({name, bytes.substr(begin, end - begin)});
    at = next == std::string_view::npos ? next : next + 1;
  }
  return files;
}

/// Writes a bundle below `folder` (with '/'; it must exist and be empty) or a plain file `folder + name`; returns what is to be read.
inline std::string put_seed(const std::string& folder, const std::string& name, std::string_view bytes) {
  const auto put = [](const std::string& path, std::string_view b) {
    if (std::FILE* file = std::fopen(path.c_str(), "wb")) {
      std::fwrite(b.data(), 1, b.size(), file);
      std::fclose(file);
    }
  };
  const std::vector<BundleFile> files = bundle_files(bytes);
  if (files.empty()) return put(folder + name, bytes), folder + name;
  for (const BundleFile& f : files) {
    for (size_t k = f.name.find('/'); k != std::string::npos; k = f.name.find('/', k + 1))
      ::mkdir((folder + f.name.substr(0, k)).c_str(), 0755);
    put(folder + f.name, f.bytes);
  }
  return files[0].name == "." ? folder.substr(0, folder.size() - 1) : folder + files[0].name;
}

}  // namespace sg::fuzz
