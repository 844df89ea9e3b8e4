// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <cstdint>

#include "base/file/file.h"
#include "io/zarr/zarr_json.h"

namespace sg::zarr {

namespace {
constexpr int deepest = 64;
constexpr size_t longest = size_t(16) << 20;
}  // namespace

std::optional<Json> read_json(const std::string& path) {
  if (!file_exists(path)) return std::nullopt;
  const MappedFile file(path);
  if (file.size() > longest) fail_data(fmt::format("has {} bytes", file.size()), path, "a description of an array is smaller than 16 MiB");
  bool too_deep = false;
  const Json::parser_callback_t shallow = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > deepest) too_deep = true;
    return !too_deep;
  };
  // NaN and Infinity as bare words, which Python writes, are no JSON; the standard says "NaN" in quotes.
  Json json;
  try {
    json = Json::parse(file.text().begin(), file.text().end(), shallow);
  } catch (const Json::exception& e) {
    fail_data(fmt::format("is no JSON: {}", std::string(e.what()).substr(0, 200)), path);
  }
  if (too_deep) fail_data(fmt::format("is nested deeper than {}", deepest), path);
  if (!json.is_object()) fail_data("is no JSON object", path);
  return json;
}

std::vector<size_t> whole_numbers(const Json& object, const char* key, size_t n, size_t least, const std::string& path) {
  const Json* list = list_of(object, key);
  if (!list) fail_data(fmt::format("has no list '{}'", key), path);
  if (n > 0 && list->size() != n) fail_data(fmt::format("'{}' has {} numbers, not {}", key, list->size(), n), path);
  std::vector<size_t> out;
  for (const Json& v : *list) {
    if (!v.is_number_unsigned() || v.get<uint64_t>() < least || v.get<uint64_t>() > (uint64_t(1) << 60))
      fail_data(fmt::format("'{}' holds {}, not a whole number from {} on", key, v.dump().substr(0, 40), least), path);
    out.push_back(v.get<size_t>());
  }
  return out;
}

std::string text_of(const Json& object, const char* key, const std::string& otherwise) {
  const auto it = object.find(key);
  return it != object.end() && it->is_string() ? it->get<std::string>() : otherwise;
}

const Json* object_of(const Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto it = object.find(key);
  return it != object.end() && it->is_object() ? &*it : nullptr;
}

const Json* list_of(const Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto it = object.find(key);
  return it != object.end() && it->is_array() ? &*it : nullptr;
}

}  // namespace sg::zarr
