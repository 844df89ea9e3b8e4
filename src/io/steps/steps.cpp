// SPDX-License-Identifier: Apache-2.0
#include "io/steps/steps.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "io/steps/numbered_steps.h"

namespace sg {

void StepsWriter::add(const Data& data, Context& context) {
  if (done_ == plan_.times.size()) fail_internal("more steps than planned", "steps");
  write(done_, data, context);
  ++done_;
}

size_t steps_there(const std::vector<double>& times, const std::string& recipe, const StepsPlan& plan, const std::string& path) {
  const char* anew = "leave --resume out to begin it anew, or choose another name";
  if (recipe != plan.recipe) fail_usage("holds a series that was made in another way", path, anew);
  // Formats that keep a step's length instead of the times round them.
  const double close = 1e-9 * (plan.times.back() - plan.times.front());
  for (size_t i = 0; i < times.size(); ++i)
    if (i >= plan.times.size() || !(std::fabs(times[i] - plan.times[i]) <= close))
      fail_usage(fmt::format("step {} is at time {} there, which is none of those to write", i, exact_number(times[i])), path, anew);
  return times.size();
}

bool holds_steps(const std::string& path) { return is_numbered(path) || format_to_write(path).write_steps; }

std::unique_ptr<StepsWriter> write_steps(const std::string& path, StepsPlan plan, const WriteOptions& options, Context& context) {
  if (plan.times.empty()) fail_usage("has no steps to write", path);
  for (size_t i = 1; i < plan.times.size(); ++i)
    if (!(plan.times[i] > plan.times[i - 1]))
      fail_usage(fmt::format("time {} comes after {}", exact_number(plan.times[i]), exact_number(plan.times[i - 1])), path,
                 "write ascending times");
  if (is_numbered(path)) return write_numbered_steps(path, std::move(plan), options, context);
  const Format& format = format_to_write(path);
  if (!format.write_steps)
    fail_usage(fmt::format("{} holds one step", format.name), path,
               fmt::format("number the files: {}_{{n}}.{}; series in one file: .vtkhdf .pvd .ome.zarr",
                           file_name_of(path).substr(0, file_name_of(path).rfind('.')), extension_of(path)));
  return format.write_steps(path, std::move(plan), options, context);
}

}  // namespace sg
