// SPDX-License-Identifier: Apache-2.0
// Quality measures of cells.
#pragma once
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

enum class CellMeasure { scaled_jacobian, aspect_ratio, edge_ratio, min_angle, max_angle, skew, equiangle_skew, size };
constexpr auto enum_words(CellMeasure) {
  using enum CellMeasure;
  return std::array{Word{"scaled_jacobian", scaled_jacobian},
                    Word{"aspect_ratio", aspect_ratio},
                    Word{"edge_ratio", edge_ratio},
                    Word{"min_angle", min_angle},
                    Word{"max_angle", max_angle},
                    Word{"skew", skew},
                    Word{"equiangle_skew", equiangle_skew},
                    Word{"size", size}};
}

struct QualityParams {
  std::vector<CellMeasure> measures = {CellMeasure::scaled_jacobian};
};
inline void describe(Schema& s, QualityParams& p) { s("measures", p.measures, "Measures to compute, one cell field each."); }

/// Cell fields (f64) by the measures' names, after the Verdict library's definitions (Stimpson, Ernst, Knupp, Pebay, Thompson 2007):
///   scaled_jacobian  smallest determinant of the unit edges at a corner, 1 for the equilateral or right-angled ideal, below 0 inside out
///   aspect_ratio     triangle longest edge by inradius, quad longest edge by mean, tetrahedron longest edge by inradius, hexahedron ratio
///                    of principal axes, wedge and pyramid largest condition number of a corner; 1 for the ideal, else larger
///   edge_ratio       longest by shortest edge; any cell with edges
///   min_angle, max_angle  degrees: of the corners of faces, between the faces (dihedral) of solids
///   skew             largest |cosine| between principal axes: quads and hexahedra; 0 is ideal
///   equiangle_skew   distance of the corner angles of the faces from 60 or 90 degrees, 0 to 1: polygons from their own ideal
///   size             length, area or volume, negative for solids inside out
/// Curved cells are judged by their corners, with a note; where a measure has no meaning for a type: NaN. Works on every mesh kind but
/// point clouds. Wedges may be listed either way round. O(cells), parallel.
DatasetPtr quality(const DatasetPtr& in, const QualityParams& p, Context& ctx);

}  // namespace sg
