// SPDX-License-Identifier: Apache-2.0
// ActiveIndex: one door to all indexes that find what a value crosses, and the choice between them.
#pragma once
#include <string_view>
#include <variant>

#include "index/minmax_octree.h"
#include "index/span/interval_tree.h"
#include "index/span/span_lattice.h"
#include "index/span/span_tree.h"

namespace sg {

enum class ActiveIndexKind : uint8_t { octree, interval_tree, span_tree, span_lattice };
std::string_view active_index_name(ActiveIndexKind kind);

/// Finds the items (cells, groups of cells, cubes of a lattice) whose values lie on both sides of a value.
class ActiveIndex {
 public:
  /// Over the cubes of a lattice: their numbers in MinMaxBricks.
  explicit ActiveIndex(MinMaxOctree octree);
  /// Over any items. Throws an internal Error for kind octree.
  ActiveIndex(const Spans& spans, ActiveIndexKind kind, const Context& context);

  /// The active items in ascending order. The time grows with their number, not with the number of all items.
  std::vector<uint32_t> active(double value) const;
  ActiveIndexKind kind() const { return ActiveIndexKind(index_.index()); }
  size_t items() const { return items_; }
  size_t bytes() const;

 private:
  std::variant<MinMaxOctree, IntervalTree, SpanTree, SpanLattice> index_;
  size_t items_ = 0;
};

/// How cells of a mesh are indexed for contours: in groups of `cells_per_item` consecutive ones.
struct CellActiveIndex {
  ActiveIndex index;
  size_t cells_per_item = 1;
  size_t cells = 0;
  size_t bytes() const { return index.bytes(); }
};

/// Chooses for a mesh: where cells that follow each other lie near each other, groups of 32 in a span lattice, which costs next to
/// nothing to build or keep; else (a group with less than one crossed cell in eight would be common) single cells.
/// Samples as in cell_spans. O(cells).
CellActiveIndex cell_active_index(const Dataset& mesh, const Array& samples, const Context& context);

}  // namespace sg
