// SPDX-License-Identifier: Apache-2.0
// HDF5 files, writing.
#pragma once
#include <hdf5.h>

#include <string>
#include <vector>

#include "base/context.h"
#include "base/file/partial_file.h"
#include "data/array.h"
#include "io/plugins/hdf5/h5.h"

namespace sg::h5 {

/// A file in its temporary place; moved by commit(), else removed. The same data give the same bytes. Throws Error(data) naming the path.
class Writer {
 public:
  Writer(const std::string& path, bool compress, Context& context);
  ~Writer() { file_ = Handle(); }  // before its place goes
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void commit();
  void group(const std::string& path);
  void text(const std::string& object, const char* name, const std::string& value);
  template <class T>
  void numbers(const std::string& object, const char* name, const std::vector<T>& values) {
    const hsize_t n = values.size();
    const Handle space(H5Screate_simple(1, &n, nullptr));
    attribute(object, name, native_type(element_type_of<T>()), space, values.data());
  }
  template <class T>
  void number(const std::string& object, const char* name, T value) {
    const Handle space(H5Screate(H5S_SCALAR));
    attribute(object, name, native_type(element_type_of<T>()), space, &value);
  }
  /// An array with the dimensions `dims`, slowest first (none: a single number); chunked and compressed when requested and worthwhile.
  void array(const std::string& path, const Array& values, std::vector<hsize_t> dims);
  /// A list of tuples: (n) or (n, components).
  void list(const std::string& path, const Array& values);
  void count(const std::string& path, size_t n) { list(path, Array::from_vector(std::vector<int64_t>{int64_t(n)})); }
  const std::string& path() const { return path_; }

 protected:
  struct Latest {};
  /// In the newest form of the format, which can be read while it grows.
  Writer(const std::string& path, bool compress, Context& context, Latest);
  [[noreturn]] void fail(const std::string& what) const;
  void move_into_place() { partial_.commit(); }
  const Handle& file() const { return file_; }
  bool close() { return file_.close(); }
  bool compresses() const { return compress_; }

 private:
  Writer(const std::string& path, bool compress, Context& context, bool latest);
  void attribute(const std::string& object, const char* name, hid_t type, hid_t space, const void* value);
  std::string path_;
  PartialFile partial_;
  bool compress_;
  Context& context_;
  Handle file_;
};

/// The chunk of an array of `dims` (slowest first) and elements of `size` bytes: about a quarter of a mebibyte.
std::vector<hsize_t> chunk_of(std::vector<hsize_t> dims, size_t size);
constexpr int deflate_level = 4;

}  // namespace sg::h5
