// SPDX-License-Identifier: Apache-2.0
// The same few shapes at many points: arrows, barbs, cones, shapes of files.
#pragma once
#include "color/legend_content.h"
#include "filter/glyph/choose.h"
#include "scene/choose/coloring.h"
#include "scene/scene.h"
#include "scene/show/material_words.h"

namespace sg {

struct GlyphsShow {
  ColoringParams coloring;
  MaterialShow material;
  GlyphParams glyphs;
  double opacity = 1, width = 1.6;
  bool lit = true, pixels = false;
};
void describe(Schema& s, GlyphsShow& p);

/// Without a field or colour: the length of the vectors (barbs: one dark colour). The legend shows which size represents which length. What
/// was chosen goes to context.info(). Throws Error(usage) for data without vectors and unknown names.
std::optional<Legend> add(Scene& scene, const DatasetPtr& data, const GlyphsShow& p, Context& context);

/// The vectors that colour them when nothing else is named; null for barbs, and where the material has a colour of its own.
const Field* automatic_field(const GlyphsShow& p, const Dataset& data);

/// What makes the parts of a collection one picture: the same length for the same value (the factor that suits the part with the most
/// glyphs, for the largest value of all parts), and glyphs by the share of space that a part takes, as many in all as one mesh has.
/// Parameters that state size, factor, places or their number stay as they are.
void share(const std::vector<DatasetPtr>& parts, const std::vector<GlyphsShow*>& params);

}  // namespace sg
