// SPDX-License-Identifier: Apache-2.0
// Glyphs as a mesh of their own: for export and for filters. Pictures draw instances instead.
#pragma once
#include "base/context.h"
#include "filter/glyph/instances.h"

namespace sg {

/// One copy of its shape at each point that has a glyph: a SurfaceMesh of lines of two points and triangles, f32 points about the
/// middle of `data`, the same numbers that a picture of the glyphs uses. Point fields of `data` are repeated for the points of each glyph;
/// cell fields are dropped. Order: by points; the same bytes for any number of threads. Throws Error(usage) when there are more than
/// 2^31 points or triangles.
DatasetPtr glyph_geometry(const DatasetPtr& data, const GlyphRule& rule, const std::vector<DatasetPtr>& shapes, Context& context);

}  // namespace sg
