// SPDX-License-Identifier: Apache-2.0
// Running a plan: from the targets up, each step when first requested.
#include <fmt/core.h>

#include <algorithm>

#include "base/all_ranks.h"
#include "base/text/text.h"
#include "filter/mesh/select/piece.h"
#include "pipeline/file/read_part.h"
#include "pipeline/graph/graph_state.h"
#include "pipeline/graph/series_input.h"
#include "pipeline/graph/step_report.h"
#include "pipeline/operation/check_inputs.h"

namespace sg {

/// One call of Graph::evaluate, or one time of a series: then the results that belong to that time pass by the cache, which would keep one
/// step after the other.
class Evaluation {
 public:
  Evaluation(const Graph& graph, const Plan& plan, bool one_time, Context& context)
      : graph_(graph),
        g_(*graph.state_),
        plan_(plan),
        one_time_(one_time),
        context_(context),
        results_(plan.steps.size()),
        done_(plan.steps.size(), 0) {
    for (const Step& s : plan.steps) left_.push_back(s.consumers);
    for (const int t : plan.targets) count_work(t), in_pieces_ = in_pieces_ || plan.steps[size_t(t)].request.pieces > 1;
    std::fill(done_.begin(), done_.end(), 0);
  }

  std::vector<Data> run() {
    std::vector<Data> out;
    for (const int t : plan_.targets) {
      out.push_back(demand(t));
      release(t);
    }
    context_.progress(1, "done");
    return out;
  }

 private:
  // Number of steps that will run, as far as the cache can tell now.
  void count_work(int step) {
    if (done_[size_t(step)]) return;
    done_[size_t(step)] = 1;
    if (g_.cache->peek(plan_.steps[size_t(step)].key)) return;
    ++total_;
    for (const int in : plan_.steps[size_t(step)].inputs) count_work(in);
  }

  Data demand(int step) {
    const Step& s = plan_.steps[size_t(step)];
    std::optional<Data>& result = results_[size_t(step)];
    if (result) return *result;
    context_.check();
    if (auto* given = std::get_if<DataNode>(&g_.nodes[size_t(s.node)].what); given && !s.cut) {
      result = given->data;
    } else if (some_have(s)) {
      result = compute(s);
    } else if (one_time_ && s.varies) {
      result = g_.cache->find(s.key);
      if (result)
        for (const int in : s.inputs) release(in);
      else result = compute(s);
    } else {
      bool ran = false;
      result = g_.cache->find_or_compute(s.key, context_, [&] {
        ran = true;
        return compute(s);
      });
      if (!ran)
        for (const int in : s.inputs) release(in);  // found: the inputs are not needed for this
    }
    done_[size_t(step)] = 1;
    return *result;
  }

  // Where pieces are asked for, steps above which everything is whole are made by each process alone.
  const Communicator* communicator_of(const Step& s) const { return in_pieces_ && s.request.pieces == 1 ? nullptr : context_.communicator; }

  // Operations that speak with those of other processes run in all of them or in none, whatever each has kept.
  bool some_have(const Step& s) {
    const int kept = g_.cache->peek(s.key).has_value();
    return all_least(kept, communicator_of(s)) != all_most(kept, communicator_of(s));
  }

  Data compute(const Step& s) {
    std::vector<Data> inputs;
    inputs.reserve(s.inputs.size());
    for (const int in : s.inputs) inputs.push_back(demand(in));
    for (const int in : s.inputs) release(in);
    const Node& node = g_.nodes[size_t(s.node)];
    const std::string doing = node.inputs.empty() && std::holds_alternative<ReadNode>(node.what)
                                  ? fmt::format("reading ({})", step_label(node, s.node))
                                  : fmt::format("running '{}' ({})", step_does(node), step_label(node, s.node));
    context_.check();
    const double from = fraction();
    ++ran_;
    Context part(context_, from, fraction());
    part.communicator = communicator_of(s);
    part.progress(0, doing);
    const StopWatch watch;
    const Data made = with_context(doing, [&]() -> Data {
      if (s.cut)
        return map_datasets(
            inputs[0], [&](const DatasetPtr& d) { return take_share(d, s.request.piece, s.request.pieces, s.request.ghost_levels, part); });
      if (auto* read = std::get_if<ReadNode>(&node.what)) return read_file(*read, s, part);
      const Operation& operation = *std::get<OperationNode>(node.what).found;
      if (s.series < 0) {
        check_inputs(operation, s.params.schema, inputs);
        return operation.run(inputs, s.params, part);
      }
      check_kinds(operation, inputs, 1);
      Series series = SeriesInput::open(graph_, node, plan_.steps[size_t(s.series)].request, s.params, part);
      series.load = [&, load = std::move(series.load)](size_t step) {
        Data data = load(step);
        check_inputs(operation, s.params.schema, std::span(&data, 1));
        return data;
      };
      return operation.run_series(series, inputs, s.params, part);
    });
    const std::string at = one_time_ && s.varies && s.request.time ? fmt::format(" at the time {}", short_number(*s.request.time)) : "";
    context_.log(LogLevel::debug, fmt::format("{}{}: {}: {}", doing, at, watch.text(), result_text(made)));
    if (g_.options.on_ran) g_.options.on_ran(node.name, watch.seconds());
    return made;
  }

  Data read_file(const ReadNode& read, const Step& s, Context& context) {
    Data data = g_.options.read ? g_.options.read(read.path, s.read, s.request, context) : read_part(read.path, s.read, s.request, context);
    if (!s.read.header_only) check_chosen_fields(read, s, data);
    return data;
  }

  // Readers pass over names that a file does not have, since a request may ask for fields that a filter makes. But a name
  // that the user put into the options must be there.
  void check_chosen_fields(const ReadNode& read, const Step& s, const Data& data) {
    for (const std::string& name : read.options.fields) {
      if (std::find(s.read.fields.begin(), s.read.fields.end(), name) == s.read.fields.end()) continue;
      bool found = false, any = false;
      for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { any = true, found = found || d->fields().find(name); });
      if (found || !any) continue;
      std::vector<std::string> have;
      if (g_.options.field_names) have = g_.options.field_names(read.path, ReadOptions()).value_or(have);
      fail_usage(fmt::format("there is no field '{}' in the file", name), read.path, have.empty() ? "" : unknown_name_hint(name, have));
    }
  }

  // One consumer less; with the last one the result goes, and when it was never needed, its claim on its inputs too.
  void release(int step) {
    if (--left_[size_t(step)] > 0) return;
    results_[size_t(step)].reset();
    if (done_[size_t(step)]) return;
    done_[size_t(step)] = 1;
    for (const int in : plan_.steps[size_t(step)].inputs) release(in);
  }

  double fraction() const { return total_ ? std::min(1.0, double(ran_) / double(total_)) : 1.0; }

  const Graph& graph_;
  const Graph::State& g_;
  const Plan& plan_;
  bool one_time_, in_pieces_ = false;
  Context& context_;
  std::vector<std::optional<Data>> results_;
  std::vector<int> left_;
  std::vector<char> done_;  // its inputs are released
  size_t total_ = 0, ran_ = 0;
};

std::vector<Data> Graph::evaluate(std::span<const Target> targets, Context& context) const {
  const Plan plan = Planner::make(*this, targets, nullptr, context.communicator != nullptr);
  return Evaluation(*this, plan, false, context).run();
}

Data SeriesInput::evaluate_at(const Graph& graph, NodeId node, Request request, double time, const std::vector<char>& constant,
                              Context& context) {
  request.time = time;
  const Target target{node, std::move(request)};
  const Plan plan = Planner::make(graph, {&target, 1}, &constant, context.communicator != nullptr);
  return Evaluation(graph, plan, true, context).run()[0];
}

Data Graph::evaluate(NodeId node, const Request& request, Context& context) const {
  const Target t{node, request};
  return evaluate(std::span<const Target>(&t, 1), context)[0];
}

}  // namespace sg
