// SPDX-License-Identifier: Apache-2.0
// From a PipelineFile to a Graph.
#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "base/file/file.h"
#include "base/text/text.h"
#include "io/file_series.h"
#include "io/options.h"
#include "pipeline/file/file_words.h"
#include "pipeline/file/pipeline_file.h"
#include "pipeline/graph/graph_state.h"

namespace sg {

namespace {

class GraphBuilder {
 public:
  GraphBuilder(const PipelineFile& file, GraphOptions options, const StepResults& results)
      : file_(file), options_(options), results_(results), built_{Graph(std::move(options)), {}, {}, -1} {}

  PipelineGraph build() {
    for (const PipelineFile::Step& step : file_.steps) all_names_.push_back(step.name);
    for (const PipelineFile::Step& step : file_.steps) add(step);
    for (const Mistake& m : built_.graph.mistakes()) mistake(line_of_[size_t(m.node)], m.text, m.kind);
    const auto step_named = [&](const std::string& name, int line, const std::string& who) {
      const auto at = nodes_.find(name);
      if (at != nodes_.end()) return at->second;
      mistake(line, fmt::format("{}: there is no step '{}'; {}", who, name, unknown_name_hint(name, all_names_)));
      return built_.last;
    };
    for (const PipelineFile::Show& show : file_.show)
      built_.show.push_back(show.of.empty() ? built_.last : step_named(show.of, show.line, "show " + show.kind));
    for (const PipelineFile::Node& n : file_.scene)
      built_.places.push_back(n.at.empty() ? -1 : step_named(n.at, n.line, fmt::format("node '{}', instances", n.name)));
    if (file_.steps.empty()) mistake(0, "there are no steps");
    if (!mistakes_.empty()) {
      std::stable_sort(mistakes_.begin(), mistakes_.end(), [](const Mistake& a, const Mistake& b) { return a.node < b.node; });
      throw_mistakes(mistakes_);
    }
    return std::move(built_);
  }

 private:
  // The line is in Mistake::node, so that they sort by it.
  void mistake(int line, const std::string& text, ErrorKind kind = ErrorKind::usage) {
    const std::string origin = file_.origin.empty() ? "pipeline" : file_.origin;
    mistakes_.push_back({line, kind, line > 0 ? fmt::format("{}:{}: {}", origin, line, text) : text});
  }

  void add(const PipelineFile::Step& step) {
    const auto result = results_.find(step.name);
    const NodeId node = result != results_.end() ? built_.graph.add_data(result->second.data, result->second.content, step.name)
                        : step_kind(step.operation) == StepKind::memory ? add_memory(step)
                        : step.reads()                                  ? add_read(step)
                                                                        : add_operation(step);
    line_of_.push_back(step.line);
    if (!nodes_.emplace(step.name, node).second) mistake(step.line, fmt::format("there are two steps '{}'", step.name));
    built_.nodes.emplace_back(step.name, node);
    built_.last = node;
  }

  NodeId add_read(const PipelineFile::Step& step) {
    ReadParams params;
    try {
      Schema schema = schema_of(params);
      set_params(schema, step.words, "read");
      if (params.path.empty()) fail_usage("no file is given", "read path", "write read: FILE");
      check(params.options);
    } catch (const Error& e) {
      mistake(step.line, fmt::format("step '{}': {}", step.name, e.what()));
      // A given nothing in its place: a missing file would only repeat the mistake.
      return built_.graph.add_data(DatasetPtr(), "mistake", step.name);
    }
    if (!step.from.empty()) mistake(step.line, fmt::format("step '{}': read takes no input", step.name));
    return built_.graph.add_read(series_beside(file_.origin, params.path), params.options, step.name);
  }

  NodeId add_memory(const PipelineFile::Step& step) {
    mistake(step.line, fmt::format("step '{}': its numbers ({}) were in the memory of the program that made this, not in a file; make that "
                                   "program write them to a file and read the file, so that pictures can be remade",
                                   step.name, word_value(step.words, "data").value_or("not described")));
    return built_.graph.add_data(DatasetPtr(), "mistake", step.name);
  }

  NodeId add_operation(const PipelineFile::Step& step) {
    std::vector<NodeId> inputs;
    for (const std::string& name : step.from) {
      if (const auto at = nodes_.find(name); at != nodes_.end()) {
        inputs.push_back(at->second);
        continue;
      }
      const bool later = std::find(all_names_.begin(), all_names_.end(), name) != all_names_.end();
      if (later)
        mistake(step.line, fmt::format("step '{}': its input '{}' comes {}", step.name, name,
                                       name == step.name ? "from itself" : "later; move that step up"));
      else mistake(step.line, fmt::format("step '{}': there is no step '{}'; {}", step.name, name, unknown_name_hint(name, all_names_)));
      if (built_.last >= 0) inputs.push_back(built_.last);  // keeps the number of inputs, so that one mistake is reported once
    }
    if (step.from.empty() && wants_input(step.operation) && built_.last >= 0) inputs.push_back(built_.last);
    return built_.graph.add_operation(step.operation, with_paths(step), std::move(inputs), step.name);
  }

  // Parameters that name files (unit "file") are relative to the pipeline file, as those of read are.
  std::vector<std::string> with_paths(const PipelineFile::Step& step) const {
    const Operation* op = known_operation(step.operation, options_.operations);
    return op ? words_beside(step.words, op->make_params().schema, file_.origin) : step.words;
  }

  bool wants_input(const std::string& operation) const {
    const Operation* op = known_operation(operation, options_.operations);
    return op && op->kind == OperationKind::filter;
  }

  const PipelineFile& file_;
  GraphOptions options_;
  const StepResults& results_;
  PipelineGraph built_;
  std::map<std::string, NodeId> nodes_;
  std::vector<std::string> all_names_;
  std::vector<int> line_of_;  // of each node
  std::vector<Mistake> mistakes_;
};

}  // namespace

PipelineGraph build_graph(const PipelineFile& file, GraphOptions options, const StepResults& results) {
  return GraphBuilder(file, std::move(options), results).build();
}

}  // namespace sg
