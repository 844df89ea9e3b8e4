// SPDX-License-Identifier: Apache-2.0
// stream_surface: what all streamlines through a curve make together.
#pragma once
#include "filter/flow/fronts/seed_curve.h"
#include "filter/flow/trace.h"

namespace sg {

/// What the places of a front have in common: the length that they have gone, or the time.
enum class FrontClock : uint8_t { length, time };
constexpr auto enum_words(FrontClock) {
  using enum FrontClock;
  return std::array{Word{"length", length}, Word{"time", time}};
}

struct StreamSurfaceParams {
  FieldName field;
  SeedCurveParams curve;
  TraceDirection direction = TraceDirection::forward;
  FrontClock front = FrontClock::length;
  std::optional<double> spacing, max_length, max_time;
  double max_angle = 25;
  double tear = 4;
  double min_speed = 1e-4;
  double tolerance = 1e-4;
  int64_t max_points = 2000000;
};
void describe(Schema& s, StreamSurfaceParams& p);

/// A SurfaceMesh of triangles between fronts: rows of places that left the seed curve together and have gone equally far (front=length) or
/// long (front=time). Where neighbours are more than `spacing` apart, or the front turns by more than max_angle between them, a trajectory
/// from between their seeds is put in, integrated from the curve; where three lie within half a spacing the middle one goes. A gap that
/// stays wider than `tear` spacings after twelve halvings (or behind whose ends the flow separates at an obstacle) is left open from there
/// on. Each edge has at most two triangles, which run alike; a closed curve gives a closed band. Point fields: "speed" (active), "time" and
/// "length" since the curve, "seed parameter" (0..1 along the curve), "texture coordinates" (seed parameter, front), the velocity, and the
/// mesh's other fields. direction=both: one surface through the curve. A second input has lines, the longest of which is the curve. Throws
/// Error(usage) when no part of the curve lies in the flow and above max_points.
Data stream_surface(const std::vector<Data>& inputs, const StreamSurfaceParams& p, Context& context);

}  // namespace sg
