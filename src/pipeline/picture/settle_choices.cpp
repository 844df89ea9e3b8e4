// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/settle_choices.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <set>

#include "base/error.h"
#include "data/fields/sampled_cloud.h"
#include "pipeline/operation/operation.h"
#include "pipeline/picture/picture_parts.h"

namespace sg {

namespace {

// Steps that do the same to different inputs.
std::vector<std::vector<size_t>> steps_alike(const PipelineFile& file) {
  std::vector<std::vector<size_t>> groups;
  std::vector<std::string> root;  // where the data of each step comes from
  for (const PipelineFile::Step& s : file.steps) root.push_back(steps_behind(file, s.name).back()->name);
  for (size_t i = 0; i < file.steps.size(); ++i) {
    const PipelineFile::Step& s = file.steps[i];
    const Operation* op = known_operation(s.operation);
    if (!op || !op->choose || word_value(s.words, op->alike)) continue;
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const std::vector<size_t>& g) {
      const PipelineFile::Step& first = file.steps[g[0]];
      return first.operation == s.operation && first.words == s.words &&
             std::none_of(g.begin(), g.end(), [&](size_t k) { return root[k] == root[i]; });
    });
    if (same != groups.end()) same->push_back(i);
    else groups.push_back({i});
  }
  return groups;
}

// The first input of each of the steps.
std::vector<Data> inputs_of(const PipelineFile& file, const std::vector<size_t>& steps, const GraphOptions& graph,
                            const StepResults& results, Context& context) {
  const PipelineGraph built = build_graph(file, graph, results);
  std::vector<Target> targets;
  for (const size_t i : steps) {
    const PipelineFile::Step& s = file.steps[i];
    const std::string& name = s.from.empty() ? file.steps[i - 1].name : s.from[0];
    const auto node = std::find_if(built.nodes.begin(), built.nodes.end(), [&](const auto& n) { return n.first == name; });
    const Operation& op = *known_operation(s.operation);
    targets.push_back({node->second, upstream_request(op, make_params(op, s.words), {})});
  }
  return built.graph.evaluate(targets, context);
}

std::vector<DatasetPtr> datasets_of(const Data& data) {
  std::vector<DatasetPtr> all;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { all.push_back(d); });
  return all;
}

// What every part of the data comes to; nothing where they differ, as where they choose other fields.
std::optional<std::string> common_choice(const std::vector<DatasetPtr>& parts, const Operation& op, const ParamSet& params,
                                         const Context& context) {
  std::optional<std::string> common;
  for (const DatasetPtr& part : parts) {
    if (part->point_count() == 0) continue;
    std::string value;
    try {
      value = op.choose(*part, params, context);
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::usage) throw;
      continue;  // it has nothing to choose from, or running reports what is wrong
    }
    if (value.empty() || (common && *common != value)) return {};
    common = value;
  }
  return common;
}

}  // namespace

void settle_choices(PipelineFile& file, std::span<PipelineFile> moments, const GraphOptions& graph, const StepResults& results,
                    std::vector<Data>& held, Context& context) {
  constexpr size_t samples = 0;  // ranges alone
  const PipelineFile& now = moments.empty() ? file : moments[0];
  build_graph(now, graph, results);  // throws for what is misspelt, with its line
  for (const std::vector<size_t>& steps : steps_alike(file)) {
    if (steps.size() < 2 && moments.size() < 2) continue;
    const Operation& op = *known_operation(file.steps[steps[0]].operation);
    std::vector<std::vector<DatasetPtr>> parts(steps.size());
    std::vector<DatasetPtr> all;
    for (size_t m = 0; m < std::max<size_t>(1, moments.size()); ++m) {
      const std::vector<Data> inputs = inputs_of(m == 0 ? now : moments[m], steps, graph, results, context);
      const bool first = m == 0;
      for (size_t k = 0; k < steps.size(); ++k)
        for (const DatasetPtr& d : datasets_of(inputs[k])) {
          if (first) parts[k].push_back(d);
          all.push_back(moments.size() > 1 ? sampled_cloud(*d, samples) : d);
        }
      if (first) held.insert(held.end(), inputs.begin(), inputs.end());
    }
    Context choosing(context, 0, 1);
    choosing.parts = &all;
    std::set<std::string> told;  // parts come to the same
    choosing.on_log = [&](LogLevel level, std::string_view text) {
      if (told.emplace(text).second) context.log(level, text);
    };
    for (size_t k = 0; k < steps.size(); ++k) {
      const ParamSet params = make_params(op, now.steps[steps[k]].words);
      const std::optional<std::string> value = common_choice(parts[k], op, params, choosing);
      if (!value) continue;
      const std::string word = fmt::format("{}={}", op.alike, *value);
      file.steps[steps[k]].words.push_back(word);
      for (PipelineFile& moment : moments) moment.steps[steps[k]].words.push_back(word);
    }
  }
}

}  // namespace sg
