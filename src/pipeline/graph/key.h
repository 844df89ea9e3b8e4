// SPDX-License-Identifier: Apache-2.0
// Key: 128 bits that identify the content of a result, the same in every run. Equal keys are taken to be equal results.
#pragma once
#include <compare>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sg {

struct Key {
  uint64_t hi = 0, lo = 0;
  friend bool operator==(const Key&, const Key&) = default;
  friend auto operator<=>(const Key&, const Key&) = default;
};

/// 32 hexadecimal digits.
std::string key_text(const Key& key);

/// Collects the parts of a key; each part is stored with its length, so that no two lists of parts read alike.
class KeyBuilder {
 public:
  KeyBuilder& add(std::string_view part);
  KeyBuilder& add(uint64_t number);
  KeyBuilder& add(const Key& key);
  /// XXH3-128 of the parts.
  Key key() const;

 private:
  std::string bytes_;
};

/// XXH3-128 of any bytes.
Key hash_bytes(const void* data, size_t size);

struct FileState {
  std::string path;
  uint64_t size = 0;
  int64_t modified = 0;  ///< nanoseconds since 1970
  bool exists = false;
};
FileState file_state(const std::string& path);

/// The file and the files next to it that a header of its kind (mhd, nhdr, pvtu, vtm, pvd, xdmf, ...) names, as far as they exist.
std::vector<FileState> file_and_parts(const std::string& path);

/// Of path, size and time of change of the file and its parts; with `strict` of their contents too (reads them whole).
/// A missing file has a key as well.
Key file_key(const std::string& path, bool strict);

}  // namespace sg
