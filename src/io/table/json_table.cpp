// SPDX-License-Identifier: Apache-2.0
// Tables as JSON: a list of objects (one per row), an object of equally long lists (one per column), several lists of objects under
// names (a Collection of tables), or a grid as {"width", "height", "values"}.
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "base/file/file.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/table/table_columns.h"

namespace sg {

namespace {

using nlohmann::ordered_json;

constexpr int deepest = 64;

// A cell as the word that a table would show; nested values as their JSON text.
std::string word_of(const ordered_json& v) {
  if (v.is_null()) return "";
  if (v.is_string()) return v.get<std::string>();
  if (v.is_boolean()) return v.get<bool>() ? "1" : "0";
  if (v.is_number_float()) return exact_number(v.get<double>());
  return v.dump();
}

bool is_rows(const ordered_json& v) {
  if (!v.is_array() || v.empty()) return false;
  for (const auto& row : v)
    if (!row.is_object()) return false;
  return true;
}

TablePtr table_of_rows(const ordered_json& rows) {
  TableBuilder b;
  for (const auto& row : rows) {
    b.begin_row();
    for (const auto& [name, value] : row.items()) b.set(name, word_of(value));
  }
  return b.build();
}

bool is_columns(const ordered_json& v) {
  if (!v.is_object() || v.empty()) return false;
  const size_t n = v.begin()->size();
  for (const auto& column : v)
    if (!column.is_array() || column.size() != n || is_rows(column)) return false;
  return true;
}

TablePtr table_of_columns(const ordered_json& columns) {
  TableBuilder b;
  const size_t n = columns.begin()->size();
  for (size_t r = 0; r < n; ++r) {
    b.begin_row();
    for (const auto& [name, values] : columns.items()) b.set(name, word_of(values[r]));
  }
  return b.build();
}

// {"width": 87, "height": 61, "values": [...]}, rows from the top as in a picture.
Data grid_of(const ordered_json& v, const std::string& path) {
  const auto width = v["width"].get<size_t>(), height = v["height"].get<size_t>();
  const ordered_json& values = v["values"];
  if (width == 0 || height == 0 || values.size() / width != height || values.size() % width != 0)
    fail_data(fmt::format("has {} values for {} x {}", values.size(), width, height), path);
  std::vector<double> z;
  for (const auto& x : values) z.push_back(x.is_number() ? x.get<double>() : std::nan(""));
  DatasetParts parts;
  UniformGrid g;
  g.dims = {width, height, 1};
  parts.mesh = g;
  parts.fields.add({"values", Association::point, Array::from_vector(std::move(z)), "", Role::scalars});
  return make_dataset(std::move(parts));
}

bool is_grid(const ordered_json& v) {
  return v.is_object() && v.contains("width") && v.contains("height") && v.contains("values") && v["width"].is_number_unsigned() &&
         v["height"].is_number_unsigned() && v["values"].is_array();
}

Data data_of(const ordered_json& v, const std::string& path) {
  if (is_rows(v)) return table_of_rows(v);
  if (is_grid(v)) return grid_of(v, path);
  if (is_columns(v)) return table_of_columns(v);
  auto parts = std::make_shared<Collection>();
  if (v.is_object())
    for (const auto& [name, part] : v.items())
      if (is_rows(part)) parts->parts.push_back({name, table_of_rows(part)});
  if (!parts->parts.empty()) return CollectionPtr(parts);
  fail_data("is JSON, but no table", path, "a table is a list of objects, or an object of equally long lists; colour maps go to --map");
}

}  // namespace

Data read_json(const std::string& path, const ReadOptions&, Context&) {
  const MappedFile file(path);
  const std::string_view text = file.text();
  bool too_deep = false;
  // The parser builds values on its own stack, but they are freed by recursion: depth is limited while parsing.
  auto watch = [&](int depth, ordered_json::parse_event_t, ordered_json&) {
    if (depth > deepest) too_deep = true;
    return !too_deep;
  };
  try {
    const ordered_json v = ordered_json::parse(text.begin(), text.end(), watch);
    if (too_deep) fail_data(fmt::format("is nested more than {} deep", deepest), path);
    return data_of(v, path);
  } catch (const nlohmann::json::exception& e) {
    if (too_deep) fail_data(fmt::format("is nested more than {} deep", deepest), path);
    fail_data(fmt::format("is no valid JSON: {}", e.what()), path);
  }
}

}  // namespace sg
