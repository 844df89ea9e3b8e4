// SPDX-License-Identifier: Apache-2.0
// Positions, orientations and sizes of glyphs: one matrix per point of a dataset, no geometry.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "data/dataset.h"

namespace sg {

/// From the fields of a dataset to its glyphs. Shapes are of unit size and point along +x.
struct GlyphRule {
  enum class Size { constant, length, field };

  std::string vectors;         ///< point field of 2 or 3 components that +x turns to; "" = shapes are not turned
  std::string frames;          ///< point field of 9 numbers, a matrix by rows from the shape to the world; takes the place of `vectors`
  std::optional<Vec3> normal;  ///< flat shapes: z stays along it, +x turns to the part of the vector across it; empty = the smallest turn
  Size size = Size::constant;  ///< factor on `scale`: 1, the vector's length, or the absolute value of `size_field`
  std::string size_field;      ///< point field of one component
  double scale = 1;            ///< world length, or pixels, of a shape of unit size whose factor is 1
  double largest = 0;          ///< above 0: no glyph is scaled by more than that
  std::string choice;          ///< point field of one component: number of the shape; "" = 0

  friend bool operator==(const GlyphRule&, const GlyphRule&) = default;
};

/// One per point. A point without a glyph (a vector that is zero or not finite where one is needed, size zero or not finite, a shape that
/// does not exist, a hidden point) has NaN as its first number.
struct GlyphInstances {
  Array matrices;       ///< f32 x 12, packed: rows (a b c p) of the map from the shape to the world relative to `origin`
  Array shapes;         ///< u8, number of the shape; empty = 0 for all
  Vec3 origin;          ///< the middle of the dataset
  size_t standing = 0;  ///< how many are glyphs

  size_t count() const { return matrices.count(); }
  const float* data() const { return reinterpret_cast<const float*>(matrices.raw()); }
  const uint8_t* shape_numbers() const { return shapes.empty() ? nullptr : reinterpret_cast<const uint8_t*>(shapes.raw()); }
  bool stands(size_t i) const { return data()[12 * i] == data()[12 * i]; }
};

/// 48 bytes a point; cached for the most recent datasets and rules. `shape_count`: 1..255. Throws Error(usage) for unknown fields,
/// wrong numbers of components, cell fields and a factor that has no field.
std::shared_ptr<const GlyphInstances> glyph_instances(const DatasetPtr& data, const GlyphRule& rule, size_t shape_count);

/// Where a point of a shape lies, relative to the instances' origin: the same f32 numbers wherever it is made.
inline void glyph_point(const float* m, float x, float y, float z, float* out) {
  for (int r = 0; r < 3; ++r) out[r] = ((m[4 * r] * x + m[4 * r + 1] * y) + m[4 * r + 2] * z) + m[4 * r + 3];
}

/// The matrix that takes +x to the direction of v by the smallest turn (x to -x: about z), or, with a normal, that takes z
/// to it and +x to the direction of the part of v across it. Zero where that has no length.
Mat3 turn_to(Vec3 v, const std::optional<Vec3>& normal);

/// Box of all glyphs whose shape i lies in boxes[i]; that of the turned boxes, in world coordinates.
Box3 glyph_bounds(const GlyphInstances& instances, const std::vector<Box3>& boxes);

}  // namespace sg
