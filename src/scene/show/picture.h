// SPDX-License-Identifier: Apache-2.0
// The words for pictures on a surface.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "image/texture/patterns.h"
#include "scene/items/surface_pictures.h"

namespace sg {

struct PictureShow {
  std::string picture;
  std::optional<TexturePattern> pattern;
  FieldName picture_coordinates;
  std::vector<double> picture_repeats;
  TextureWrap picture_wrap = TextureWrap::repeat;
  TextureFilter picture_filter = TextureFilter::anisotropic;
  TexelEncoding picture_encoding = TexelEncoding::srgb;
  std::string normal_picture, material_picture;
  double normal_scale = 1;
  /// Of files of data, by their names: who reads these puts them here, no word does.
  std::map<std::pair<std::string, TexelEncoding>, std::shared_ptr<const Texture>> grids;

  /// Whether there is one of colours.
  bool any() const { return !picture.empty() || pattern; }
  bool any_other() const { return !normal_picture.empty() || !material_picture.empty(); }
};
void describe(Schema& s, PictureShow& p);
/// Throws Error(usage) for two pictures at once.
void check(const PictureShow& p);

/// The field with the coordinates that are wanted, or that the data has for this. Throws Error(usage) where there is none, and for one that
/// holds none.
const Field& picture_coordinates(const Dataset& data, const FieldName& wanted);

/// A file's picture, placed as the words say. Throws Error for files that cannot be read, and data without coordinates.
SurfacePicture picture_in_file(const Dataset& data, const PictureShow& p, const std::string& path, TexelEncoding encoding);

/// The pictures that the words request, on `data`; null for none. A file is decoded once for a dataset and time of its change. Throws
/// Error for files that cannot be read.
std::shared_ptr<const SurfacePictures> pictures_of(const Dataset& data, const PictureShow& p);

}  // namespace sg
