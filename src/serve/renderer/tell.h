// SPDX-License-Identifier: Apache-2.0
// What a window is told of a pipeline: members of the message "state" (docs/protocol.md).
#pragma once
#include <map>
#include <memory>
#include <string>

#include "base/text/json.h"
#include "pipeline/graph/cache.h"
#include "pipeline/graph/request.h"
#include "pipeline/picture/prepare.h"

namespace sg::serve {

/// What each step took when it last ran, by its name.
using StepSeconds = std::map<std::string, double>;

/// "steps", "show", "picture", "lights", "environment", "scene", "times", "time", "bounds", "length_unit", "camera", "notes". Steps run if
/// nothing that is shown has needed them.
Json::Members tell_state(const PipelineFile& file, const PreparedPicture& prepared, const StepSeconds& seconds,
                         const std::shared_ptr<Cache>& cache, Context& context);

/// The same of a pipeline that cannot be run: steps, what is shown, picture, lights and nodes as they stand.
Json::Members tell_pipeline(const PipelineFile& file);

Json text(std::string s);
Json list(const std::vector<std::string>& texts);
/// Null for what is not finite, which JSON cannot hold.
Json number(double v);
Json numbers(std::initializer_list<double> values);
/// A word without a value is a switch that is on.
Json words_json(const std::vector<std::string>& words);

/// The result of a step, or what is requested of it, from the cache where it is there. Throws as running it does; Error(usage) for an
/// unknown name.
Data result_of(const PipelineFile& file, const std::string& step, const std::shared_ptr<Cache>& cache, Context& context,
               const Request& request = {});

}  // namespace sg::serve
