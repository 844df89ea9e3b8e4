// SPDX-License-Identifier: Apache-2.0
// streaklines and particles: what is released at seeds again and again, and where it is at one time.
#pragma once
#include "filter/flow/unsteady/unsteady_run.h"

namespace sg {

struct StreaklinesParams : UnsteadyParams {
  std::optional<double> every, spacing;
  bool refine = true;
  double angle = 15;
  int64_t most_points = 10'000'000;
};
void describe(Schema& s, StreaklinesParams& p);

/// At each seed a particle is released every `every` (default: at the times of the series, and at the start) up to `time`; those of one
/// seed, the newest first, make its line at `time`. Where neighbours are more than `spacing` apart, or the line turns by more than `angle`
/// between neighbours that are not very close, others are put between them (see StreakFront). A line breaks where a particle has left the
/// mesh; a piece of one particle is a vertex, or with `refine` left out beside others of the seed. Point fields: "age" (active, f64),
/// "speed", the velocity, the mesh's other fields at `time`. Cell field: "seed".
DatasetPtr streaklines(const Series& series, const std::vector<Data>& others, const StreaklinesParams& p, Context& context);

struct ParticlesParams : UnsteadyParams {
  std::optional<double> every, lifetime;
};
void describe(Schema& s, ParticlesParams& p);

/// The same particles as a PointCloud, "seed" a point field; `every` 0: each seed releases one, at the start. Those older than `lifetime`
/// are gone.
DatasetPtr particles(const Series& series, const std::vector<Data>& others, const ParticlesParams& p, Context& context);

}  // namespace sg
