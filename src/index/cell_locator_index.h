// SPDX-License-Identifier: Apache-2.0
// What a CellLocator holds; only for the files cell_locator*.cpp.
#pragma once
#include <mutex>

#include "index/cell_locator.h"
#include "index/cell_probe.h"
#include "index/cell_tree.h"
#include "index/grid_index.h"

namespace sg {

struct CellLocator::Index {
  enum class Kind { grid, amr, tree, points };
  struct Patch {
    GridIndex grid;
    int level;
    size_t cell_begin, cells, point_begin;
    Box3 box;
    std::vector<uint32_t> rivals;  // others of the same and finer levels that meet the box
  };

  DatasetPtr dataset;
  CellMap map;  // what cursors copy
  Kind kind = Kind::tree;
  bool any_hidden = false;
  double slack = 0;       // how far from points, curves and surfaces
  double tree_slack = 0;  // the same, 0 when all cells are solid
  SimplexArrays simplices;
  std::optional<Lattice> lattice;
  std::optional<GridIndex> grid;
  std::vector<Patch> patches;  // by level
  std::optional<CellTree> patch_tree;

  Index(DatasetPtr d, Context& context);
  /// The tree over the cells; grids and AMR make it when the first query needs it.
  const CellTree& tree() const;

 private:
  void open_amr(const AmrGrid& amr, Context& context);
  mutable std::once_flag once_;
  mutable std::optional<CellTree> tree_;
};

struct LocatorCursor::State {
  const CellLocator::Index* index;
  CellProbe probe;
  int64_t cell = -1;
  CellPlace place;
  bool weights_ready = false;
  std::vector<int64_t> ids;
  std::vector<double> weights;
  const CellLocator::Index::Patch* patch = nullptr;  // of the cell found (AMR)

  explicit State(const CellLocator::Index& i) : index(&i), probe(i.map, i.simplices, i.slack) {}
  bool same_patch(Vec3 x);
  bool hidden(size_t c) { return index->any_hidden && probe.map().reader().hidden(c); }
  int64_t find_amr(Vec3 x);
  int64_t find_tree(Vec3 x);
  int64_t find_point(Vec3 x);
  void make_weights();
};

}  // namespace sg
