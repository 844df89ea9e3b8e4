// SPDX-License-Identifier: Apache-2.0
// The words, lines and arrays of a legacy VTK file, with the place of every error.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/file/file.h"
#include "data/array.h"

namespace sg::vtk {

/// A position in a legacy file. All functions throw Error(data) that names the file and the line (ASCII) or byte (binary).
class LegacyText {
 public:
  explicit LegacyText(const MappedFile& file) : file_(file), all_(file.text()) {}

  bool binary = false;

  bool at_end() const { return at_ >= all_.size(); }
  /// The rest of the line without its end; the position moves behind it.
  std::string_view line();
  /// The next word between white space; "" at the end of the file.
  std::string_view word();
  std::string_view peek();
  /// A word that must be there; `what` describes it.
  std::string_view need_word(std::string_view what);
  double number(std::string_view what);
  /// A count: 0 or more.
  size_t count(std::string_view what);

  /// `tuples` x `components` numbers of a legacy type ("float", "vtktypeint64", "bit", "vtkIdType"). Binary numbers begin
  /// on the next line. A METADATA block behind them is skipped.
  Array array(std::string_view type, size_t tuples, size_t components, std::string_view what);
  /// Passes over such an array; its type. Binary numbers are not touched.
  ElementType skip_array(std::string_view type, size_t tuples, size_t components, std::string_view what);
  /// Where `n` binary big-endian numbers of that type would begin that array() reads next, and their type; null when they are text
  /// or too few. The position stays.
  const std::byte* in_place(std::string_view type, size_t n, ElementType& number_type) const;
  /// `n` strings, which begin on the next line: a line each, or each behind its length.
  std::vector<std::string> strings(size_t n, std::string_view what);
  /// Behind the word METADATA: its lines up to an empty one.
  void skip_metadata();

  [[noreturn]] void fail(std::string problem, std::string hint = {}) const;

 private:
  ElementType number_type(std::string_view type, std::string_view what) const;
  Array bits(size_t tuples, size_t components, std::string_view what);
  Array text_array(ElementType type, size_t tuples, size_t components, std::string_view what);
  const std::byte* take(uint64_t bytes, std::string_view what);
  void skip_blanks();

  const MappedFile& file_;
  std::string_view all_;
  size_t at_ = 0;
};

/// Names in legacy files keep blanks and other odd characters as %20.
std::string decode_name(std::string_view name);

}  // namespace sg::vtk
