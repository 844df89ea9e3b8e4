// SPDX-License-Identifier: Apache-2.0
// NcFile: a netCDF file (classic or HDF5) with its dimensions, variables and attributes, and typed reading of parts of a variable.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "data/array.h"

namespace sg::nc {

struct Dimension {
  std::string name;
  size_t length = 0;
  bool unlimited = false;
};

struct Variable {
  int id = -1;
  std::string name;
  int type = 0;           ///< nc_type
  std::vector<int> dims;  ///< places in NcFile::dimensions()
  std::vector<size_t> shape;

  bool is_text() const;
  /// Of a type that an Array can hold (no text, no structures).
  bool is_number() const;
  /// The type as stored; only for numbers.
  ElementType element() const;
  size_t count() const;
};

/// Checks the header of a classic netCDF file ("CDF\1", "CDF\2", "CDF\5") against the file's size: every list, name and
/// variable must lie in the file. Other files pass. Throws Error(data) naming the truncated variable.
void check_classic(const std::string& path);

/// An open file; read only. Only the root group of a netCDF-4 file. Not thread-safe; opened only in child processes (io/isolated.h).
class NcFile {
 public:
  /// Throws Error(data) naming the file.
  explicit NcFile(const std::string& path);
  ~NcFile();
  NcFile(const NcFile&) = delete;
  NcFile& operator=(const NcFile&) = delete;

  const std::string& path() const { return path_; }
  const std::vector<Dimension>& dimensions() const { return dims_; }
  const std::vector<Variable>& variables() const { return variables_; }
  const Variable* find(std::string_view name) const;
  /// Throws Error(data) when there is none.
  const Variable& require(std::string_view name) const;
  /// Length of the dimension of that name; nothing when there is none.
  std::optional<size_t> dim(std::string_view name) const;
  bool has_group(const char* name) const;

  /// Text attribute of a variable (null: of the file), trimmed; "" when there is none or it is a number.
  std::string text(const Variable* v, const char* name) const;
  /// Words of a text attribute.
  std::vector<std::string> words(const Variable* v, const char* name) const;
  /// Numbers of an attribute; empty when there is none or it is text.
  std::vector<double> numbers(const Variable* v, const char* name) const;
  std::optional<double> number(const Variable* v, const char* name) const;

  /// `count` numbers from `start` along each dimension, packed, as `type`. Throws Error(data) naming the variable when the part is
  /// not there or is larger than the file can back.
  Array read(const Variable& v, const std::vector<size_t>& start, const std::vector<size_t>& count, ElementType type) const;
  Array read(const Variable& v, ElementType type) const { return read(v, std::vector<size_t>(v.shape.size()), v.shape, type); }
  /// All numbers as doubles.
  std::vector<double> doubles(const Variable& v) const;
  /// Rows of a character variable, each up to its first zero byte, trailing blanks removed; rows of all leading dimensions in order.
  std::vector<std::string> strings(const Variable& v) const;

  /// Throws Error(data) when the whole variable is larger than what the file can back (HDF5 keeps sizes without data).
  void check_backed(const Variable& v) const;

  [[noreturn]] void fail(const std::string& problem, std::string_view variable = {}, std::string hint = {}) const;

 private:
  void inquire();
  uint64_t most_bytes() const;
  std::string path_;
  size_t file_size_ = 0;
  bool packed_ = false;  // HDF5: variables may be compressed
  int id_ = -1;
  std::vector<Dimension> dims_;
  std::vector<Variable> variables_;
};

}  // namespace sg::nc
