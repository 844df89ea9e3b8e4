// SPDX-License-Identifier: Apache-2.0
// Files: mapped reading, and writing that leaves either the whole file or nothing.
#pragma once
#include <cstddef>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sg {

/// A read-only file in memory (mmap). Copies share the mapping, which lives as long as any of them.
class MappedFile {
 public:
  MappedFile() = default;
  /// Throws Error(data) for a missing file, a folder, or one that cannot be read. An empty file has size 0.
  explicit MappedFile(const std::string& path);

  const std::byte* data() const { return data_; }
  size_t size() const { return size_; }
  std::string_view text() const { return {reinterpret_cast<const char*>(data_), size_}; }
  const std::string& path() const { return path_; }
  /// Copies bytes [offset, offset + bytes) by reading, on all threads: the copy costs no mapped pages. The range must lie in the
  /// file. Throws Error(data) when the file cannot be read (it may have been truncated since).
  void copy_to(void* to, size_t offset, size_t bytes) const;
  /// Lets the system reclaim the memory of bytes already read (they can be read again). For passes over files larger than memory.
  void release(const std::byte* begin, const std::byte* end) const noexcept;
  /// Keeps the mapping alive; for Buffer::owner.
  std::shared_ptr<const void> owner() const { return owner_; }

 private:
  std::string path_;
  std::shared_ptr<const void> owner_;
  std::shared_ptr<const int> descriptor_;
  const std::byte* data_ = nullptr;
  size_t size_ = 0;
};

/// Writes beside `path` and renames on commit(); without commit the partial file is removed. Every failure (missing
/// folder, no permission, full disk) throws Error(data) naming the path.
class AtomicFile {
 public:
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(const void* data, size_t bytes);
  void write(std::string_view text) { write(text.data(), text.size()); }
  size_t position() const { return written_; }
  void commit();

 private:
  [[noreturn]] void fail(const char* what) const;
  std::string path_, partial_;
  std::FILE* file_ = nullptr;
  size_t written_ = 0;
};

void write_file(const std::string& path, std::string_view bytes);

bool file_exists(const std::string& path);
bool is_folder(const std::string& path);
/// Names in a folder, without . and .., sorted so that numbers in them count ("s2" before "s10"). Throws Error(data) when it cannot be
/// read.
std::vector<std::string> folder_entries(const std::string& path);
/// "s2" before "s10": runs of digits are compared as numbers, the rest byte by byte.
bool natural_less(std::string_view a, std::string_view b);
/// Folder part with trailing '/', or "" when there is none.
std::string folder_of(std::string_view path);
std::string file_name_of(std::string_view path);
/// Lower-case extension without the dot ("vti"); "" when there is none.
std::string extension_of(std::string_view path);
/// `name` itself when absolute, else joined to the folder of `beside`.
std::string path_beside(std::string_view beside, std::string_view name);

}  // namespace sg
