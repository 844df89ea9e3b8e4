// SPDX-License-Identifier: Apache-2.0
// HDF5 files, reading: handles that close themselves, objects named by absolute paths, sizes checked against the file before memory is
// allocated, errors that name the file, the object and the library's message. The library prints nothing.
#pragma once
#include <hdf5.h>

#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/file/file.h"
#include "data/array.h"
#include "io/plugins/hdf5/h5_data.h"

namespace sg::h5 {

/// Any HDF5 identifier; closed with the last owner.
class Handle {
 public:
  Handle() = default;
  explicit Handle(hid_t id) : id_(id) {}
  Handle(Handle&& o) noexcept : id_(std::exchange(o.id_, -1)) {}
  Handle& operator=(Handle&& o) noexcept {
    std::swap(id_, o.id_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) H5Idec_ref(id_);
  }
  operator hid_t() const { return id_; }
  bool good() const { return id_ >= 0; }
  /// False when that failed: of a file, what was still to be written could not be.
  bool close() { return id_ < 0 || H5Idec_ref(std::exchange(id_, -1)) >= 0; }

 private:
  hid_t id_ = -1;
};

/// Stops the library's printing on this thread. Every entry point of the plug-in calls it.
void silence();
/// What the library said last, innermost message; clears it. "" when it said nothing.
std::string library_message();

/// Held by every entry point of the plug-in: one thread at a time works with the library, so that a child process (see guarded.h)
/// finds none of its locks taken.
class Turn {
 public:
  Turn() : lock_(mutex()) {}

 private:
  static std::recursive_mutex& mutex();
  std::lock_guard<std::recursive_mutex> lock_;
};

/// A file open for reading.
class File {
 public:
  /// Throws Error(data) for a file that is missing, no HDF5 file, truncated or damaged.
  explicit File(const std::string& path);
  enum Unprobed { unprobed };
  /// Without a look at all of it in a child process first (h5_probe.h).
  File(const std::string& path, Unprobed);

  const std::string& path() const { return path_; }
  uint64_t size() const { return size_; }
  hid_t id() const { return file_; }

  bool exists(const std::string& object) const;
  bool is_group(const std::string& object) const;
  bool is_dataset(const std::string& object) const;
  /// Names in a group, in the order of creation where the file keeps it, else by name; at most 1 million.
  std::vector<std::string> children(const std::string& group) const;
  std::optional<std::string> text_attribute(const std::string& object, const std::string& name) const;
  /// Nothing when there is no such attribute or it is not a list of at most 4096 numbers.
  std::vector<double> number_attribute(const std::string& object, const std::string& name) const;

  [[noreturn]] void fail(std::string problem, const std::string& object, std::string hint = {}) const;
  /// The mapped bytes; mapped on first use.
  const MappedFile& mapped() const;

 private:
  std::string path_;
  uint64_t size_ = 0;
  Handle file_;
  mutable std::optional<MappedFile> mapped_;
};

/// A dataset: its shape, its type, and its numbers.
class Dataset {
 public:
  /// Throws Error(data) when there is no such dataset.
  Dataset(const File& file, const std::string& path);
  Dataset(const Dataset&) = delete;
  Dataset& operator=(const Dataset&) = delete;

  const std::vector<uint64_t>& dims() const { return dims_; }
  uint64_t count() const { return count_; }
  /// The first dimension (1 for a single number), and the numbers in each row.
  uint64_t rows() const { return dims_.empty() ? 1 : dims_[0]; }
  uint64_t row_size() const { return row_size_; }
  /// Integers and IEEE floats of 1, 2, 4 or 8 bytes in any byte order, and enumerations.
  bool numeric() const { return numeric_; }
  ElementType type() const { return type_; }
  /// Reading costs nothing: the numbers lie in the file as they are needed.
  bool in_place() const { return at_.has_value(); }
  /// Whether the file is large enough for the shape.
  bool backed() const { return numeric_ && count_ <= backed_ / element_size(type_); }
  const std::string& path() const { return path_; }

  /// All numbers, row by row, as tuples of `components` (which must divide their count). Unfiltered numbers that lie in the file
  /// as they are needed stay there.
  Array read(int components = 1) const;
  /// Rows [begin, begin+n), each a tuple of row_size() numbers.
  Array read_rows(uint64_t begin, uint64_t n) const;
  /// count[a] indices from start[a] on, every stride[a]-th, along each dimension; tuples of `components`.
  Array read_block(const std::vector<uint64_t>& start, const std::vector<uint64_t>& count, const std::vector<uint64_t>& stride,
                   int components = 1) const;
  /// The strings of a dataset of fixed-length strings, half a mebibyte at most; empty for others.
  std::vector<std::string> strings() const;

 private:
  void check_backed(uint64_t bytes) const;
  void find_layout();
  void read_by_library(hid_t here, hid_t there, std::byte* out, size_t bytes) const;
  void find_storage(hid_t made, H5D_layout_t layout);
  const MappedFile& home() const;
  std::optional<Array> mapped(uint64_t first, uint64_t n, int components) const;
  const File& file_;
  std::string path_;
  Handle set_, type_in_file_, space_;
  std::vector<uint64_t> dims_;
  uint64_t count_ = 1, row_size_ = 1;
  std::string where() const { return file_.path() + ": '" + path_ + "'"; }
  uint64_t file_size_ = 0;
  uint64_t backed_ = 0;                      // bytes that the file can back
  std::optional<Storage> storage_;           // where the numbers are, unless only the library knows
  std::optional<uint64_t> at_;               // the same, when they lie there as they are needed
  mutable std::optional<MappedFile> other_;  // the file behind an external link
  std::string other_path_;
  bool numeric_ = false, big_endian_ = false, compact_ = false;
  ElementType type_ = ElementType::f32;
};

/// Rows [begin, begin+n) of a list of counts or offsets (the first of each row); throws Error(data) for negative ones.
std::vector<uint64_t> read_counts(const File& file, const std::string& dataset, uint64_t begin, uint64_t n);

hid_t native_type(ElementType type);
/// Whether the numbers of that type are read, as what, and whether their bytes must be turned.
bool plain_type(hid_t type, ElementType& out, bool& big_endian);

}  // namespace sg::h5
