// SPDX-License-Identifier: Apache-2.0
// What an evaluation would do, and what that may cost.
#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"
#include "data/lattice.h"
#include "pipeline/file/read_part.h"
#include "pipeline/graph/graph_state.h"

namespace sg {

namespace {

constexpr double bytes_per_second = 2e9;  // one pass over memory by a simple kernel

// The share of a grid's points that is read; 1 when that is not known without reading.
double share_read(const ReadNode& read, const Step& s) {
  if (s.read.region.whole() && !s.request.region) return 1;
  try {
    if (!(find_format(read.path, s.read).honours & honours_region)) return 1;
    ReadOptions look = s.read;
    look.header_only = true;
    look.region = {};
    Context context;
    const Data header = read_data(read.path, look, context);
    auto* d = std::get_if<DatasetPtr>(&header);
    if (!d || !is_lattice((*d)->mesh())) return 1;
    LatticeRegion r = s.read.region;
    if (r.whole())
      if (const auto found = lattice_region((*d)->mesh(), *s.request.region)) r = *found;
    const auto dims = lattice_dims((*d)->mesh());
    double share = 1;
    for (size_t a = 0; a < 3; ++a) {
      const size_t hi = std::min(r.hi[a], dims[a] - 1);
      share *= r.lo[a] > hi ? 0 : double((hi - r.lo[a]) / r.stride[a] + 1) / double(dims[a]);
    }
    return share;
  } catch (const Error&) {
    return 1;  // for the reader to report
  }
}

Estimate estimate_of(const Step& s, const Node& node, const std::vector<PlannedStep>& before) {
  if (s.cut) {
    const uint64_t bytes = before[size_t(s.inputs[0])].bytes / uint64_t(s.request.pieces);
    return {bytes, double(bytes) / bytes_per_second};
  }
  if (auto* read = std::get_if<ReadNode>(&node.what)) {
    uint64_t bytes = 0;
    for (const FileState& f : file_and_parts(read->path)) bytes += f.size;
    bytes = uint64_t(double(bytes) * share_read(*read, s));
    return {bytes, double(bytes) / bytes_per_second};
  }
  if (auto* given = std::get_if<DataNode>(&node.what)) return {data_bytes(given->data), 0};
  std::vector<uint64_t> in;
  if (s.series >= 0) in.push_back(before[size_t(s.series)].bytes);
  for (const int i : s.inputs) in.push_back(before[size_t(i)].bytes);
  const Operation& o = *std::get<OperationNode>(node.what).found;
  if (o.estimate) return o.estimate(s.params, in);
  uint64_t touched = 0, largest = 0;
  for (const uint64_t b : in) touched += b, largest = std::max(largest, b);
  return {largest, double(touched + largest) / bytes_per_second};
}

bool reads_parts(const Node& node) {
  auto* read = std::get_if<ReadNode>(&node.what);
  if (!read) return false;
  try {
    return find_format(read->path, read->options).honours & honours_region;
  } catch (const Error&) {
    return false;  // for the reader to report
  }
}

// What a step does, and in how many frames and steps a simulator does that.
std::string does_text(const PlannedStep& s) {
  if (!s.frames) return s.does;
  std::string text = fmt::format("{}, {} frame{}", s.does, *s.frames, *s.frames == 1 ? "" : "s");
  if (s.stored > 0) text += fmt::format(" after the {} stored", s.stored);
  if (s.steps > 0) text += fmt::format(" in ~{} steps", s.steps);
  if (s.steps > 0 && !s.guess.empty()) text += fmt::format(" ({})", s.guess);
  return text;
}

std::string seconds_text(double s) {
  if (s <= 0) return "0 s";
  if (s < 1e-3) return short_number(s * 1e6, 2) + " us";
  return s < 1 ? short_number(s * 1e3, 2) + " ms" : short_number(s, 3) + " s";
}

}  // namespace

std::vector<PlannedStep> Graph::plan(std::span<const Target> targets) const {
  const Plan plan = Planner::make(*this, targets);
  std::vector<PlannedStep> out;
  for (const Step& s : plan.steps) {
    const Node& node = state_->nodes[size_t(s.node)];
    PlannedStep p{s.node,
                  node.name.empty() ? std::to_string(s.node + 1) : node.name,
                  step_does(node) + (s.cut ? ", a piece" : ""),
                  s.key,
                  s.request,
                  PlannedStep::State::not_needed,
                  0,
                  0,
                  reads_parts(node)};
    const auto cached = state_->cache->peek(s.key);
    if (cached) p.bytes = *cached;
    else {
      const Estimate e = estimate_of(s, node, out);
      p.bytes = e.bytes, p.seconds = e.seconds, p.frames = e.frames, p.steps = e.steps, p.stored = e.stored, p.guess = e.guess;
    }
    if (cached || (!s.cut && std::holds_alternative<DataNode>(node.what))) p.state = PlannedStep::State::cached;
    out.push_back(std::move(p));
  }
  // Needed are the targets and, above them, whatever is not hidden behind a cached result.
  std::vector<char> needed(out.size(), 0), in_series(out.size(), 0);
  for (const int t : plan.targets) needed[size_t(t)] = 1;
  for (size_t i = out.size(); i-- > 0;) {
    const bool runs = needed[i] && out[i].state != PlannedStep::State::cached;
    if (runs) out[i].state = PlannedStep::State::run;
    else out[i].seconds = 0, out[i].frames = {};
    if (runs)
      for (const int in : plan.steps[i].inputs) needed[size_t(in)] = 1;
    if (runs && plan.steps[i].series >= 0) in_series[size_t(plan.steps[i].series)] = 1;
  }
  // Upstream of a series everything is requested for each time, and what does not depend on time once.
  for (size_t i = out.size(); i-- > 0;) {
    if (!in_series[i]) continue;
    if (out[i].state == PlannedStep::State::not_needed) out[i].state = PlannedStep::State::each_time;
    for (const int in : plan.steps[i].inputs) in_series[size_t(in)] = 1;
  }
  return out;
}

std::string Graph::explain(NodeId node, const Request& request) const {
  const Target t{node, request};
  return explain(std::span<const Target>(&t, 1));
}

std::string Graph::explain(std::span<const Target> targets) const {
  const std::vector<PlannedStep> steps = plan(targets);
  size_t name_width = 4, does_width = 4;
  for (const PlannedStep& s : steps)
    name_width = std::max(name_width, s.name.size()), does_width = std::max(does_width, does_text(s).size());
  std::string r = fmt::format("{:<{}}  {:<{}}  {:<8}  {:<10}  {:>12}  {:>8}  {}\n", "step", name_width, "does", does_width, "key", "state",
                              "result", "time", "needs");
  double seconds = 0;
  size_t running = 0;
  for (const PlannedStep& s : steps) {
    const bool runs = s.state == PlannedStep::State::run, cached = s.state == PlannedStep::State::cached;
    seconds += s.seconds;
    running += runs;
    r += fmt::format("{:<{}}  {:<{}}  {:<8}  {:<10}  {:>12}  {:>8}  {}\n", s.name, name_width, does_text(s), does_width,
                     key_text(s.key).substr(0, 8),
                     runs                                       ? "run"
                     : cached                                   ? "cached"
                     : s.state == PlannedStep::State::each_time ? "each time"
                                                                : "not needed",
                     (cached ? "" : "~") + human_bytes(s.bytes), runs ? "~" + seconds_text(s.seconds) : "-", request_text(s.request));
  }
  return r + fmt::format("{} of {} steps run, in about {}\n", running, steps.size(), seconds_text(seconds));
}

}  // namespace sg
