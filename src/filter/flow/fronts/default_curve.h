// SPDX-License-Identifier: Apache-2.0
// Where a stream surface begins when nobody says.
#pragma once
#include "filter/flow/flow_parts.h"
#include "filter/flow/fronts/seed_curve.h"

namespace sg {

/// A straight line across the flow: through the middle of the mesh, or where that stands still the place nearest to it of some where much
/// flows; along the axis that is most across the flow there, up to an eighth of the mesh's diagonal to both sides, as far as there is flow
/// (above 2 % of the largest speed). Says on the log which it is. Throws Error(usage) when nothing flows.
SeedCurveParams across_the_flow(const FlowParts& parts, Context& context);

}  // namespace sg
