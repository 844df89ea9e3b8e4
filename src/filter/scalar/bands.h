// SPDX-License-Identifier: Apache-2.0
// Filled contours: a surface cut into bands of values.
#pragma once
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct BandsParams {
  FieldName field = {};
  int component = -1;
  std::vector<double> values = {};
  int count = 10;
  bool outside = true;
};
inline void describe(Schema& s, BandsParams& p) {
  s("field", p.field, "Point field; default: the active scalar.").takes(fields::on_points);
  s("component", p.component, "Component of the field; -1: the only one, or the magnitude.").at_least(-1);
  s("values", p.values, "Limits between bands; default: equal bands over the field's range.").unit("@field");
  s("count", p.count, "Number of bands when no values are given.").range(1, 100000);
  s("outside", p.outside, "Keep what lies below the first and above the last value, as bands of their own.");
}

/// The faces of a surface or flat grid (of solids: their skin), cut where the field equals each value: every polygon of the result
/// lies in one band, values[b-1] <= field < values[b]. Cell fields 'band' (i32, 0 below the first value), 'band low' and 'band high'
/// (f64; the ends of the range outermost). Borders are the lines that `contour` finds: straight from edge to edge; four-sided cells
/// that can be cut in two ways are decided by the bilinear function on them; non-convex polygons are cut by their triangles. The
/// bands cover the surface exactly, without gaps or T-joints. Points are f64: those of the input first, then one for each edge and
/// value; point fields are interpolated, the field itself is the value there. Polygons with a NaN at a corner are left out, with
/// a note. Values are sorted, doubles count once. Throws Error(usage) for cell fields, values that are not finite, meshes without faces.
DatasetPtr bands(const DatasetPtr& in, const BandsParams& p, Context& ctx);

/// The limits that bands() chooses where none are stated, over all parts of the data (data/ranks/over_all.h). Throws what it throws.
std::vector<double> choose_band_limits(const Dataset& in, const BandsParams& p, const Context& ctx);

}  // namespace sg
