// SPDX-License-Identifier: Apache-2.0
#include "pipeline/offline/page_params.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"

namespace sg {

void describe(Schema& s, PageParams& p) {
  s("max", p.max,
    "Pages (-o scene.html): the most bytes that the file may have, e.g. 8M or 500K. What has to be made coarser for that is told: numbers "
    "of fewer bits first, then volumes of fewer voxels, surfaces of fewer triangles, and fewer lines, points, glyphs and time steps.");
}

uint64_t page_budget(const PageParams& params) {
  const auto bytes = parse_bytes(params.max);
  if (!bytes || *bytes == 0) fail_usage(fmt::format("'{}' is not an amount of bytes", params.max), "max", "write e.g. 8M or 500K");
  return *bytes;
}

bool is_page_word(std::string_view word) {
  PageParams params;
  return schema_of(params).find(trim(word.substr(0, word.find('=')))) != nullptr;
}

void take_page_words(PipelineFile& file, PageParams& params) {
  const auto mine = std::stable_partition(file.picture.begin(), file.picture.end(), [](const std::string& w) { return !is_page_word(w); });
  Schema schema = schema_of(params);
  set_params(schema, {mine, file.picture.end()}, "picture");
  file.picture.erase(mine, file.picture.end());
}

}  // namespace sg
