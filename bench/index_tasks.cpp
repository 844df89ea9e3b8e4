// SPDX-License-Identifier: Apache-2.0
// The indexes for repeated contouring side by side: what they cost to build and to keep, and how long a query takes for what it finds.
// Items are the single cells of five million tetrahedra (the octree: the cubes of a 256^3 grid).
#include <fmt/core.h>

#include "bench.h"
#include "index/span/active_index.h"
#include "inputs.h"

namespace sg::bench {

namespace {

ActiveIndex make_index(ActiveIndexKind kind, const Spans& spans, const DatasetPtr& grid) {
  const Context context;
  if (kind == ActiveIndexKind::octree) return ActiveIndex(minmax_octree(grid->fields().require("f").array, {256, 256, 256}));
  return ActiveIndex(spans, kind, context);
}

struct Input {
  DatasetPtr grid;
  Spans spans;
  explicit Input(ActiveIndexKind kind) {
    if (kind == ActiveIndexKind::octree) {
      grid = field_grid(256);
    } else {
      const DatasetPtr tets = tetrahedra(94);
      spans = cell_spans(*tets, tets->fields().require("f").array, 1, Context());
    }
  }
};

}  // namespace

void add_index_tasks(std::vector<Task>& tasks) {
  for (auto kind : {ActiveIndexKind::octree, ActiveIndexKind::interval_tree, ActiveIndexKind::span_tree, ActiveIndexKind::span_lattice}) {
    const std::string size = kind == ActiveIndexKind::octree ? "uniform256" : "tet5M", name(active_index_name(kind));
    tasks.push_back({"index_build", size, "sightglass:" + name, "bytes", [=] {
                       auto input = std::make_shared<Input>(kind);
                       return [=] { return double(make_index(kind, input->spans, input->grid).bytes()); };
                     }});
    // From next to nothing (2.9 is near the largest value) to the largest surface.
    for (double value : {2.9, 2.0, 0.0})
      tasks.push_back({"index_query", fmt::format("{}, value {}", size, value), "sightglass:" + name, "items found", [=] {
                         const Input input(kind);
                         auto index = std::make_shared<ActiveIndex>(make_index(kind, input.spans, input.grid));
                         return [=] { return double(index->active(value).size()); };
                       }});
  }
}

}  // namespace sg::bench
