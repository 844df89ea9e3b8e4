// SPDX-License-Identifier: Apache-2.0
// LevelPatches: small triangles that touch the level sets of a volume, so that fields of its data and pictures that these place are seen
// on level sets as on any surface.
#pragma once
#include <memory>

#include "base/context.h"
#include "base/threads/lending.h"
#include "index/cell_locator.h"
#include "render/prepare/picture_set.h"

namespace sg::trace {

class LevelPatches {
 public:
  /// `reach`: world length on which fields are straight enough. Throws Error(usage) where the data has no such coordinates.
  LevelPatches(const SurfacePictures& pictures, const SurfaceMaterial& made_of, const DatasetPtr& data, double reach, Context& context);
  ~LevelPatches();

  /// An item of one triangle, whose first corner is this place of the world; `normal` is unit. The values of points beyond the data are
  /// those of its border. Null where the place lies outside of the data. Any number of threads.
  std::shared_ptr<const raster::PreparedItem> at(Vec3 place, Vec3 normal, Vec4f color) const;

  /// For what is the same everywhere: which pictures there are, of what the surface is made.
  const raster::PreparedItem& all() const { return whole_; }

 private:
  struct Patch;
  std::unique_ptr<Patch> make() const;

  CellLocator locator_;
  double reach_;
  raster::PreparedItem whole_;  ///< its pictures have coordinates for all points of the data
  Lending<Patch> patches_;
};

}  // namespace sg::trace
