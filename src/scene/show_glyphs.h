// SPDX-License-Identifier: Apache-2.0
// The words of `--show 'glyphs ...'` and what they make: a GlyphsItem and its legend.
#pragma once
#include "filter/glyph/choose.h"
#include "scene/show.h"

namespace sg {

struct GlyphsShow {
  ColoringParams coloring;
  GlyphParams glyphs;
  double opacity = 1, width = 1.6;
  bool lit = true, pixels = false;
};
void describe(Schema& s, GlyphsShow& p);

/// Without a field or colour: the length of the vectors (barbs: one dark colour). The legend shows what size stands for what length. What
/// was chosen goes to context.info(). Throws Error(usage) for data without vectors and unknown names.
std::optional<Legend> add(Scene& scene, const DatasetPtr& input, const GlyphsShow& p, Context& context);

}  // namespace sg
