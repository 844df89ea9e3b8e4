// SPDX-License-Identifier: Apache-2.0
// Instanced shapes: the vertices of each instance are made while it is drawn and forgotten afterwards. Internal to raster/.
#pragma once
#include "filter/glyph/instances.h"
#include "render/raster/marks/marks.h"

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

struct GlyphJob {
  EyeView view;
  const GlyphSet* set;
  uint32_t first_primitive;
  int small;          ///< as in TriangleJob
  bool cull;          ///< leave out the far side of closed shapes
  float pixel_scale;  ///< pixels of this frame per pixel of the final picture
  uint64_t* keys;
};
/// The triangles of glyphs order[begin..end) as draw_triangles() draws a surface with the points a*x + b*y + c*z + p, in f32 and that
/// order.
void draw_glyphs(const GlyphJob& job, size_t begin, size_t end, std::vector<TriangleRecord>& large);
void draw_glyphs_reference(const GlyphJob& job, size_t begin, size_t end, std::vector<TriangleRecord>& large);

/// Twelve numbers of an instance as it is drawn from a view: sizes in pixels have become lengths. False: there is no glyph.
bool glyph_matrix(const GlyphSet& set, const EyeView& view, float pixel_scale, size_t instance, float* m);

/// Like shade(), for the pixels of an item of glyphs; depth of the batch is given, `triangle` holds the primitive in the item.
void shade_glyphs(const PreparedItem& item, const EyeView& view, float pixel_scale, const std::vector<Lamp>& lights, ShadeBatch& b);
struct GlyphLight {
  const EyeView& view;
  const GlyphSet& set;
  float pixel_scale;
  const Material& material;
  std::span<const Lamp> lights;
};
/// Light and gloss of the pixels of a batch. Pads the batch.
void light_glyphs(const GlyphLight& job, ShadeBatch& batch);

/// The lines of the shapes on the picture.
std::vector<MarkRecord> glyph_marks(const PreparedItem& item, uint32_t number, const Projection& projection, double pixel_scale);

}  // namespace sg::raster
