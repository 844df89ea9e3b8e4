// SPDX-License-Identifier: Apache-2.0
// Whether two pipelines make the same picture.
#pragma once
#include <string>

#include "pipeline/file/pipeline_file.h"

namespace sg::serve {

/// All but what a window keeps in the file for itself.
inline PipelineFile without_window_words(PipelineFile file) {
  std::erase_if(file.picture, [](const std::string& w) { return w.starts_with("measurements="); });
  return file;
}
inline bool make_same_picture(const PipelineFile& a, const PipelineFile& b) { return without_window_words(a) == without_window_words(b); }

}  // namespace sg::serve
