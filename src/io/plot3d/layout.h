// SPDX-License-Identifier: Apache-2.0
// PLOT3D files do not describe themselves: byte order, record marks, precision, dimensions, blanking and the number of grids are
// found by trying every combination against the length of the file. Source: Walatka, Buning, Pierce, Elson, "PLOT3D User's Manual",
// NASA TM 101067 (1990), chapter 8.
//
//   [ngrids]  nx ny [nz] ...  | grid:     x.. y.. [z..] [iblank..]                 per grid
//                             | solution: mach alpha re time, then 5 (2D: 4) fields
//                             | function: nvar more number per grid in the header, then nvar fields
//   Fortran: each of [ngrids], the sizes, and each grid's data (a solution's four conditions apart) is a record between its lengths.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/file/file.h"
#include "data/array.h"

namespace sg::plot3d {

enum class Kind { grid, solution, function };

struct Layout {
  bool text = false, big_endian = false, records = false, multi = false, iblank = false;
  int dimensions = 3;                        ///< 2 or 3
  int real_bytes = 4;                        ///< 4 or 8
  std::vector<std::array<size_t, 3>> sizes;  ///< points per axis of each grid
  std::vector<int> fields;                   ///< of each grid: 5 (2D: 4) of a solution, nvar of a function
  std::vector<size_t> begin;                 ///< place of each grid's first real number: byte; in text, the number before it
  std::string describe() const;
};

/// A file's bytes, or all numbers of a text.
class Numbers {
 public:
  explicit Numbers(MappedFile file);
  /// The same without a file behind it, for a look.
  explicit Numbers(std::span<const std::byte> bytes);
  bool is_text() const { return text_; }
  const std::string& path() const { return file_.path(); }

  size_t size() const { return text_ ? values_.count() : bytes_.size(); }
  /// Bytes or numbers (text) that an integer and a real number take.
  size_t integer_size() const { return text_ ? 1 : 4; }
  size_t real_size(const Layout& l) const { return text_ ? 1 : size_t(l.real_bytes); }
  std::optional<int64_t> integer(size_t at, bool big_endian) const;
  double real(const Layout& l, size_t at) const;
  /// Only zeros are left, which fill the file to a whole number of blocks of 512 bytes.
  bool is_padding(size_t at) const;
  /// `count` reals from `at` on into every `stride`-th place of out (f32 or f64, `type`).
  void copy(const Layout& l, size_t at, size_t count, ElementType type, std::byte* out, size_t stride) const;
  ElementType type(const Layout& l) const { return text_ ? text_type_ : l.real_bytes == 8 ? ElementType::f64 : ElementType::f32; }

 private:
  void look();
  MappedFile file_;
  std::span<const std::byte> bytes_;
  bool text_ = false;
  Array values_;
  ElementType text_type_ = ElementType::f32;
};

/// The layout that fits length and content, or nothing. For solutions and functions `sizes` must be those of the grid.
std::optional<Layout> find_layout(const Numbers& numbers, Kind kind, const Layout* grid = nullptr);

}  // namespace sg::plot3d
