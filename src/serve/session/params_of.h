// SPDX-License-Identifier: Apache-2.0
// The parameters that the words of a pipeline's parts set.
#pragma once
#include "io/options.h"
#include "pipeline/file/pipeline_file.h"
#include "pipeline/operation/operation.h"
#include "pipeline/picture/picture.h"
#include "scene/show/show.h"

namespace sg::serve {

inline ParamSet params_of_step(const PipelineFile::Step& step) {
  if (step.reads()) return make_param_set<ReadParams>();
  return find_operation(step.operation).make_params();
}
inline ParamSet params_of_show(const std::string& kind) {
  if (kind == auto_show) return make_param_set<ColoringParams>();
  return find_show(kind).make_params();
}

}  // namespace sg::serve
