// SPDX-License-Identifier: Apache-2.0
// Tables out of words: each column becomes numbers when all of its words are numbers.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "data/dataset.h"

namespace sg {

/// Collects cells column by column. Missing ones are "".
class TableBuilder {
 public:
  /// Cells of one row, in the order of the columns; more cells than columns make new columns. Throws Error(data) when most of the table
  /// would be empty.
  void add_row(const std::vector<std::string_view>& cells);
  /// Sets a cell of the current last row of a named column (made when it is new). Throws Error(data) when there are so many columns that
  /// most of the table would be empty.
  void set(const std::string& column, std::string value);
  void begin_row() { ++rows_; }
  /// An empty name leaves that of its number.
  void name_columns(const std::vector<std::string_view>& names);
  size_t rows() const { return rows_; }

  /// Columns of words become i32 places in their labels (in order of appearance); of whole numbers i32, i64 where they need it; of
  /// numbers, or with cells missing ("", NA, NaN, null, none), f64. Names are made unique.
  TablePtr build();

 private:
  struct Column {
    std::string name;
    std::vector<std::string> cells;
  };
  Column& column(size_t i);
  void check_holes(uint64_t columns, uint64_t per_cell) const;
  std::vector<Column> columns_;
  size_t rows_ = 0;
  uint64_t given_ = 0;  ///< cells that were given
};

/// A cell that stands for a missing value.
bool is_missing(std::string_view word);

}  // namespace sg
