// SPDX-License-Identifier: Apache-2.0
// What standing and lying legends have in common: their texts, and sizes in letters.
#pragma once
#include <string>

#include "render/annotate/legend/legend.h"

namespace sg::legend {

// All in font sizes.
inline constexpr double margin = 1.1;
inline constexpr double column_gap = 1.5;  ///< between legends
inline constexpr double bar_width = 1.3;
inline constexpr double label_gap = 0.75;  ///< from a standing bar to its numbers
inline constexpr double triangle = 1.0;
inline constexpr double widest_name = 12;
inline constexpr double panel_gap = 0.3;
inline constexpr double longest_glyph = 5, glyph_gap = 0.6;

/// Letters of that size.
TextStyle sized(double font);

/// A name that no legend has room for keeps its beginning and its end; laying it out takes the square of its length.
std::string shortened(const std::string& text);
/// Title and unit; lines may break after underscores, and not within the unit.
std::string title_of(const ColorScale& scale);
std::string name_of_label(const ColorScale& scale, size_t i);
/// Whether colours are a bar with numbers; else they are a list of names.
inline bool has_bar(const ColorScale& s) { return s.labels.empty() || !s.limits.empty(); }

/// Texts, triangles and what else follows from the scale alone; letters of size `font`. Places are left open.
LegendLayout begun(const Legend& scale, double font, bool nan);

/// Names of labels, at most `room` with the line that says how many are left out; of those the widest width into `label_width`.
void take_names(const Overlay& overlay, const ColorScale& scale, size_t room, LegendLayout& layout);

/// Size and text of the glyph; returns the height of its row above the bar. A legend is made wide enough for any glyph, since its length is
/// known only once the width is.
double plan_glyph(const Overlay& overlay, const GlyphLegend& glyph, double font, LegendLayout& layout);

}  // namespace sg::legend
