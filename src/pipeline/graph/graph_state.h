// SPDX-License-Identifier: Apache-2.0
// Private to the pipeline: what a Graph holds, and the plan that evaluation and explanation share.
#pragma once
#include <variant>

#include "base/error.h"
#include "pipeline/graph/graph.h"

namespace sg {

struct ReadNode {
  std::string path;
  ReadOptions options;
};
struct DataNode {
  Data data;
  Key key;
};
struct OperationNode {
  std::string operation;
  const Operation* found = nullptr;  ///< null: unknown
  std::optional<ParamSet> params;    ///< empty: mistakes in what was stated
  bool follows_time = false;         ///< a source, or a filter of series, whose parameter `time` was left open
};

struct Node {
  std::string name;  ///< as given, or ""
  std::variant<ReadNode, DataNode, OperationNode> what;
  std::vector<NodeId> inputs;
  std::string mistake;  ///< found while adding, or ""
};

struct Graph::State {
  GraphOptions options;
  std::shared_ptr<Cache> cache;
  std::vector<Node> nodes;
  std::vector<int> depth;      ///< longest chain above each node
  std::vector<double> copies;  ///< how often one input may occur in each node's result: steps that join several add up

  NodeId add(Node node, OperationNode operation, const std::vector<NodeId>& inputs);
};

/// "step 2" or "step 'bone'".
std::string step_label(const Node& node, NodeId id);
/// "contour", "read 'head.mhd'", "given data".
std::string step_does(const Node& node);
/// Of the nodes on which `sinks` depend; all nodes when sinks is empty.
std::vector<Mistake> find_mistakes(const std::vector<Node>& nodes, const GraphOptions& options, std::span<const NodeId> sinks);
[[noreturn]] void throw_mistakes(const std::vector<Mistake>& mistakes);

/// One result to make: a node and what is needed of it. Nodes with equal keys share one.
struct Step {
  NodeId node = 0;
  Request request;
  Key key;
  ParamSet params;  ///< operations only
  ReadOptions read;
  std::vector<int> inputs;  ///< indices of steps, all smaller than its own
  int consumers = 0;        ///< inputs of other steps and targets that refer to it; those behind a series alone have none
  int series = -1;          ///< step of the input that is taken time by time: it is here for its key and is never run as such
  bool cut = false;         ///< a piece of its one input, which is the whole result of the same node
  bool varies = false;      ///< its result belongs to the requested time; known in plans for one time of a series
};

struct Plan {
  std::vector<Step> steps;
  std::vector<int> targets;  ///< step of each target
};

/// The friend of Graph that sees its state.
class Planner {
 public:
  /// `constant` (one per node, or null): readers that do not get the time. `together`: see works_by_piece().
  static Plan make(const Graph& graph, std::span<const Target> targets, const std::vector<char>* constant = nullptr, bool together = false);
  static const Graph::State& state(const Graph& graph) { return *graph.state_; }
};

}  // namespace sg
