// SPDX-License-Identifier: Apache-2.0
// pathlines: where particles of a flow that changes with time go.
#pragma once
#include "filter/flow/unsteady/unsteady_run.h"

namespace sg {

struct PathlinesParams : UnsteadyParams {};
void describe(Schema& s, PathlinesParams& p);

/// A SurfaceMesh of poly-lines, one for each seed that lies in the flow at the start, from there to `time` (before the start: backwards) or
/// to where it leaves the mesh; a point at the end of each step of the integrator. Point fields: "time" (active, f64), "speed", the
/// velocity, "length" since the seed, the mesh's other fields at that place and time. Cell fields: "seed", "stop" (StopReason: time when it
/// came to the end). Errors as in UnsteadyRun.
DatasetPtr pathlines(const Series& series, const std::vector<Data>& others, const PathlinesParams& p, Context& context);

}  // namespace sg
