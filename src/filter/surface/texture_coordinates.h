// SPDX-License-Identifier: Apache-2.0
// Coordinates of pictures on surfaces.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// Which way points are sent into a picture.
enum class TextureMap { plane, cylinder, sphere, box };
constexpr auto enum_words(TextureMap) {
  using enum TextureMap;
  return std::array{Word{"plane", plane}, Word{"cylinder", cylinder}, Word{"sphere", sphere}, Word{"box", box}};
}
enum class TextureAxis { automatic, x, y, z };
constexpr auto enum_words(TextureAxis) {
  using enum TextureAxis;
  return std::array{Word{"auto", automatic}, Word{"x", x}, Word{"y", y}, Word{"z", z}};
}

struct TextureCoordinatesParams {
  TextureMap map = TextureMap::plane;
  TextureAxis axis = TextureAxis::automatic;
  double size = 0;
};
void describe(Schema& s, TextureCoordinatesParams& p);

/// Point field "texture coordinates" (f32 x 2, role tcoords) about the middle of the data's box. plane: along the two axes across `axis`,
/// from 0 to 1 over the box. cylinder, sphere: the angle about `axis` as 0 to 1, and the height, or the angle from the lower pole. box: as
/// plane, each polygon by the axis that it faces most. With `size`, plane, box and the height of cylinders count in that length instead.
/// Points where a seam ends and the next turn begins, poles, and the edges of a box are doubled. All fields are carried. Other mesh kinds:
/// their surface (surface::polygon_surface). O(corners log corners).
DatasetPtr texture_coordinates(const DatasetPtr& in, const TextureCoordinatesParams& p, Context& ctx);

}  // namespace sg
