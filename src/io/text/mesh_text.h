// SPDX-License-Identifier: Apache-2.0
// What readers of unstructured meshes share: words and numbers of a text one after the other, and lists of cells that grow.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "data/dataset.h"

namespace sg {

/// Reads words and numbers of a text in order. Errors name the file and the line.
class TextCursor {
 public:
  /// With `comment` != 0 a word that begins with it, and the rest of its line, count as blank.
  TextCursor(std::string_view text, std::string where, char comment = 0)
      : base_(text.data()), p_(text.data()), end_(text.data() + text.size()), where_(std::move(where)), comment_(comment) {}

  /// No word is left.
  bool at_end();
  /// The next word, "" at the end. peek() does not move.
  std::string_view word();
  std::string_view peek();
  /// The next word as a number; fails with `what` was expected.
  double number(const char* what);
  int64_t integer(const char* what);
  /// A whole number >= 0 of things that need at least `bytes_each` bytes of the text behind it; fails for more than the text backs.
  size_t count(const char* what, size_t bytes_each = 2);
  /// An integer in [first, first + n), returned less `first`.
  int64_t index(const char* what, int64_t first, int64_t n);
  /// Words that must come next; fails otherwise.
  void expect(std::string_view word);
  /// From here to the end of the line, trimmed, and moves behind it.
  std::string_view line();
  /// Moves to the begin of the next line that holds more than blanks and comments.
  void skip_empty_lines();

  size_t position() const { return size_t(p_ - base_); }
  void seek(size_t position) { p_ = base_ + std::min(position, size_t(end_ - base_)); }
  size_t left() const { return size_t(end_ - p_); }
  std::string_view text() const { return {base_, size_t(end_ - base_)}; }
  size_t line_now() const;
  const std::string& where() const { return where_; }
  [[noreturn]] void fail(const std::string& what, const std::string& hint = {}) const;

 private:
  void skip();
  const char *base_, *p_, *end_;
  std::string where_;
  char comment_;
};

/// Cells of any type, one after the other.
class MixedCells {
 public:
  void add(CellType type, std::span<const int64_t> points);
  size_t size() const { return types_.size(); }
  void reserve(size_t cells, size_t ids) { types_.reserve(cells), offsets_.reserve(cells + 1), ids_.reserve(ids); }
  /// Moves the cells into a mesh; equal sizes and equal types become `fixed` and `single_type`. `number` (may be null) replaces
  /// each point id.
  void finish(UnstructuredMesh& mesh, const std::vector<int64_t>* number = nullptr);

 private:
  std::vector<uint8_t> types_;
  std::vector<int64_t> offsets_{0}, ids_;
};

/// Places of things by their tags: direct where the tags are dense, else hashed.
class TagIndex {
 public:
  explicit TagIndex(const std::vector<int64_t>& tags);
  /// -1 for a tag that is not there.
  int64_t find(int64_t tag) const;

 private:
  int64_t first_ = 0;
  std::vector<int64_t> direct_;
  std::unordered_map<int64_t, int64_t> hashed_;
};

/// Lattice places (i, j, k) of the nodes of a Lagrange or Bezier cell of order n, in the order in which VTK lists them. `shape` is the
/// linear type: line, triangle, quad, tetra, hexahedron, wedge; pyramids of order 1 only, (0,0,1) is the apex.
std::vector<std::array<int, 3>> lattice_places(CellType shape, int n);
/// The type of a cell of that shape and order: linear for 1, Lagrange above.
CellType lagrange_type(CellType shape, int n);
/// Bezier of any order (of order 1 too).
CellType bezier_type(CellType shape);

/// A cell field of material, group or part numbers.
Field cell_ids(std::string name, std::vector<int32_t> ids);

}  // namespace sg
