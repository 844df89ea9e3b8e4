// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/questions/rows.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "base/text/text.h"
#include "data/cells/point_positions.h"
#include "serve/renderer/questions/place_values.h"
#include "serve/renderer/tell.h"

namespace sg::serve {

namespace {

constexpr size_t most_rows = 500;

struct Wanted {
  size_t from, count;
};

Json::Members rows_json(size_t total, const std::vector<std::string>& columns, std::vector<Json> rows) {
  return {{"total", Json(uint64_t(total))}, {"columns", list(columns)}, {"rows", Json(std::move(rows))}};
}

Json::Members rows_of_table(const Table& table, Wanted wanted) {
  std::vector<std::string> columns;
  size_t total = 0;
  for (const Field& f : table.columns) columns.push_back(f.name), total = f.array.count();
  std::vector<Json> rows;
  for (size_t i = wanted.from; i < std::min(total, wanted.from + wanted.count); ++i) {
    std::vector<std::string> row;
    for (size_t c = 0; c < columns.size(); ++c) {
      const auto* words = table.words(c);
      const double index = words ? table.columns[c].array.get(i) : -1;
      if (words) row.push_back(index >= 0 ? (*words)[size_t(index)] : "");
      else row.push_back(value_text(table.columns[c].array, i));
    }
    rows.push_back(list(row));
  }
  return rows_json(total, columns, std::move(rows));
}

Json::Members rows_of_parts(const std::vector<std::pair<std::string, DatasetPtr>>& parts, Association on, Wanted wanted) {
  const bool places = on == Association::point, several = parts.size() > 1;
  std::vector<std::string> names;  // of the fields of all parts
  for (const auto& [part, d] : parts)
    for (const Field& f : d->fields())
      if (f.association == on && std::find(names.begin(), names.end(), f.name) == names.end()) names.push_back(f.name);
  std::vector<Json> rows;
  size_t total = 0;
  for (const auto& [part, d] : parts) {
    const size_t before = total, count = places ? d->point_count() : d->cell_count();
    total += count;
    const size_t begin = std::max(wanted.from, before), end = std::min(total, wanted.from + wanted.count);
    if (begin >= end) continue;
    const Array points = places ? point_positions(d->mesh()) : Array();
    std::vector<const Field*> fields;
    for (const std::string& name : names) fields.push_back(d->fields().find(name, on));
    for (size_t i = begin - before; i < end - before; ++i) {
      std::vector<std::string> row;
      if (several) row.push_back(part);
      for (int a = 0; places && a < 3; ++a) row.push_back(short_number(points.get(i, a)));
      for (const Field* f : fields) row.push_back(f ? value_text(f->array, i) : "");
      rows.push_back(list(row));
    }
  }
  std::vector<std::string> columns;
  if (several) columns.emplace_back("part");
  if (places) columns.insert(columns.end(), {"x", "y", "z"});
  columns.insert(columns.end(), names.begin(), names.end());
  return rows_json(total, columns, std::move(rows));
}

}  // namespace

Json::Members answer_rows(const Json& q, const Data& data) {
  const Wanted wanted{q["from"].whole(), std::min<size_t>(q["count"].whole(), most_rows)};
  if (const auto* table = std::get_if<TablePtr>(&data)) return rows_of_table(**table, wanted);
  std::vector<std::pair<std::string, DatasetPtr>> parts;
  for_each_dataset(data, [&](const std::string& name, const DatasetPtr& d) { parts.emplace_back(name, d); });
  if (parts.empty()) return rows_json(0, {}, {});
  const bool cells = q["on"].text() == association_name(Association::cell);
  return rows_of_parts(parts, cells ? Association::cell : Association::point, wanted);
}

}  // namespace sg::serve
