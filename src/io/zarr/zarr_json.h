// SPDX-License-Identifier: Apache-2.0
// Private to src/io/zarr: JSON files that may be damaged.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/text/json.h"

namespace sg::zarr {

/// Nothing when the file is not there. Throws Error(data) for what is not a JSON object, is nested deeper than 64 or larger than 16 MiB.
std::optional<Json> read_json(const std::string& path);

/// A list of `n` whole numbers from `least` on (any number of them for n = 0). Throws Error(data) naming path and key.
std::vector<size_t> whole_numbers(const Json& object, const char* key, size_t n, size_t least, const std::string& path);
/// The text under the key, or `otherwise` when it is missing or no text.
std::string text_of(const Json& object, const char* key, const std::string& otherwise);
/// The object under the key; null for none.
const Json* object_of(const Json& object, const char* key);
const Json* list_of(const Json& object, const char* key);

}  // namespace sg::zarr
