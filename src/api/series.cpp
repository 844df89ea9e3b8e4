// SPDX-License-Identifier: Apache-2.0
// Data over time: series that the program makes, and the steps of any.
#include <fmt/format.h>

#include "api/held.h"
#include "io/io.h"
#include "io/options.h"
#include "pipeline/file/pipeline_file.h"
#include "pipeline/operation/operation.h"

namespace sightglass {

namespace {

// Of the first series above.
std::vector<double> times_above(const Made& made, sg::Context& context) {
  if (sg::step_kind(made.operation) == sg::StepKind::read) return open_times(made, context);
  for (const auto& input : made.inputs)
    if (auto times = times_above(*input, context); !times.empty()) return times;
  return {};
}

// The same steps with the time stated where they follow it; null where none does.
std::shared_ptr<const Made> made_at(const std::shared_ptr<const Made>& made, double time, sg::Context& context) {
  auto there = std::make_shared<Made>(*made);
  bool moves = false;
  for (auto& input : there->inputs)
    if (auto moved = made_at(input, time, context)) input = std::move(moved), moves = true;
  const sg::StepKind kind = sg::step_kind(made->operation);
  bool follows = kind == sg::StepKind::read && !times_above(*made, context).empty();
  if (kind == sg::StepKind::operation) {
    const sg::Operation& operation = sg::find_operation(made->operation);
    const sg::ParamDecl* d = sg::make_params(operation, made->words).schema.find("time");
    follows = (operation.run_series || operation.shows_moment || made->inputs.empty()) && d && !d->stated;
  }
  if (follows) there->words.push_back(fmt::format("time={}", time));
  return moves || follows ? there : nullptr;
}

}  // namespace

Data series(std::vector<double> times, std::function<Data(size_t step)> load, const Context& context) {
  return guarded([&] {
    const auto step = [load = std::move(load)](size_t number, sg::Context&) -> sg::Data {
      try {
        return held_by(load(number)).data;
      } catch (const sg::Error&) {
        throw;
      } catch (const std::exception& e) {
        throw Foreign(fmt::format("step {} of the series: {}", number, e.what()), std::current_exception());
      }
    };
    auto made = std::make_shared<Made>();
    made->lent = std::make_shared<const sg::LentSeries>(std::move(times), step);
    made->operation = "read";
    made->words = {"path=" + made->lent->path()};
    sg::Data first = sg::read_data(made->lent->path(), {}, context.state().core);
    return make_data(std::move(first), std::move(made));
  });
}

std::optional<double> Data::time() const {
  return guarded([&] {
    std::optional<double> time;
    sg::for_each_dataset(held_by(*this).data, [&](const std::string&, const sg::DatasetPtr& d) {
      if (!time) time = d->time();
    });
    return time;
  });
}

std::vector<double> Data::times(const Context& context) const {
  return guarded([&] { return times_above(*held_by(*this).made, context.state().core); });
}

Data Data::at(double time, const Context& context) const {
  return guarded([&] {
    Noting noting(context);
    const auto made = made_at(held_by(*this).made, time, noting.core);
    if (!made) sg::fail_usage("does not come from a time series", "at()", "read a series, or make one with series()");
    sg::Data data = run_steps(made, "at()", noting.core);
    return make_data(std::move(data), made, std::move(noting.notes));
  });
}

}  // namespace sightglass
