// SPDX-License-Identifier: Apache-2.0
// How a FlowField finds velocities fast: by arithmetic in grids, by walking across faces in solid cells, else by the locator. Geometry
// only, so that the time steps of one mesh share it. Internal to filter/flow.
#pragma once
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "data/cells/cell_neighbors.h"
#include "data/lattice.h"
#include "filter/flow/cursors/tet_neighbors.h"
#include "filter/flow/cursors/walk_start.h"
#include "index/cell_locator.h"
#include "index/cell_probe.h"

namespace sg {

/// Velocities at points, packed.
struct PointVectors {
  const float* f32 = nullptr;  ///< one of the two
  const double* f64 = nullptr;
  int components = 3;
  Vec3 operator()(size_t id) const {
    if (f32) {
      const float* v = f32 + id * size_t(components);
      return {v[0], v[1], components > 2 ? v[2] : 0.0};
    }
    const double* v = f64 + id * size_t(components);
    return {v[0], v[1], components > 2 ? v[2] : 0.0};
  }
};

/// A uniform or rectilinear grid with cells along all axes, or all but one.
struct LatticeFlow {
  std::shared_ptr<const Lattice> keep;
  bool separable = false;
  int flat_axis = -1;  ///< the axis without cells
  std::array<size_t, 3> cells{1, 1, 1};
  std::array<size_t, 3> stride{0, 0, 0};  ///< points from one to the next along each axis; 0 along the flat one
  Vec3 origin, step[3], rows[3];          ///< affine: rows turn x - origin into numbers of points; the flat axis' into a distance
  const double* axis[3] = {nullptr, nullptr, nullptr};
  double length = 1;  ///< affine: size of a cell
  Vec3 normal;        ///< of a flat grid
};

/// A place in a grid: cell and how far in it.
struct LatticePlace {
  size_t i[3] = {0, 0, 0};
  double f[3] = {0, 0, 0};
};

class FlowAccess {
 public:
  /// solids: any cells of volume that walks can cross, see SolidCursor; cells: only by the locator.
  enum class Kind : uint8_t { lattice, tets, solids, cells };
  /// `index`: a locator of the same mesh, of this or another dataset, or null: made when it is first needed.
  FlowAccess(DatasetPtr mesh, std::shared_ptr<const CellLocator> index, const Context& context);

  Kind kind = Kind::cells;
  LatticeFlow lattice;
  SimplexArrays simplices;
  std::shared_ptr<const WalkStart> start;  ///< tets and solids
  std::shared_ptr<const std::vector<int32_t, HugeAllocator<int32_t>>>
      tets;                                        ///< four neighbours a cell, opposite to its corners; -1 for none
  std::shared_ptr<const Lattice> curvilinear;      ///< solids: of a grid,
  std::shared_ptr<const CellNeighbors> neighbors;  ///< or of a mesh
  bool any_hidden = false;
  CellType cell_type(size_t cell) const { return simplices.types ? CellType(simplices.types[cell]) : simplices.single; }
  const std::shared_ptr<const CellLocator>& locator() const;
  const DatasetPtr& mesh() const { return mesh_; }

 private:
  void open_curvilinear(const Context& context);
  void open_tets(const Context& context);
  void open_solids(const Context& context);
  /// Made once for the mesh.
  template <class Corner, class Takes>
  void make_start(size_t cells, Corner&& corner, Takes&& takes);
  DatasetPtr mesh_;
  mutable std::once_flag once_;
  mutable std::shared_ptr<const CellLocator> locator_;
};

}  // namespace sg
