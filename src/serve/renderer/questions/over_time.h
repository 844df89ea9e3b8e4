// SPDX-License-Identifier: Apache-2.0
// A field at one place and one time.
#pragma once
#include <memory>
#include <string>

#include "base/text/json.h"
#include "pipeline/file/pipeline_file.h"
#include "pipeline/graph/cache.h"

namespace sg::serve {

/// "value" (of several components the magnitude; null outside) and "unit" of a step of a pipeline at a place: only what the step needs is
/// computed. Inside of solids as their cells have it; on surfaces, curves and clouds, and where rounding has
/// moved the place out of a solid, as the nearest point within a hundredth of the data's size. Throws Error(usage) for steps and fields
/// that are not there, and as running the step does.
Json::Members answer_at_a_time(const Json& question, const PipelineFile& file, const std::shared_ptr<Cache>& cache, Context& context);

}  // namespace sg::serve
