// SPDX-License-Identifier: Apache-2.0
// From targets to steps: requests go up, keys come down.
#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "base/text/text.h"
#include "pipeline/graph/graph_state.h"

namespace sg {

namespace {

void want(std::vector<Request>& wanted, const Request& r) {
  for (Request& have : wanted)
    if (can_merge(have, r)) {
      have = merged(std::move(have), r);
      return;
    }
  wanted.push_back(r);
}

// What the reader is given: the user's list of fields, cut to what is needed.
ReadOptions read_for(ReadOptions options, const Request& request) {
  if (request.time && !options.time && options.step < 0) options.time = request.time;
  if (request.pieces > 1) options.piece = request.piece, options.pieces = request.pieces, options.ghost_levels = request.ghost_levels;
  if (request.all_fields) return options;
  std::vector<std::string> fields;
  for (const std::string& f : request.fields)
    if (options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), f) != options.fields.end()) fields.push_back(f);
  if (fields.empty() && request.fields.empty()) options.header_only = true;
  else if (!fields.empty()) options.fields = std::move(fields);
  return options;
}

Key read_key(const std::string& path, const ReadOptions& o, const Request& request, bool custom_reader, bool strict) {
  KeyBuilder key;
  key.add("read").add(file_key(path, strict)).add(uint64_t(o.header_only)).add(uint64_t(o.fields.size()));
  for (const std::string& f : o.fields) key.add(f);
  for (const size_t n : o.raw_dims) key.add(uint64_t(n));
  key.add(o.raw_type).add(uint64_t(o.raw_big_endian)).add(uint64_t(o.raw_header)).add(uint64_t(o.raw_components));
  for (int i = 0; i < 3; ++i) key.add(std::bit_cast<uint64_t>(o.raw_spacing[i]));
  key.add(o.time ? exact_number(*o.time) : "first").add(uint64_t(o.step)).add(o.times).add(word_of(o.csv_header)).add(o.format);
  for (size_t a = 0; a < 3; ++a) key.add(uint64_t(o.region.lo[a])).add(uint64_t(o.region.hi[a])).add(uint64_t(o.region.stride[a]));
  key.add(uint64_t(o.piece)).add(uint64_t(o.pieces)).add(uint64_t(o.ghost_levels));
  if (request.pieces > 1) key.add("of several");
  if (request.region) key.add(request_text(request));
  Request rest = request;  // the fields are in the options
  rest.all_fields = true, rest.fields.clear();
  if (custom_reader) key.add(request_text(rest));
  return key.key();
}

Key operation_key(const Operation& o, const ParamSet& params, const std::vector<int>& inputs, int series, bool together,
                  const std::vector<Step>& steps) {
  KeyBuilder key;
  if (together) key.add("together");
  key.add("operation").add(o.name).add(uint64_t(o.version)).add(uint64_t(params.schema.decls().size()));
  for (const ParamDecl& d : params.schema.decls()) key.add(d.name).add(param_text(d));
  key.add(uint64_t(inputs.size()));
  for (const int i : inputs) key.add(steps[size_t(i)].key);
  if (series >= 0) key.add("all times of").add(steps[size_t(series)].key);
  return key.key();
}

Key piece_key(const Key& whole, const Request& r) {
  KeyBuilder key;
  return key.add("piece of").add(whole).add(uint64_t(r.piece)).add(uint64_t(r.pieces)).add(uint64_t(r.ghost_levels)).key();
}

Request whole(Request r) {
  r.piece = 0, r.pieces = 1, r.ghost_levels = 0;
  return r;
}

// Whether that piece has to be cut out of the node's whole result.
bool is_cut(const Node& node, const Request& r, bool together) {
  if (r.pieces == 1) return false;
  if (auto* read = std::get_if<ReadNode>(&node.what)) return read->options.pieces > 1;  // the user's piece is the whole here
  if (auto* op = std::get_if<OperationNode>(&node.what)) return !works_by_piece(*op->found, *op->params, r, together);
  return true;
}

// The same at any time.
Request timeless(Request r) {
  r.time.reset();
  return r;
}

// Consumers that may request a result; what only a series refers to is evaluated elsewhere.
void count_consumers(Plan& plan) {
  std::vector<char> asked(plan.steps.size(), 0);
  for (const int t : plan.targets) asked[size_t(t)] = 1, ++plan.steps[size_t(t)].consumers;
  for (size_t i = plan.steps.size(); i-- > 0;)
    if (asked[i])
      for (const int in : plan.steps[i].inputs) asked[size_t(in)] = 1, ++plan.steps[size_t(in)].consumers;
}

ParamSet params_for(const OperationNode& op, const Request& request) {
  if (!op.follows_time || !request.time) return *op.params;
  ParamSet params = copy_of(*op.params);
  set_value(params.schema, "time", *request.time, op.operation);
  return params;
}

}  // namespace

Plan Planner::make(const Graph& graph, std::span<const Target> targets, const std::vector<char>* constant, bool together) {
  const Graph::State& g = *graph.state_;
  std::vector<NodeId> sinks;
  for (const Target& t : targets) {
    if (t.node < 0 || size_t(t.node) >= g.nodes.size()) fail_usage(fmt::format("there is no step {}", t.node + 1));
    sinks.push_back(t.node);
  }
  if (sinks.empty()) return {};
  if (const auto found = find_mistakes(g.nodes, g.options, sinks); !found.empty()) throw_mistakes(found);

  // Up: the request to every node. A node has a larger number than its inputs, so going down is an order.
  std::vector<std::vector<Request>> wanted(g.nodes.size());
  for (const Target& t : targets) want(wanted[size_t(t.node)], t.request);
  for (size_t i = g.nodes.size(); i-- > 0;) {
    const std::vector<Request> asked = wanted[i];
    for (const Request& r : asked)
      if (is_cut(g.nodes[i], r, together)) want(wanted[i], whole(r));
    auto* op = std::get_if<OperationNode>(&g.nodes[i].what);
    if (!op) continue;
    for (const Request& r : wanted[i])
      for (size_t in = 0; in < g.nodes[i].inputs.size() && !is_cut(g.nodes[i], r, together); ++in) {
        const Request up = upstream_request(*op->found, *op->params, r, in, together);
        want(wanted[size_t(g.nodes[i].inputs[in])], in == 0 && op->found->run_series ? timeless(up) : up);
      }
  }

  // Down: steps and keys; nodes with equal keys become one step.
  Plan plan;
  std::map<Key, int> by_key;
  std::vector<std::vector<int>> step_of(g.nodes.size());
  auto find_step = [&](NodeId node, const Request& request) {
    for (size_t r = 0; r < wanted[size_t(node)].size(); ++r)
      if (can_merge(wanted[size_t(node)][r], request)) return step_of[size_t(node)][r];
    fail_internal("a request got lost");
  };
  for (size_t i = 0; i < g.nodes.size(); ++i) {
    const Node& node = g.nodes[i];
    step_of[i].assign(wanted[i].size(), -1);
    for (const bool cuts : {false, true})  // what is cut stands behind what it is cut out of
      for (size_t r = 0; r < wanted[i].size(); ++r) {
        const Request& request = wanted[i][r];
        if (is_cut(node, request, together) != cuts) continue;
        Step s;
        s.node = NodeId(i);
        s.request = request;
        if (cuts) {
          s.cut = true;
          s.inputs.push_back(find_step(s.node, whole(request)));
          const Step& of = plan.steps[size_t(s.inputs[0])];
          s.varies = of.varies;
          s.key = piece_key(of.key, request);
        } else if (auto* read = std::get_if<ReadNode>(&node.what)) {
          if (constant && (*constant)[i]) s.request = timeless(request);
          s.read = read_for(read->options, s.request);
          s.varies = s.request.time && !read->options.time && read->options.step < 0;
          s.key = read_key(read->path, s.read, s.request, bool(g.options.read), g.options.strict);
        } else if (auto* op = std::get_if<OperationNode>(&node.what)) {
          s.params = params_for(*op, request);
          s.varies = op->follows_time && request.time;
          for (size_t in = 0; in < node.inputs.size(); ++in) {
            const Request up = upstream_request(*op->found, *op->params, request, in, together);
            if (in == 0 && op->found->run_series) {
              s.series = find_step(node.inputs[in], timeless(up));
            } else {
              s.inputs.push_back(find_step(node.inputs[in], up));
              s.varies = s.varies || plan.steps[size_t(s.inputs.back())].varies;
            }
          }
          s.key = operation_key(*op->found, s.params, s.inputs, s.series, together, plan.steps);
        } else {
          s.key = std::get<DataNode>(node.what).key;
        }
        const auto [at, fresh] = by_key.emplace(s.key, int(plan.steps.size()));
        if (fresh) plan.steps.push_back(std::move(s));
        step_of[i][r] = at->second;
      }
  }
  for (const Target& t : targets) plan.targets.push_back(find_step(t.node, t.request));
  count_consumers(plan);
  return plan;
}

Key Graph::key(NodeId node, const Request& request) const {
  const Target t{node, request};
  const Plan plan = Planner::make(*this, {&t, 1});
  return plan.steps[size_t(plan.targets[0])].key;
}

}  // namespace sg
