// SPDX-License-Identifier: Apache-2.0
// What lies above an operation that takes a whole time series: its times, and its results one time after the other.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "data/dataset.h"
#include "pipeline/graph/graph.h"

namespace sg {

/// "0:10:6" = 6 times from 0 to 10; "0:10:0.5", with a third number that is not whole, = every 0.5; "0,1,2.5" = these. Throws Error(usage)
/// naming `who`.
std::vector<double> parse_times(std::string_view text, std::string_view who);

struct Node;

/// Private to the pipeline.
class SeriesInput {
 public:
  /// Times: those that the parameter `times` of the consumer names, else those that the files above list (all the same). Files without
  /// time, or whose step the user chose, are the same at all times. Throws Error(usage) for sources of any time without `times`, for
  /// `times` that the files do not have, and for files of different times. The loader keeps no step; it is for one thread at a time and for
  /// as long as the graph and the context live.
  static Series open(const Graph& graph, const Node& consumer, const Request& request, const ParamSet& params, Context& context);

 private:
  static Data evaluate_at(const Graph& graph, NodeId node, Request request, double time, const std::vector<char>& constant,
                          Context& context);
};

}  // namespace sg
