// SPDX-License-Identifier: Apache-2.0
// GlyphSet: shapes placed at many points. What glyphs are drawn from.
#pragma once
#include <memory>
#include <vector>

#include "filter/glyph/instances.h"
#include "render/prepare/prepared.h"

namespace sg::raster {

/// A shape ready to be drawn many times.
struct GlyphShape {
  static constexpr size_t pad = 64;  ///< lists end with that many numbers more than a multiple of the widest vector needs
  static constexpr size_t row = 16;  ///< numbers of a triangle in `faces`

  size_t points = 0, triangles = 0;
  std::vector<float> x, y, z;           ///< of the points; padded
  std::vector<int32_t> corners[3];      ///< of the triangles; padded with triangles of no area
  std::vector<uint32_t> triangle_list;  ///< the same, three a triangle
  bool closed = false;                  ///< faces turned away from the viewer are never seen
  bool smooth = false;                  ///< some normals are not those of the faces
  /// Of each triangle: face normal (3), then the smooth normal as a linear function of the place: constant (3), matrix by rows (9).
  std::vector<float> faces;
  SegmentSet segments;

  size_t bytes() const {
    return 4 * (x.size() + y.size() + z.size() + 3 * corners[0].size() + triangle_list.size() + faces.size()) + segments.bytes();
  }
};
std::shared_ptr<const GlyphShape> glyph_shape(const DatasetPtr& shape, double feature_angle, bool flat);

/// What an item draws: primitive = first_primitive + (instance << shift) + triangle (or line segment) of the shape.
struct GlyphSet {
  std::vector<std::shared_ptr<const GlyphShape>> shapes;
  std::shared_ptr<const GlyphInstances> instances;
  std::shared_ptr<const std::vector<uint32_t>> order;  ///< glyphs near in space are drawn one after the other: the picture stays in cache
  int shift = 0;
  bool in_pixels = false;          ///< sizes are pixels of the final picture
  std::vector<float> faces;        ///< of all shapes, one after the other
  std::vector<int32_t> first_row;  ///< of each shape in `faces`
  bool smooth = false;

  const GlyphShape& shape_of(size_t instance) const {
    const uint8_t* s = instances->shape_numbers();
    return *shapes[s ? s[instance] : 0];
  }
  int32_t row_of(uint32_t primitive) const {
    const uint8_t* s = instances->shape_numbers();
    return (s ? first_row[s[primitive >> shift]] : 0) + int32_t(primitive & ((uint32_t(1) << shift) - 1));
  }
};
/// The instances along a Morton curve through their box.
std::vector<uint32_t> glyph_order(const GlyphInstances& instances);
/// shift for `most` primitives a glyph; fails when the numbers of all of them do not fit 32 bits.
int glyph_shift(size_t instances, size_t most);

}  // namespace sg::raster
