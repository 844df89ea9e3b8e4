// SPDX-License-Identifier: Apache-2.0
#include "pipeline/graph/series_input.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "base/text/text.h"
#include "pipeline/graph/graph_state.h"

namespace sg {

std::vector<double> parse_times(std::string_view text, std::string_view who) {
  std::vector<double> times;
  const auto ends = split(text, ':');
  if (ends.size() == 3) {
    const auto a = parse_double(ends[0]), b = parse_double(ends[1]);
    auto n = parse_int(ends[2]);
    const auto step = parse_double(ends[2]);
    const bool by_step = a && b && !n && step && std::isfinite(*step) && *step > 0;
    if (by_step && *b >= *a && (*b - *a) / *step < 1e6) n = int64_t((*b - *a) / *step * (1 + 1e-12) + 1e-9) + 1;
    if (!a || !b || !n || *n < 1 || *n > 1000000 || !std::isfinite(*a) || !std::isfinite(*b))
      fail_usage(fmt::format("'{}' is not a list of times", text), std::string(who),
                 "give FIRST:LAST:COUNT, e.g. 0:10:101, or FIRST:LAST:STEP, e.g. 0:10:0.1");
    if (by_step) {
      for (int64_t i = 0; i < *n; ++i) times.push_back(*a + *step * double(i));
      return times;
    }
    for (int64_t i = 0; i < *n; ++i) times.push_back(*n == 1 ? *a : *a + (*b - *a) * double(i) / double(*n - 1));
    return times;
  }
  for (const std::string_view part : split(text, ',')) {
    const auto t = parse_double(part);
    if (!t || !std::isfinite(*t))
      fail_usage(fmt::format("'{}' is not a list of times", text), std::string(who), "write e.g. 0,0.5,1 or 0:1:101");
    times.push_back(*t);
  }
  if (times.empty()) fail_usage("does not name any time", std::string(who), "write e.g. 0,0.5,1 or 0:1:101");
  return times;
}

namespace {

// Times known to the nodes above.
struct Above {
  std::vector<double> times;   // of files
  std::string file;            // the first that has them
  std::string any_time;        // a source that can be computed for any time
  std::vector<char> constant;  // nodes that read the same at all times
};

Above look_above(const std::vector<Node>& nodes, const GraphOptions& options, NodeId from, Context& context) {
  Above above;
  above.constant.assign(nodes.size(), 0);
  std::vector<char> reached(nodes.size(), 0);
  reached[size_t(from)] = 1;
  for (size_t i = size_t(from) + 1; i-- > 0;) {
    if (!reached[i]) continue;
    const Node& node = nodes[i];
    for (const NodeId in : node.inputs) reached[size_t(in)] = 1;
    if (auto* op = std::get_if<OperationNode>(&node.what); op && op->follows_time) above.any_time = op->operation;
    auto* read = std::get_if<ReadNode>(&node.what);
    if (!read) continue;
    std::vector<double> times;
    if (!read->options.time && read->options.step < 0)
      times = options.times ? options.times(read->path, read->options, context) : file_times(read->path, read->options, context);
    above.constant[i] = times.empty();
    if (times.empty()) continue;
    if (above.file.empty()) above.times = std::move(times), above.file = read->path;
    else if (times != above.times)
      fail_usage(fmt::format("'{}' has {} time steps ({} to {}), '{}' {} ({} to {})", above.file, above.times.size(), above.times.front(),
                             above.times.back(), read->path, times.size(), times.front(), times.back()),
                 {}, "files of one series must have the same times");
  }
  return above;
}

void check_listed(const std::vector<double>& asked, const Above& above) {
  double gap = HUGE_VAL;
  for (size_t i = 1; i < above.times.size(); ++i)
    if (above.times[i] != above.times[i - 1]) gap = std::min(gap, std::abs(above.times[i] - above.times[i - 1]));
  for (const double t : asked) {
    double near = above.times[0];
    for (const double have : above.times)
      if (std::abs(have - t) < std::abs(near - t)) near = have;
    if (std::abs(near - t) > std::max(1e-12 * std::abs(t), gap < HUGE_VAL ? 1e-6 * gap : 0.0))
      fail_usage(fmt::format("there is no step at the time {}", exact_number(t)), above.file,
                 fmt::format("it has {} from {} to {}; the nearest is {}", above.times.size(), exact_number(above.times.front()),
                             exact_number(above.times.back()), exact_number(near)));
  }
}

}  // namespace

Series SeriesInput::open(const Graph& graph, const Node& consumer, const Request& request, const ParamSet& params, Context& context) {
  const std::string& who = std::get<OperationNode>(consumer.what).operation;
  const NodeId from = consumer.inputs.at(0);
  Above above = look_above(graph.state_->nodes, graph.state_->options, from, context);
  std::vector<double> times;
  if (const ParamDecl* asked = params.schema.find("times"))
    if (const std::string text = param_text(*asked); asked->ref.type() == ParamType::word && !text.empty())
      times = parse_times(text, who + " times");
  if (!times.empty() && !above.times.empty()) check_listed(times, above);
  if (times.empty()) times = above.times;
  if (times.empty() && !above.any_time.empty())
    fail_usage(fmt::format("'{}' can be computed for any time, so times are needed", above.any_time), who,
               "give times=FIRST:LAST:COUNT, e.g. times=0:10:101");
  if (times.empty()) times = {0};
  // Every step gives the same note.
  auto told = std::make_shared<std::set<std::string>>();
  Series series;
  series.times = times;
  series.load = [&graph, from, request, times, constant = std::move(above.constant), told, &context](size_t step) {
    Context one(context, 0, 1);
    one.on_progress = nullptr;
    one.on_log = [&](LogLevel level, std::string_view text) {
      if (told->emplace(text).second) context.log(level, text);
    };
    return evaluate_at(graph, from, request, times.at(step), constant, one);
  };
  return series;
}

}  // namespace sg
