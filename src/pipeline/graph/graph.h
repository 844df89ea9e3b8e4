// SPDX-License-Identifier: Apache-2.0
// Graph: steps that read, compute and filter, evaluated on demand. The sink pulls; the request is rewritten on its way up;
// equal work is done once; a result between two steps dies with its last consumer unless the cache keeps it.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/io.h"
#include "pipeline/graph/cache.h"
#include "pipeline/graph/key.h"
#include "pipeline/graph/request.h"
#include "pipeline/operation/operation.h"

namespace sg {

/// Steps are numbered 0, 1, ... in the order in which they are added; messages count from 1.
using NodeId = int;

struct GraphOptions {
  std::span<const Operation> operations = sg::operations();
  std::shared_ptr<Cache> cache;                ///< shared with other graphs; null = one of its own
  uint64_t cache_limit = uint64_t(512) << 20;  ///< bytes, of its own cache
  bool strict = false;                         ///< keys of files cover their content, not only path, size and time of change
  /// Reads a file; null = read_part. ReadOptions already holds the time, piece and fields that the
  /// request needs; it may hold names of fields that a filter makes, so a reader passes over those that the file lacks.
  std::function<Data(const std::string& path, const ReadOptions& options, const Request& request, Context& context)> read;
  /// Told of each step that has run, by its name, and of the seconds it took; from any thread. May be null.
  std::function<void(std::string_view name, double seconds)> on_ran;
  /// Times of a file; null = file_times.
  std::function<std::vector<double>(const std::string& path, const ReadOptions& options, Context& context)> times;
  /// Names of the fields in a file, when they are cheap to find out; lets validate() check field names. May be null.
  std::function<std::optional<std::vector<std::string>>(const std::string& path, const ReadOptions& options)> field_names;
};

struct Target {
  NodeId node = 0;
  Request request;
};

struct Mistake {
  NodeId node = 0;
  ErrorKind kind = ErrorKind::usage;  ///< data: a file is missing
  std::string text;
};

/// One line of a plan.
struct PlannedStep {
  enum class State { run, cached, not_needed, each_time };  ///< each_time: runs once for each time of a series, inside its consumer
  NodeId node = 0;
  std::string name, does;
  Key key;
  Request request;
  State state = State::run;
  uint64_t bytes = 0;                   ///< of the result: exact when cached, else expected
  double seconds = 0;                   ///< expected; 0 unless the step runs
  bool reads_parts = false;             ///< reads a file in a format of which parts can be read
  std::optional<uint64_t> frames = {};  ///< of a simulator that runs: see Estimate
  uint64_t steps = 0, stored = 0;
  std::string guess = {};
};

/// Adding is for one thread; evaluate and explain are for any number of threads, but not from inside a parallel loop.
class Graph {
 public:
  explicit Graph(GraphOptions options = {});
  ~Graph();
  Graph(Graph&&) noexcept;
  Graph& operator=(Graph&&) noexcept;

  /// `name` is what messages call the step; "" = its number.
  NodeId add_read(std::string path, ReadOptions options = {}, std::string name = {});
  /// Data at hand. Equal words in `content` vouch for equal data; "" = equal to nothing else.
  NodeId add_data(Data data, std::string content = {}, std::string name = {});
  /// A source (no inputs) or a filter, with its "key=value" words. Mistakes wait for validate().
  NodeId add_operation(std::string operation, std::vector<std::string> words = {}, std::vector<NodeId> inputs = {}, std::string name = {});
  /// The same with typed parameters (make_params(), set_value()), of which the graph keeps a copy.
  NodeId add_operation(const Operation& operation, const ParamSet& params, std::vector<NodeId> inputs = {}, std::string name = {});
  size_t size() const;

  /// All mistakes that can be seen without running: unknown operations and parameters, bad values, wrong numbers of inputs,
  /// missing files, and field names where the fields of the input are known.
  std::vector<Mistake> mistakes() const;
  /// Throws one Error with all mistakes.
  void validate() const;

  /// Validates what `node` needs, then runs what is not there yet. Throws Error; "while running 'contour' (step 2)".
  Data evaluate(NodeId node, const Request& request, Context& context) const;
  /// Several sinks together: what they share is read once, with the fields of all.
  std::vector<Data> evaluate(std::span<const Target> targets, Context& context) const;

  /// The key of a node's result for that request.
  Key key(NodeId node, const Request& request = {}) const;
  /// The plan, inputs before consumers; runs nothing and reads no file.
  std::vector<PlannedStep> plan(std::span<const Target> targets) const;
  /// The plan as a table for people.
  std::string explain(NodeId node, const Request& request = {}) const;
  std::string explain(std::span<const Target> targets) const;

  Cache& cache() const;

 private:
  struct State;
  friend class Planner;
  friend class SeriesInput;
  friend class Evaluation;
  std::unique_ptr<State> state_;
};

}  // namespace sg
