// SPDX-License-Identifier: Apache-2.0
// Area, volume, centroid and inertia of what a surface encloses.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct MassPropertiesParams {
  double density = 1;
  bool must_be_closed = false;
};
inline void describe(Schema& s, MassPropertiesParams& p) {
  s("density", p.density, "Mass per volume, by which the inertia is multiplied.").positive();
  s("must_be_closed", p.must_be_closed, "Fail if the surface does not enclose a volume, instead of a warning and NaN.");
}

/// One row per mesh: part, closed (1: the polygons enclose a volume), area, area_x area_y area_z (centroid of the surface), volume,
/// x y z (centroid of the volume), mass, and the inertia about the centroid xx yy zz xy yz xz (integral of density times
/// |r|^2 I - r r^T). Exact for polyhedra: sums over the tetrahedra from a fixed point to the triangles (divergence theorem), in
/// an order of their own. Points at equal places count as one, polygons are oriented consistently, and an inside-out volume is counted
/// positive; shells inside others count as cavities when they face the other way. Solids: the skin of their cells of dimension 3. Open or
/// one-sided surfaces: volume and what follows are NaN, with a warning that says how many edges are open.
TablePtr mass_properties(const Data& in, const MassPropertiesParams& p, Context& ctx);

}  // namespace sg
