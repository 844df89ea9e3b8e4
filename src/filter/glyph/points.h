// SPDX-License-Identifier: Apache-2.0
// glyph_points: where glyphs go.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// Where glyphs are placed, see glyph_points().
enum class GlyphPlaces { all, every, even, cells, random, apart, lines };
constexpr auto enum_words(GlyphPlaces) {
  using enum GlyphPlaces;
  return std::array{Word{"all", all},       Word{"every", every}, Word{"even", even},  Word{"cells", cells},
                    Word{"random", random}, Word{"apart", apart}, Word{"lines", lines}};
}

struct GlyphPointsParams {
  GlyphPlaces mode = GlyphPlaces::even;
  int64_t count = 2000, every = 10, seed = 1;
  double spacing = 0, separation = 0.5;
  FieldName diameter = {};
  double scale = 1;
  std::optional<Vec3> view = {};
};
inline void describe(Schema& s, GlyphPointsParams& p) {
  s("mode", p.mode,
    "all points; every n-th point; even: about 'count' points on a grid in space; cells: cell centres; random; apart: points whose glyphs "
    "do not overlap, large ones first; lines: evenly along the lines of a mesh.");
  s("count", p.count, "even, random: approximate number of points.").range(1, 1e9);
  s("every", p.every, "every: take one point out of this many.").range(1, 1e12);
  s("seed", p.seed, "random: another number gives other points.");
  s("spacing", p.spacing,
    "lines, even: distance between points; apart: diameter of a glyph without 'diameter'; 0: from the size of the data.")
      .unit("length")
      .at_least(0);
  s("separation", p.separation, "lines: points closer than this share of the spacing to an earlier one are left out; 0 keeps all.")
      .range(0, 1);
  s("diameter", p.diameter, "apart: point field of sizes (of vectors: their lengths), times 'scale'.").takes(fields::on_points);
  s("scale", p.scale, "apart: factor on the field of diameters.").positive();
  s("view", p.view,
    "apart: viewing direction along which glyphs must not overlap in the picture. Default: they must not overlap in space.");
}

/// Places for glyphs as a PointCloud whose point fields are those of the mesh there (cell fields: of the cell that holds the place):
///   all, every   points of the mesh that are not hidden
///   even         cell-filled meshes in space and flat ones: the points of a grid over the box that lie in a cell, interpolated; others:
///                of the points in each box of a grid the one nearest to its middle
///   cells        means of the corners of each cell that is not hidden
///   random       uniform by volume (area of surfaces, number of points of clouds), from a counter-based generator: ordered by chance
///   apart        greedy: by size from large to small, then by number; kept when it overlaps none before
///   lines        along each poly-line, centred, at equal arc lengths; adds the point field 'tangent' (f64 x 3, unit)
/// The same bytes for any number of threads. Throws Error(usage) for unknown fields, and for lines of a mesh that has none.
DatasetPtr glyph_points(const DatasetPtr& data, const GlyphPointsParams& p, Context& context);

/// Typical distance of neighbouring places: that of a grid of as many points over the data's box (area of surfaces).
double typical_spacing(const Dataset& data, size_t places);

/// 3 for data with extent along all axes, 2 for flat data (in `flat_axis`: the axis without), else less.
int extended_axes(const Box3& box, int* flat_axis = nullptr);

}  // namespace sg
