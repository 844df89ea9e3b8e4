// SPDX-License-Identifier: Apache-2.0
// timelines: a line that is carried along, at several times.
#pragma once
#include "filter/flow/unsteady/unsteady_run.h"

namespace sg {

struct TimelinesParams : UnsteadyParams {
  std::optional<double> every, spacing;
  double angle = 15;
  int64_t most_points = 1'000'000;
};
void describe(Schema& s, TimelinesParams& p);

/// The seeds, joined in their order (a line of them needs from and to), at the start and every `every` after it (default: at the times of
/// the series) up to `time`. Where neighbours are more than `spacing` apart or the line turns by more than `angle` at one of them, new
/// particles are put between them, on the cubic through their neighbours; it breaks where a particle leaves the mesh. Point fields: "time"
/// (active, f64), "speed", the velocity, "position" (0 at the first seed, 1 at the last), the mesh's other fields. Cell fields: "line" (0
/// at the start), "time". Throws Error(usage) for fewer than two seeds.
DatasetPtr timelines(const Series& series, const std::vector<Data>& others, const TimelinesParams& p, Context& context);

}  // namespace sg
