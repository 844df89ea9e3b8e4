// SPDX-License-Identifier: Apache-2.0
// Items of a scene as JSON, their numbers in a store.
#pragma once
#include <string>
#include <vector>

#include "base/context.h"
#include "pipeline/offline/pack/arrays.h"
#include "pipeline/offline/pack/quality.h"
#include "pipeline/offline/pack/scales.h"
#include "render/prepare/prepared.h"
#include "scene/items/volume_item.h"

namespace sg::offline {

/// What all items are packed with.
struct Packing {
  ArrayStore& arrays;
  ScaleStore& scales;
  const Quality& wanted;
  size_t small;                     ///< what has no more bytes than that stays as it is
  std::vector<std::string>& notes;  ///< what is coarser or otherwise than the picture's, each once

  /// For what has so many bytes.
  const Quality& quality(size_t bytes) const { return bytes <= small ? qualities[finest] : wanted; }
  void note(const std::string& text) const;
};

/// {"kind":"surface"|"lines"|"points"|"discs"|"glyphs"|"glyph_lines", ...}; null where nothing of it is seen.
Json pack_item(const raster::PreparedItem& item, const Packing& packing);
Json pack_surface(const raster::PreparedItem& item, const Packing& packing);
Json pack_lines(const raster::PreparedItem& item, const Packing& packing);
Json pack_points(const raster::PreparedItem& item, const Packing& packing);
Json pack_glyphs(const raster::PreparedItem& item, const Packing& packing);
/// {"kind":"constant"|"scale"|"direct", ...} of colours that belong to a source.
Json pack_color(const raster::ColorSource& source, const struct FlatColors& colors, const Quality& quality, const Packing& packing);

/// {"kind":"volume", ...}: a lattice of 8 or 16 bits; other meshes are sampled on one.
Json pack_volume(const VolumeItem& item, const Packing& packing, Context& context);

}  // namespace sg::offline
