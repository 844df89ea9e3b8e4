// SPDX-License-Identifier: Apache-2.0
// Defaults for drawing glyphs: field, shape, places and size of glyphs; for pictures and for the operation `glyphs`.
#pragma once
#include "filter/glyph/barbs.h"
#include "filter/glyph/geometry.h"
#include "filter/glyph/points.h"
#include "filter/glyph/shapes.h"

namespace sg {

/// What the size of a glyph shows, where that is no field.
enum class GlyphSize { constant, length };
constexpr auto enum_words(GlyphSize) {
  using enum GlyphSize;
  return std::array{Word{"constant", constant}, Word{"length", length}};
}

struct GlyphParams {
  FieldName vectors, frames;
  GlyphShapeParams shape;
  std::optional<std::string> size_by;  ///< a word of GlyphSize, or a field
  double size = 0, factor = 0;
  std::optional<GlyphPlaces> place;
  int64_t count = 0, every = 10, seed = 1;
  double spacing = 0;
  BarbParams barbs;
  GlyphParams() { shape.shape.reset(); }
};
void describe(Schema& s, GlyphParams& p);

/// The vectors that glyphs show when none are named: by role, else of 3, else of 2 components; points before cells. Null: none.
const Field* automatic_vectors(const Dataset& data);

struct ChosenGlyphs {
  DatasetPtr data;  ///< the places with their fields
  std::vector<DatasetPtr> shapes;
  GlyphRule rule;
  std::string vectors;         ///< field of the input that turns them; "" = none
  bool flat = false;           ///< shapes in a plane, drawn without light
  bool barbs = false;          ///< sizes may be in pixels
  double longest = 0, of = 0;  ///< size of the largest glyph, and the vector's length or value that it shows (0: none)
  std::string note;            ///< what was chosen and why, one line
};

/// `in_pixels`: sizes are pixels of a picture (size 0: 34 for barbs, 40 for others). Defaults: the active vectors; flat arrows for flat
/// data whose vectors lie in it, else arrows; at most 2500 places evenly (900 in a plane, 180 barbs), all points where there are fewer; the
/// vectors' lengths as sizes, the longest about as long as the distance between glyphs. Throws Error(usage).
ChosenGlyphs choose_glyphs(const DatasetPtr& data, const GlyphParams& p, bool in_pixels, Context& context);

struct GlyphsParams : GlyphParams {};

/// The glyphs of choose_glyphs() as a mesh: a SurfaceMesh for export, with the point fields of the places.
DatasetPtr glyphs(const DatasetPtr& data, const GlyphsParams& p, Context& context);

}  // namespace sg
