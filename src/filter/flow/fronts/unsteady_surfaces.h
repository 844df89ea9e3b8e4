// SPDX-License-Identifier: Apache-2.0
// path_surface, streak_surface, time_surface: surfaces of a flow that changes with time.
#pragma once
#include "filter/flow/fronts/seed_curve.h"
#include "filter/flow/unsteady/unsteady_run.h"

namespace sg {

/// Shared by the three.
struct UnsteadySurfaceParams {
  FieldName field;
  std::string times;
  std::optional<double> start, time;
  TimeInterpolation interpolation = TimeInterpolation::linear;
  IntegrationParams integration;
  std::optional<double> spacing;
  double tear = 8;
  int64_t max_points = 2000000;
  bool geographic = false;  ///< see flow/geographic.h
};

struct PathSurfaceParams : UnsteadySurfaceParams {
  SeedCurveParams curve;
};
struct StreakSurfaceParams : UnsteadySurfaceParams {
  SeedCurveParams curve;
};
struct TimeSurfaceParams : UnsteadySurfaceParams {
  std::optional<Vec3> center, normal;
  std::vector<double> size;
};
void describe(Schema& s, PathSurfaceParams& p);
void describe(Schema& s, StreakSurfaceParams& p);
void describe(Schema& s, TimeSurfaceParams& p);

// All three give a SurfaceMesh of triangles with point fields "speed" (active), "time", "seed parameter" (0..1 along the curve), "texture
// coordinates" and the velocity. Edges longer than `spacing` get a particle in their middle (so a surface departs from the true one by the
// square of the spacing), and gaps wider than tear * spacing that cannot be filled stay open. They hold the steps of one interval of the
// series at a time. Without a curve or a surface they begin across the flow at the start (default_curve.h). Errors as in UnsteadyRun and
// seed_curve.

/// The curve released at the start and followed to `time`: the pathlines of all its places. Also "age" (= time - start).
DatasetPtr path_surface(const Series& series, const std::vector<Data>& others, const PathSurfaceParams& p, Context& context);

/// All that the curve has released up to `time`, where it is then. "release time", "age".
DatasetPtr streak_surface(const Series& series, const std::vector<Data>& others, const StreakSurfaceParams& p, Context& context);

/// A surface (the second input, or a rectangle by center, normal and size) carried from the start to `time`.
DatasetPtr time_surface(const Series& series, const std::vector<Data>& others, const TimeSurfaceParams& p, Context& context);

}  // namespace sg
