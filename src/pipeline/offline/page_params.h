// SPDX-License-Identifier: Apache-2.0
// Parameters of a page besides its pipeline and its picture; in a pipeline file they are under `picture`.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "base/schema/schema.h"
#include "pipeline/file/pipeline_file.h"

namespace sg {

struct PageParams {
  std::string max = "8M";
};
void describe(Schema& s, PageParams& p);

/// Bytes that the page may have. Throws Error(usage) for what is no amount.
uint64_t page_budget(const PageParams& params);

/// Words under `picture` that are parameters of a page.
bool is_page_word(std::string_view word);
/// Takes what a pipeline file says about a page out of the file. Throws Error(usage).
void take_page_words(PipelineFile& file, PageParams& params);

}  // namespace sg
