// SPDX-License-Identifier: Apache-2.0
// HDF5 files whose datasets grow along their first dimension while others may read them ("single writer, multiple readers"): when a write
// has been flushed, a program that is killed leaves what was written before.
#pragma once
#include <map>

#include "io/plugins/hdf5/h5_write.h"

namespace sg::h5 {

class GrowingFile : public Writer {
 public:
  GrowingFile(const std::string& path, bool compress, Context& context) : Writer(path, compress, context, Latest{}) {}

  /// An empty dataset whose rows have the dimensions `row`. `rows`: that will come at once, for the size of its chunks.
  void declare(const std::string& path, ElementType type, const std::vector<hsize_t>& row, size_t rows);
  bool has(const std::string& path) const { return sets_.count(path) > 0; }
  /// A whole number, which may be changed.
  void declare_count(const std::string& object, const char* name);
  /// After this nothing can be declared, no attribute be set, and no group be made.
  void start();
  /// Moves the file to its place, open as it is.
  void move_into_place() { Writer::move_into_place(); }

  /// Rows behind those that are there; numbers of another type are converted. Throws Error(data).
  void append(const std::string& path, const Array& values, size_t rows);
  size_t rows(const std::string& path) const { return size_t(sets_.at(path).rows); }
  /// Sets the count, after all that was appended is in the file.
  void set_count(const std::string& object, const char* name, int64_t count);
  void close();

 private:
  struct Set {
    ElementType type;
    std::vector<hsize_t> row;
    hsize_t rows = 0;
    Handle set;
  };
  struct Count {
    std::string object, name;
    Handle of, attribute;
  };
  std::map<std::string, Set> sets_;
  std::map<std::string, Count> counts_;
};

}  // namespace sg::h5
