// SPDX-License-Identifier: Apache-2.0
// Several files that belong together, written whole or not at all: numbers and the header that names them.
#pragma once
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace sg {

/// Each is written to a new file with a temporary name next to its destination. commit() first flushes all to disk; then they are renamed
/// in their order, the one that names the others last. If anything fails, all previous files under these names remain and no temporary
/// files are left. Throws Error(data) naming the path.
class AtomicFiles {
 public:
  explicit AtomicFiles(const std::vector<std::string>& paths);
  ~AtomicFiles();
  AtomicFiles(const AtomicFiles&) = delete;
  AtomicFiles& operator=(const AtomicFiles&) = delete;

  void write(size_t file, const void* data, size_t bytes);
  void write(size_t file, std::string_view text) { write(file, text.data(), text.size()); }
  /// Brings all to the disk, as commit() does first: what cannot be written is known before anything is replaced.
  void finish();
  void commit();

 private:
  struct One {
    std::string path, partial;
    std::FILE* file = nullptr;
    bool placed = false, exchanged = false;
  };
  [[noreturn]] void fail(const One& one) const;
  void place(One& one);
  void take_back() noexcept;
  std::vector<One> files_;
};

}  // namespace sg
