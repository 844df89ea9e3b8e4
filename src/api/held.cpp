// SPDX-License-Identifier: Apache-2.0
#include "api/held.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/parallel.h"
#include "data/memory/memory_budget.h"
#include "io/io.h"
#include "io/options.h"
#include "io/plugin.h"
#include "pipeline/catalog/catalog.h"
#include "pipeline/operation/operation.h"

namespace sightglass {

std::string version() { return SG_VERSION; }

Error::Error(Kind kind, std::string text, std::string problem, std::string where, std::string hint)
    : kind_(kind), text_(std::move(text)), problem_(std::move(problem)), where_(std::move(where)), hint_(std::move(hint)) {}
Error::~Error() = default;

static_assert(int(Error::Kind::usage) == int(sg::ErrorKind::usage) && int(Error::Kind::data) == int(sg::ErrorKind::data) &&
              int(Error::Kind::internal) == int(sg::ErrorKind::internal) && int(Error::Kind::cancelled) == int(sg::ErrorKind::cancelled));
static_assert(std::is_same_v<Value::Alternatives, sg::Value>);

Context::Context() : state_(std::make_shared<State>()) {}
void Context::on_progress(std::function<void(double, std::string_view)> f) { state_->core.on_progress = std::move(f); }
void Context::on_message(std::function<void(bool, std::string_view)> f) {
  if (!f) state_->core.on_log = nullptr;
  else
    state_->core.on_log = [f = std::move(f)](sg::LogLevel level, std::string_view text) {
      if (level != sg::LogLevel::debug) f(level == sg::LogLevel::warning, text);
    };
}
void Context::on_picture(std::function<void(const Image&)> f) { state_->picture = std::move(f); }
void Context::cancel() const noexcept { state_->core.cancel(); }
bool Context::cancelled() const noexcept { return state_->core.cancelled(); }

void set_threads(int count) {
  guarded([&] {
    if (count < 0 || count > 4096) sg::fail_usage(fmt::format("{} is not a number of threads", count), "set_threads", "0 to 4096");
    sg::set_thread_count(count);
  });
}

void set_memory_limit(size_t bytes) {
  sg::set_memory_limit(bytes);
  sg::set_plugin_memory(bytes);
}

std::string help(std::string_view operation) {
  return guarded([&] { return sg::ops_help(operation); });
}

std::string catalog_json() {
  return guarded([] { return sg::catalog_json(sg::catalog()); });
}

void set_values(sg::Schema& schema, const Params& params, std::string_view owner) {
  std::vector<sg::Error> mistakes;
  for (const Param& p : params) {
    try {
      sg::set_value(schema, p.name, p.value.alternatives(), owner);
    } catch (const sg::Error& e) {
      mistakes.push_back(e);
    }
  }
  if (mistakes.size() == 1) throw sg::Error(mistakes[0]);
  std::string all;
  for (const sg::Error& e : mistakes) all += (all.empty() ? "" : "; ") + std::string(e.what());
  if (!all.empty()) sg::fail_usage(all);
}

std::vector<std::string> stated_words(const sg::Schema& schema) {
  std::vector<std::string> words;
  for (const sg::ParamDecl& d : schema.decls())
    if (d.stated) words.push_back(d.name + "=" + sg::param_text(d));
  return words;
}

const Data::Held& held_by(const Data& data) {
  if (!data.held()) sg::fail_usage("holds nothing", "sightglass::Data", "assign what read(), source() or a mesh from memory gives");
  return *data.held();
}

Data make_data(sg::Data data, std::shared_ptr<const Made> made, std::vector<std::string> notes) {
  return Data(std::make_shared<const Data::Held>(Data::Held{std::move(data), std::move(made), std::move(notes)}));
}

Data data_from_memory(sg::DatasetPtr data) {
  std::string about = sg::summary(*data);
  return data_from_memory(sg::Data(std::move(data)), std::move(about));
}

Data data_from_memory(sg::Data data, std::string about) {
  auto made = std::make_shared<Made>();
  made->operation = sg::memory_step;
  made->words = {"data=" + std::move(about)};
  auto held = std::make_shared<const Data::Held>(Data::Held{std::move(data), made});
  made->memory = held;
  return Data(std::move(held));
}

std::string StepsOf::add(const std::shared_ptr<const Made>& made) {
  for (const auto& [known, name] : names_)
    if (known == made.get()) return name;
  sg::PipelineFile::Step step;
  for (const auto& input : made->inputs) step.from.push_back(add(input));
  // A step takes the one before it by itself.
  if (step.from.size() == 1 && !file.steps.empty() && step.from[0] == file.steps.back().name) step.from.clear();
  const auto taken = [&](const std::string& name) {
    return std::any_of(file.steps.begin(), file.steps.end(), [&](const auto& s) { return s.name == name; });
  };
  step.name = made->operation;
  for (int n = 2; taken(step.name); ++n) step.name = fmt::format("{}_{}", made->operation, n);
  step.operation = made->operation;
  step.words = made->words;
  names_.emplace_back(made.get(), step.name);
  file.steps.push_back(std::move(step));
  return file.steps.back().name;
}

void add_memory(const std::shared_ptr<const Made>& made, StepsOf& steps, sg::StepResults& results, std::string_view where) {
  for (const auto& input : made->inputs) add_memory(input, steps, results, where);
  if (made->operation != sg::memory_step) return;
  const auto held = made->memory.lock();
  if (!held)
    sg::fail_usage("follows time, and of what lies above it numbers from memory are gone (" + made->words.at(0) + ")", std::string(where),
                   "keep the Data that hold them");
  results.insert_or_assign(steps.add(made), held->data);
}

sg::Data run_steps(const std::shared_ptr<const Made>& made, std::string_view where, sg::Context& context) {
  StepsOf steps;
  steps.add(made);
  sg::StepResults results;
  add_memory(made, steps, results, where);
  const sg::PipelineGraph built = sg::build_graph(steps.file, {}, results);
  return built.graph.evaluate(built.last, {}, context);
}

std::vector<double> open_times(const Made& read, sg::Context& context) {
  sg::ReadParams params;
  sg::Schema schema = sg::schema_of(params);
  sg::set_params(schema, read.words, "read");
  if (params.options.time || params.options.step >= 0) return {};
  return sg::file_times(params.path, params.options, context);
}

}  // namespace sightglass
