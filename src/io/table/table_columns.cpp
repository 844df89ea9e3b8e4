// SPDX-License-Identifier: Apache-2.0
#include "io/table/table_columns.h"

#include <fmt/core.h>

#include <algorithm>
#include <unordered_map>

#include "base/text/text.h"

namespace sg {

bool is_missing(std::string_view word) {
  for (std::string_view none : {"", "NA", "N/A", "n/a", "NaN", "nan", "NAN", "null", "NULL", "none", "None"})
    if (word == none) return true;
  return false;
}

TableBuilder::Column& TableBuilder::column(size_t i) {
  while (columns_.size() <= i) columns_.push_back({fmt::format("column{}", columns_.size() + 1), {}});
  return columns_[i];
}

void TableBuilder::name_columns(const std::vector<std::string_view>& names) {
  for (size_t i = 0; i < names.size(); ++i)
    if (!trim(names[i]).empty()) column(i).name = std::string(names[i]);
    else (void)column(i);
}

// Every row with columns of its own would make a table of nothing but holes, a thousand times the size of the file.
void TableBuilder::check_holes(uint64_t columns, uint64_t per_cell) const {
  if (columns * rows_ > per_cell * given_ + (uint64_t(1) << 20))
    fail_data(fmt::format("has more than {} columns in {} rows, nearly all of them empty", columns, rows_), "table");
}

void TableBuilder::add_row(const std::vector<std::string_view>& cells) {
  begin_row();
  given_ += cells.size();
  check_holes(std::max(columns_.size(), cells.size()), 16);
  for (size_t i = 0; i < cells.size(); ++i) {
    Column& c = column(i);
    c.cells.resize(rows_);
    c.cells.back() = std::string(cells[i]);
  }
}

void TableBuilder::set(const std::string& name, std::string value) {
  size_t i = 0;
  while (i < columns_.size() && columns_[i].name != name) ++i;
  ++given_;
  if (i == columns_.size()) check_holes(i, 64);
  Column& c = column(i);
  c.name = name;
  c.cells.resize(rows_);
  c.cells.back() = std::move(value);
}

namespace {

Array words_column(const std::vector<std::string>& cells, std::vector<std::string>& labels) {
  std::unordered_map<std::string, int32_t> place;
  std::vector<int32_t> v;
  v.reserve(cells.size());
  for (const std::string& cell : cells) {
    if (cell.empty()) {
      v.push_back(-1);
      continue;
    }
    const auto [at, fresh] = place.emplace(cell, int32_t(labels.size()));
    if (fresh) labels.push_back(cell);
    v.push_back(at->second);
  }
  return Array::from_vector(std::move(v));
}

// Numbers when every cell that is there is one; an empty Array otherwise.
Array number_column(const std::vector<std::string>& cells) {
  std::vector<double> v;
  std::vector<int64_t> whole;
  v.reserve(cells.size());
  bool missing = false, any = false;
  for (const std::string& cell : cells) {
    const std::string_view word = trim(cell);
    if (is_missing(word)) {
      missing = true;
      any = any || to_lower(word) == "nan";  // claimed to be a number but is not
      v.push_back(std::nan(""));
      continue;
    }
    const auto x = parse_double(word);
    if (!x) return {};
    any = true;
    v.push_back(*x);
    if (const auto n = parse_int(word); n && (*n != 0 || !std::signbit(*x))) whole.push_back(*n);  // no whole number is -0
  }
  if (!any) return {};
  if (missing || whole.size() != v.size()) return Array::from_vector(std::move(v));
  const auto [lo, hi] = std::minmax_element(whole.begin(), whole.end());
  if (*lo < INT32_MIN || *hi > INT32_MAX) return Array::from_vector(std::move(whole));
  return Array::from_vector(std::vector<int32_t>(whole.begin(), whole.end()));
}

}  // namespace

TablePtr TableBuilder::build() {
  auto table = std::make_shared<Table>();
  std::unordered_map<std::string, int> seen;
  for (Column& c : columns_) {
    c.cells.resize(rows_);
    if (const int n = ++seen[c.name]; n > 1) c.name += fmt::format("_{}", n);
    std::vector<std::string> labels;
    Array a = number_column(c.cells);
    if (a.empty() && rows_ > 0) a = words_column(c.cells, labels);
    if (labels.empty() && a.type() == ElementType::i32 && a.count() > 0 && a.get(0) == -1 && number_column(c.cells).empty())
      labels.push_back("");  // a column without any cell is one of words
    c.cells = {};
    table->columns.push_back({c.name, Association::whole, std::move(a), "", Role::none});
    table->labels.push_back(std::move(labels));
  }
  return table;
}

}  // namespace sg
