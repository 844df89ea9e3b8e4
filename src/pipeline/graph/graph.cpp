// SPDX-License-Identifier: Apache-2.0
// Building a graph and finding the mistakes in it.
#include "pipeline/graph/graph.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <unordered_set>

#include "base/file/file.h"
#include "base/text/text.h"
#include "io/file_series.h"
#include "io/lent_series.h"
#include "pipeline/graph/graph_state.h"

namespace sg {

namespace {
constexpr int deepest_chain = 1000;  // evaluation recurses along it
constexpr double most_copies = 1 << 20;
}  // namespace

Graph::Graph(GraphOptions options) : state_(std::make_unique<State>()) {
  state_->options = std::move(options);
  state_->cache = state_->options.cache ? state_->options.cache : std::make_shared<Cache>(state_->options.cache_limit);
}
Graph::~Graph() = default;
Graph::Graph(Graph&&) noexcept = default;
Graph& Graph::operator=(Graph&&) noexcept = default;

size_t Graph::size() const { return state_->nodes.size(); }
Cache& Graph::cache() const { return *state_->cache; }

NodeId Graph::add_read(std::string path, ReadOptions options, std::string name) {
  state_->nodes.push_back({std::move(name), ReadNode{std::move(path), std::move(options)}, {}, {}});
  state_->depth.push_back(1);
  state_->copies.push_back(1);
  return NodeId(state_->nodes.size() - 1);
}

NodeId Graph::add_data(Data data, std::string content, std::string name) {
  static std::atomic<uint64_t> count{0};
  KeyBuilder key;
  key.add("data").add(content);
  if (content.empty()) key.add(count++);  // an address would come back after its data has died
  state_->nodes.push_back({std::move(name), DataNode{std::move(data), key.key()}, {}, {}});
  state_->depth.push_back(1);
  state_->copies.push_back(1);
  return NodeId(state_->nodes.size() - 1);
}

NodeId Graph::add_operation(std::string operation, std::vector<std::string> words, std::vector<NodeId> inputs, std::string name) {
  Node node{std::move(name), {}, {}, {}};
  OperationNode op{std::move(operation), nullptr, {}, false};
  try {
    op.found = &find_operation(op.operation, state_->options.operations);
    op.params = make_params(*op.found, words);
  } catch (const Error& e) {
    node.mistake = e.what();
  }
  return state_->add(std::move(node), std::move(op), inputs);
}

NodeId Graph::add_operation(const Operation& operation, const ParamSet& params, std::vector<NodeId> inputs, std::string name) {
  return state_->add({std::move(name), {}, {}, {}}, {std::string(operation.name), &operation, copy_of(params), false}, inputs);
}

NodeId Graph::State::add(Node node, OperationNode op, const std::vector<NodeId>& inputs) {
  const auto id = NodeId(nodes.size());
  auto mistake = [&](const std::string& text) { node.mistake += (node.mistake.empty() ? "" : "; ") + text; };
  int deepest = 1;
  double joined = 0;
  const bool joins = op.found && op.found->max_inputs < 0;
  for (const NodeId in : inputs) {
    if (in < 0 || in >= id) mistake(fmt::format("{}: input {} is not an earlier step", op.operation, in + 1));
    else {
      node.inputs.push_back(in), deepest = std::max(deepest, depth[size_t(in)] + 1);
      const double of = copies[size_t(in)];
      joined = joins ? joined + of : std::max(joined, of);
    }
  }
  if (deepest > deepest_chain) mistake(fmt::format("the chain of steps is longer than {}", deepest_chain));
  if (joined > most_copies) mistake(fmt::format("{}: nested steps that join their inputs would join {:.3g} meshes", op.operation, joined));
  if (op.found && node.inputs.size() == inputs.size()) {
    const int n = int(inputs.size()), lo = op.found->min_inputs, hi = op.found->max_inputs;
    if (lo == 0 && hi == 0 && n > 0) mistake(fmt::format("{}: is a source and takes no input", op.operation));
    else if (n < lo || (hi >= 0 && n > hi))
      mistake(fmt::format("{}: takes {}{} input{}, not {}", op.operation, hi < 0 ? "at least " : "", lo, lo == 1 ? "" : "s", n));
  }
  if (op.params && (op.found->kind == OperationKind::source || op.found->run_series)) {
    const ParamDecl* time = op.params->schema.find("time");
    op.follows_time = time && time->ref.type() == ParamType::number && !time->stated;
  }
  node.what = std::move(op);
  nodes.push_back(std::move(node));
  depth.push_back(deepest);
  copies.push_back(std::max(joined, 1.0));
  return id;
}

std::string step_label(const Node& node, NodeId id) {
  return node.name.empty() ? fmt::format("step {}", id + 1) : fmt::format("step '{}'", node.name);
}

std::string step_does(const Node& node) {
  if (auto* read = std::get_if<ReadNode>(&node.what)) return fmt::format("read '{}'", file_name_of(read->path));
  if (auto* op = std::get_if<OperationNode>(&node.what)) return op->operation;
  return "given data";
}

namespace {

// Names of the fields of a node's result, where they are known for certain without running anything.
std::optional<std::vector<std::string>> known_fields(const Node& node, const GraphOptions& options) {
  if (auto* read = std::get_if<ReadNode>(&node.what)) {
    if (!options.field_names || !file_exists(read->path)) return std::nullopt;
    try {
      return options.field_names(read->path, read->options);
    } catch (const Error&) {
      return std::nullopt;  // a broken file is for the reader to report
    }
  }
  auto* given = std::get_if<DataNode>(&node.what);
  if (!given || std::holds_alternative<TablePtr>(given->data)) return std::nullopt;
  if (auto* d = std::get_if<DatasetPtr>(&given->data); d && !*d) return std::nullopt;  // placeholder for what is not available
  std::vector<std::string> names;
  std::unordered_set<std::string> known;
  for_each_dataset(given->data, [&](const std::string&, const DatasetPtr& d) {
    for (std::string& n : d->fields().names())
      if (known.insert(n).second) names.push_back(std::move(n));
  });
  return names;
}

void check_fields(const std::vector<Node>& nodes, NodeId id, const GraphOptions& options, std::vector<Mistake>& out) {
  const Node& node = nodes[size_t(id)];
  auto* op = std::get_if<OperationNode>(&node.what);
  if (!op || !op->params || node.inputs.empty()) return;
  std::vector<std::string> have;
  for (const NodeId in : node.inputs) {
    const auto names = known_fields(nodes[size_t(in)], options);
    if (!names) return;  // a field parameter may mean any of the inputs
    have.insert(have.end(), names->begin(), names->end());
  }
  for (const ParamDecl& d : op->params->schema.decls()) {
    if (d.ref.type() != ParamType::field) continue;
    const std::string field = param_text(d);
    if (field.empty() || std::find(have.begin(), have.end(), field) != have.end()) continue;
    out.push_back({id, ErrorKind::usage,
                   fmt::format("{}: {} {}: field '{}' not found; {}", step_label(node, id), op->operation, d.name, field,
                               unknown_name_hint(field, have))});
  }
}

// What is missing of a file or of the files of a series; "" when nothing is.
std::string missing_file(const std::string& path) {
  if (is_lent(path)) return "";
  if (!names_series(path)) return file_exists(path) ? "" : path + ": no such file";
  try {
    series_files(path);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

}  // namespace

std::vector<Mistake> find_mistakes(const std::vector<Node>& nodes, const GraphOptions& options, std::span<const NodeId> sinks) {
  std::vector<char> reached(nodes.size(), sinks.empty());
  for (const NodeId s : sinks) reached[size_t(s)] = 1;
  for (size_t i = nodes.size(); i-- > 0;)
    if (reached[i])
      for (const NodeId in : nodes[i].inputs) reached[size_t(in)] = 1;
  std::vector<Mistake> out;
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (!reached[i]) continue;
    const Node& node = nodes[i];
    const auto id = NodeId(i);
    if (!node.mistake.empty()) out.push_back({id, ErrorKind::usage, step_label(node, id) + ": " + node.mistake});
    if (auto* read = std::get_if<ReadNode>(&node.what))
      if (const std::string missing = missing_file(read->path); !missing.empty())
        out.push_back({id, ErrorKind::data, step_label(node, id) + ": " + missing});
    check_fields(nodes, id, options, out);
  }
  return out;
}

void throw_mistakes(const std::vector<Mistake>& mistakes) {
  // Usage before data: a missing file may be the consequence of a wrong word.
  ErrorKind kind = ErrorKind::data;
  for (const Mistake& m : mistakes)
    if (m.kind == ErrorKind::usage) kind = ErrorKind::usage;
  if (mistakes.size() == 1) throw Error(kind, mistakes[0].text);
  constexpr size_t shown = 50;
  std::string text = fmt::format("{} errors:", mistakes.size());
  for (size_t i = 0; i < std::min(shown, mistakes.size()); ++i) text += "\n  " + mistakes[i].text;
  if (mistakes.size() > shown) text += fmt::format("\n  ... and {} more", mistakes.size() - shown);
  throw Error(kind, text);
}

std::vector<Mistake> Graph::mistakes() const { return find_mistakes(state_->nodes, state_->options, {}); }

void Graph::validate() const {
  if (const auto found = mistakes(); !found.empty()) throw_mistakes(found);
}

}  // namespace sg
