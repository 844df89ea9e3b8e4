// SPDX-License-Identifier: Apache-2.0
// Closes the holes of a surface.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct CapParams {
  double max_perimeter = 0;
  double tolerance = 1e-4;
  bool only_cap = false;
};
inline void describe(Schema& s, CapParams& p) {
  s("max_perimeter", p.max_perimeter, "Close only holes whose total edge length is at most this; 0: all.").at_least(0).unit("length");
  s("tolerance", p.tolerance, "Close loops together that lie this close to a common plane, as a share of the size of the surface.")
      .positive();
  s("only_cap", p.only_cap, "Return only the caps, without the surface.");
}

/// Triangles over the loops of open edges. Points at equal places count as one; polygons are first oriented consistently. Loops in one
/// plane are closed together by even-odd nesting: a loop within another is a hole of its cap. A loop that is not planar is closed in its
/// best-fitting plane, with a note. The caps face as the surface around them does, and use all points of the loops: the result is closed
/// where all loops are. Cell field 'cap' (u8: 1 on caps); other cell fields come from the polygon at the loop's first edge. With a point
/// field of role normals, caps have points of their own with the normal of their plane; else they share them. Other mesh kinds: their
/// surface.
DatasetPtr cap(const DatasetPtr& in, const CapParams& p, Context& ctx);

}  // namespace sg
