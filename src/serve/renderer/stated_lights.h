// SPDX-License-Identifier: Apache-2.0
// The lights that a picture states, and what it states of the environment. Throw Error(usage) for a quote that is not closed.
#pragma once
#include "pipeline/file/pipeline_file.h"
#include "scene/light/light_text.h"

namespace sg::serve {

inline constexpr std::string_view lights_word = "lights", environment_word = "environment";

inline std::vector<LightText> stated_lights(const PipelineFile& file) {
  return lights_of_text(word_value(file.picture, lights_word).value_or(""));
}
inline std::optional<LightText> stated_environment(const PipelineFile& file) {
  return environment_of_text(word_value(file.picture, environment_word).value_or(""));
}

}  // namespace sg::serve
