// SPDX-License-Identifier: Apache-2.0
// One file of an OpenFOAM case: its header, its words, and its lists of numbers as text or bytes. Source: OpenFOAM User Guide,
// "Basic input/output file format"; macros and #directives are not expanded.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/file/file.h"
#include "data/array.h"

namespace sg::openfoam {

/// The path itself, or with ".gz" behind it; "" when neither is there.
std::string existing(const std::string& path);

class FoamFile {
 public:
  /// Opens `path` or `path`.gz and reads the FoamFile header. Throws Error(data).
  explicit FoamFile(const std::string& path);
  /// Whether a file begins like one with a header (after comments); false for files that cannot be read.
  static bool has_header(const std::string& path);

  const std::string& path() const { return path_; }
  const std::string& class_name() const { return class_; }
  bool binary() const { return binary_; }
  /// The type of the real numbers of the list that follows.
  ElementType list_type() { return !binary_ ? text_type() : scalar_bytes_ == 8 ? ElementType::f64 : ElementType::f32; }
  [[noreturn]] void fail(const std::string& problem, const std::string& hint = {}) const;

  /// The next word, "string", or one of ( ) { } [ ] ; — comments are passed over; "" at the end.
  std::string_view next();
  std::string_view peek();
  void expect(std::string_view token, std::string_view what);
  /// Behind a keyword: to the end of its entry, a ';' or a dictionary.
  void skip_entry();
  /// Behind a word that begins with '#': the rest of its line. The first one is remembered.
  void skip_directive();
  /// "#include", "$x": the first directive or macro met; "" when there was none.
  const std::string& directive() const { return directive_; }
  void remember_directive(std::string_view word) {
    if (directive_.empty()) directive_ = word;
  }

  size_t count(std::string_view what);
  double real(std::string_view what);
  /// A list of labels: N(...), N{one} or bytes. Throws Error(data) for numbers beyond 2^31.
  std::vector<int32_t> labels(std::string_view what);
  /// A list of tuples: N((x y z) ...), N{(x y z)} or bytes; f32 or f64 as the file says (text: as its digits need).
  Array tuples(int components, std::string_view what);
  /// Faces as lists of labels: begin (count + 1) and ids.
  void faces(std::vector<int64_t>& begin, std::vector<int32_t>& ids);

 private:
  void read_header();
  void skip_blanks();
  std::string_view take_bytes(uint64_t n, uint64_t each, std::string_view what);
  bool open_list(size_t& n, bool& uniform, std::string_view what);
  void close_list(bool uniform, std::string_view what);
  template <class T>
  void read_text(size_t n, int components, T* out, std::string_view what);
  template <class T>
  const char* scan_tuples(const char* p, const char* end, size_t n, int components, T* out) const;
  ElementType text_type();
  void skip_binary_list(std::string_view type);

  std::string path_, class_, directive_;
  MappedFile file_;
  Buffer unpacked_;
  std::shared_ptr<const void> owner_;
  std::string_view text_;
  size_t at_ = 0;
  bool binary_ = false, big_endian_ = false;
  int label_bytes_ = 4, scalar_bytes_ = 8;
  std::optional<ElementType> text_type_;
};

}  // namespace sg::openfoam
