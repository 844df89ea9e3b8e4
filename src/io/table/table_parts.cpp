// SPDX-License-Identifier: Apache-2.0
#include "io/table/table_parts.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"

namespace sg {

namespace {

struct NamedTable {
  std::string name;
  TablePtr table;
};

void gather_tables(const Collection& c, const std::string& above, std::vector<NamedTable>& all) {
  for (const Collection::Part& part : c.parts) {
    const std::string name = above.empty() ? part.name : above + "/" + part.name;
    if (const auto* t = std::get_if<TablePtr>(&part.data)) all.push_back({name, *t});
    if (const auto* inner = std::get_if<CollectionPtr>(&part.data)) gather_tables(**inner, name, all);
  }
}

size_t rows_of(const Table& t) { return t.columns.empty() ? 0 : t.columns[0].array.count(); }

// Words by their place among those of all tables.
Array joined_words(const std::vector<NamedTable>& all, size_t column, std::vector<std::string>& labels) {
  std::vector<int32_t> places;
  for (const NamedTable& t : all) {
    const std::vector<std::string>& own = *t.table->words(column);
    for (size_t r = 0; r < rows_of(*t.table); ++r) {
      const double at = t.table->columns[column].array.get(r);
      const std::string word = at >= 0 && size_t(at) < own.size() ? own[size_t(at)] : "";
      const auto found = std::find(labels.begin(), labels.end(), word);
      places.push_back(int32_t(found - labels.begin()));
      if (found == labels.end()) labels.push_back(word);
    }
  }
  return Array::from_vector(std::move(places));
}

template <class T>
Array joined_numbers(const std::vector<NamedTable>& all, size_t column, int components) {
  std::vector<T> numbers;
  for (const NamedTable& t : all)
    for (size_t r = 0; r < rows_of(*t.table); ++r)
      for (int c = 0; c < components; ++c) numbers.push_back(T(t.table->columns[column].array.get(r, c)));
  return Array::from_vector(std::move(numbers), components);
}

bool same_columns(const Table& a, const Table& b) {
  if (a.columns.size() != b.columns.size()) return false;
  for (size_t i = 0; i < a.columns.size(); ++i) {
    const Field &f = a.columns[i], &g = b.columns[i];
    if (f.name != g.name || f.components() != g.components() || !a.words(i) != !b.words(i)) return false;
  }
  return true;
}

}  // namespace

bool all_tables(const Data& data) {
  if (std::holds_alternative<TablePtr>(data)) return true;
  const auto* c = std::get_if<CollectionPtr>(&data);
  return c && !(*c)->parts.empty() &&
         std::all_of((*c)->parts.begin(), (*c)->parts.end(), [](const Collection::Part& p) { return all_tables(p.data); });
}

TablePtr joined_tables(const Collection& collection) {
  std::vector<NamedTable> all;
  gather_tables(collection, "", all);
  auto table = std::make_shared<Table>();
  if (all.empty()) return table;
  std::vector<int32_t> parts;
  std::vector<std::string> names;
  for (const NamedTable& t : all) {
    if (!same_columns(*t.table, *all[0].table))
      fail_usage(fmt::format("the tables '{}' and '{}' have different columns", all[0].name, t.name), "writing a table",
                 "take one: -f 'extract part=NAME' before it");
    parts.insert(parts.end(), rows_of(*t.table), int32_t(names.size()));
    names.push_back(t.name);
  }
  table->columns.push_back({"part", Association::whole, Array::from_vector(std::move(parts)), "", Role::none});
  table->labels.push_back(std::move(names));
  for (size_t i = 0; i < all[0].table->columns.size(); ++i) {
    Field column = all[0].table->columns[i];
    std::vector<std::string> labels;
    const bool whole =
        std::all_of(all.begin(), all.end(), [&](const NamedTable& t) { return !is_float(t.table->columns[i].array.type()); });
    if (all[0].table->words(i)) column.array = joined_words(all, i, labels);
    else if (whole) column.array = joined_numbers<int64_t>(all, i, column.components());
    else column.array = joined_numbers<double>(all, i, column.components());
    table->columns.push_back(std::move(column));
    table->labels.push_back(std::move(labels));
  }
  return table;
}

}  // namespace sg
