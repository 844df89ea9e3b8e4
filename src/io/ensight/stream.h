// SPDX-License-Identifier: Apache-2.0
// The three forms of EnSight Gold files as one stream of lines, whole numbers and real numbers.
//
//   ASCII            lines of text; numbers in columns of 10 (i10) and 12 (e12.5) characters, which may touch
//   C binary         80 characters a line, 4-byte integers and floats, either byte order
//   Fortran binary   the same, each item between two 4-byte counts of its bytes
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "base/file/file.h"
#include "data/array.h"

namespace sg::ensight {

enum class Form { ascii, c_binary, fortran_binary };

/// A position in a file. All functions throw Error(data) that names the file and the line (ASCII) or byte (binary).
class Stream {
 public:
  /// The form of a geometry file, from its first line.
  static Form form_of(const MappedFile& file);
  Stream(MappedFile file, Form form);

  /// The byte order of another file of the case, until an integer of this one reveals its own.
  void take_order(const Stream& other) {
    if (!order_known_) big_endian_ = other.big_endian_;
  }
  /// Goes to the lines behind the k-th "BEGIN TIME STEP".
  void seek_step(int64_t k);
  bool at_end();
  /// A description: the next line as it is, without blanks at its ends.
  std::string line(std::string_view what);
  /// The next line that is not empty, without moving; "" at the end.
  std::string peek();
  /// The same, moving behind it.
  std::string keyword(std::string_view what);

  int32_t integer(std::string_view what);
  /// A number of things of at least `bytes` bytes each in the rest of the file.
  size_t count(std::string_view what, size_t bytes);
  std::vector<int32_t> integers(size_t n, std::string_view what);
  /// n numbers, f32, in place where the file has them so.
  Array reals(size_t n, std::string_view what);
  float real(std::string_view what) { return reals(1, what).view<float>()[0]; }
  void skip_numbers(size_t n, std::string_view what);

  Form form() const { return form_; }
  const std::string& path() const { return path_; }
  [[noreturn]] void fail(const std::string& problem, const std::string& hint = {}) const;

 private:
  void unframe();
  const char* take(size_t n, std::string_view what);
  void guess_order(const char* p);
  void need_text(size_t n, std::string_view what) const;
  void end_line();
  template <class T>
  void read_text(size_t n, T* out, std::string_view what);

  std::string path_;
  MappedFile file_;
  Form form_;
  Buffer unframed_;
  std::string_view all_;
  size_t at_ = 0;
  bool order_known_ = false, big_endian_ = false;
};

}  // namespace sg::ensight
