// SPDX-License-Identifier: Apache-2.0
// Tables as JSON: a list of objects (one per row), an object of equally long lists (one per column), several lists of objects under
// names (a Collection of tables), or a grid as {"width", "height", "values"}.
#include <fmt/core.h>

#include "base/file/file.h"
#include "base/text/json.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/table/table_columns.h"

namespace sg {

namespace {

// A cell as the word that a table would show; nested values as their JSON text.
std::string word_of(const Json& v) {
  if (v.is_null()) return "";
  if (v.is_text()) return v.text();
  if (v.is_bool()) return v.boolean() ? "1" : "0";
  if (v.is_real()) return exact_number(v.number());
  return v.dump();
}

bool is_rows(const Json& v) {
  if (!v.is_list() || v.empty()) return false;
  for (const Json& row : v.items())
    if (!row.is_object()) return false;
  return true;
}

TablePtr table_of_rows(const Json& rows) {
  TableBuilder b;
  for (const Json& row : rows.items()) {
    b.begin_row();
    for (const auto& [name, value] : row.members()) b.set(name, word_of(value));
  }
  return b.build();
}

bool is_columns(const Json& v) {
  if (!v.is_object() || v.empty()) return false;
  const size_t n = v.members().front().second.size();
  for (const auto& [name, column] : v.members())
    if (!column.is_list() || column.size() != n || is_rows(column)) return false;
  return true;
}

TablePtr table_of_columns(const Json& columns) {
  TableBuilder b;
  const size_t n = columns.members().front().second.size();
  for (size_t r = 0; r < n; ++r) {
    b.begin_row();
    for (const auto& [name, values] : columns.members()) b.set(name, word_of(values[r]));
  }
  return b.build();
}

// {"width": 87, "height": 61, "values": [...]}, rows from the top as in a picture.
Data grid_of(const Json& v, const std::string& path) {
  const size_t width = size_t(v["width"].whole()), height = size_t(v["height"].whole());
  const Json& values = v["values"];
  if (width == 0 || height == 0 || values.size() / width != height || values.size() % width != 0)
    fail_data(fmt::format("has {} values for {} x {}", values.size(), width, height), path);
  std::vector<double> z;
  for (const Json& x : values.items()) z.push_back(x.is_number() ? x.number() : std::nan(""));
  DatasetParts parts;
  UniformGrid g;
  g.dims = {width, height, 1};
  parts.mesh = g;
  parts.fields.add({"values", Association::point, Array::from_vector(std::move(z)), "", Role::scalars});
  return make_dataset(std::move(parts));
}

bool is_grid(const Json& v) { return v["width"].is_whole() && v["height"].is_whole() && v["values"].is_list(); }

Data data_of(const Json& v, const std::string& path) {
  if (is_rows(v)) return table_of_rows(v);
  if (is_grid(v)) return grid_of(v, path);
  if (is_columns(v)) return table_of_columns(v);
  auto parts = std::make_shared<Collection>();
  for (const auto& [name, part] : v.members())
    if (is_rows(part)) parts->parts.push_back({name, table_of_rows(part)});
  if (!parts->parts.empty()) return CollectionPtr(parts);
  fail_data("is JSON, but not a table", path,
            "a table is a list of objects, or an object of lists of equal length; for colour maps use --map");
}

}  // namespace

Data read_json(const std::string& path, const ReadOptions&, Context&) {
  const MappedFile file(path);
  return data_of(parse_json(file.text(), path), path);
}

}  // namespace sg
