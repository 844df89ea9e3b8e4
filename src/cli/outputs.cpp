// SPDX-License-Identifier: Apache-2.0
#include "cli/outputs.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/replace.h"
#include "base/text/text.h"
#include "cli/say.h"
#include "io/file_series.h"
#include "pipeline/picture/picture_cost.h"

namespace sg {

std::string stem_of(const std::string& path) {
  std::string name = file_name_of(names_series(path) ? path.substr(0, path.find(',')) : path);
  for (const std::string_view mark : {"{n}", "*", "?"})  // of the pattern of a series
    if (names_series(path))
      for (size_t at = name.find(mark); at != name.npos; at = name.find(mark)) name.erase(at, mark.size());
  if (name.empty() || name[0] == '.') name = "series" + name;
  const size_t dot = name.rfind('.');
  return dot == std::string::npos || dot == 0 ? name : name.substr(0, dot);
}

std::string output_name(std::string pattern, const std::string& stem) {
  replace_all(pattern, "{name}", stem);
  return pattern;
}

namespace {

std::vector<Target> targets_of(const PipelineGraph& built) {
  std::vector<Target> targets;
  for (NodeId n : built.show) targets.push_back({n, {}});
  if (targets.empty()) targets.push_back({built.last, {}});
  return targets;
}

}  // namespace

void print_explanation(const PipelineFile& file, bool drawn) {
  const PipelineGraph built = build_graph(file);
  say(built.graph.explain(targets_of(built)) + (drawn ? explain_drawing(file, built) : ""));
}

void check_memory(const PipelineGraph& built, const Options& o) {
  if (o.memory == 0) return;
  uint64_t bytes = 0;
  for (const PlannedStep& step : built.graph.plan(targets_of(built)))
    if (!step.reads_parts) bytes += step.bytes;
  if (bytes > o.memory)
    fail_usage(fmt::format("the steps are expected to need {}, more than the {} allowed", human_bytes(bytes), human_bytes(o.memory)),
               "--memory", "--explain shows which; allow more, or read a smaller part");
}

}  // namespace sg
