// SPDX-License-Identifier: Apache-2.0
// Which cell holds a point, which point of the mesh is nearest, which face a ray meets, for every mesh kind. Grids are answered by
// arithmetic, other meshes by a CellTree; points that come in order walk to the neighbour first.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "base/context.h"
#include "data/cells/shape/cell_map.h"
#include "data/dataset.h"

namespace sg {

/// Shared and immutable; made once per dataset. Queries go through a LocatorCursor, one per thread.
class CellLocator {
 public:
  CellLocator(DatasetPtr dataset, Context& context);
  ~CellLocator();
  const DatasetPtr& dataset() const;
  struct Index;
  const Index& index() const { return *index_; }

 private:
  std::unique_ptr<const Index> index_;
};

struct NearestPlace {
  int64_t cell = -1;
  Vec3 at{0, 0, 0};
  double distance2 = 0;
};
struct RayHit {
  int64_t cell = -1;
  double t = 0;
  Vec3 normal{0, 0, 0};  ///< unit, of the face or cell that was hit
};

class LocatorCursor {
 public:
  explicit LocatorCursor(const CellLocator& locator);
  ~LocatorCursor();
  LocatorCursor(LocatorCursor&&) noexcept;

  /// The cell that holds x: of several (shared faces, overlapping cells) the one with the smallest id, whatever was asked before;
  /// AMR: the finest. -1 outside. 2D meshes: within 1e-6 of the mesh's size of the surface. Hidden cells never answer.
  int64_t find(Vec3 x);
  /// The same without the rule of the smallest id: the cell of the last answer when it holds x, else the first that is found; AMR and
  /// grids: as find(). For paths through continuous fields.
  int64_t find_any(Vec3 x);
  /// Point ids and interpolation weights of the last find() that was not -1; they stay valid until the next.
  std::span<const int64_t> ids() const;
  std::span<const double> weights() const;
  const CellPlace& place() const;
  CellMap& map();

  /// Nearest point of the mesh within `radius`.
  NearestPlace nearest(Vec3 x, double radius = HUGE_VAL);
  /// First hit of the ray x + t d, t in [t0, t1], with a 2D cell or a face of a solid cell (curved faces by their tessellation).
  std::optional<RayHit> first_hit(Vec3 x, Vec3 d, double t0 = 0, double t1 = HUGE_VAL);
  /// The same of these cells alone, in any order; they are not hidden ones.
  std::optional<RayHit> first_hit_among(std::span<const uint32_t> cells, Vec3 x, Vec3 d, double t0, double t1);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sg
