// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cstdint>

#include "base/file/file.h"
#include "io/zarr/zarr_json.h"

namespace sg::zarr {

namespace {
constexpr size_t longest = size_t(16) << 20;
}  // namespace

std::optional<Json> read_json(const std::string& path) {
  if (!file_exists(path)) return std::nullopt;
  const MappedFile file(path);
  if (file.size() > longest) fail_data(fmt::format("has {} bytes", file.size()), path, "array metadata must be smaller than 16 MiB");
  // NaN and Infinity as bare words, which Python writes, are not JSON; the standard says "NaN" in quotes.
  Json json = parse_json(file.text(), path);
  if (!json.is_object()) fail_data("is not a JSON object", path);
  return json;
}

std::vector<size_t> whole_numbers(const Json& object, const char* key, size_t n, size_t least, const std::string& path) {
  const Json* list = list_of(object, key);
  if (!list) fail_data(fmt::format("has no list '{}'", key), path);
  if (n > 0 && list->size() != n) fail_data(fmt::format("'{}' has {} numbers, not {}", key, list->size(), n), path);
  std::vector<size_t> out;
  for (const Json& v : list->items()) {
    if (!v.is_whole() || v.whole() < least || v.whole() > (uint64_t(1) << 60))
      fail_data(fmt::format("'{}' holds {}, not a whole number of at least {}", key, v.dump().substr(0, 40), least), path);
    out.push_back(size_t(v.whole()));
  }
  return out;
}

std::string text_of(const Json& object, const char* key, const std::string& otherwise) {
  return object[key].is_text() ? object[key].text() : otherwise;
}

const Json* object_of(const Json& object, const char* key) {
  const Json* v = object.find(key);
  return v && v->is_object() ? v : nullptr;
}

const Json* list_of(const Json& object, const char* key) {
  const Json* v = object.find(key);
  return v && v->is_list() ? v : nullptr;
}

}  // namespace sg::zarr
