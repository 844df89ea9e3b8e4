// SPDX-License-Identifier: Apache-2.0
// Instanced shapes: the vertices of each instance are made while it is drawn and forgotten afterwards. Internal to raster/.
#pragma once
#include "render/prepare/glyph_set.h"
#include "render/raster/marks/marks.h"

namespace sg::raster {

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

/// Twelve numbers of an instance as drawn from a view, with sizes in pixels converted to lengths. False: there is no glyph.
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
