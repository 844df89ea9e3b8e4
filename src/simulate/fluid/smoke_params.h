// SPDX-License-Identifier: Apache-2.0
// What can be said of a smoke simulation.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/schema/schema.h"
#include "simulate/analytic_grid.h"
#include "simulate/fluid/advection/advect.h"
#include "simulate/fluid/walls/sides.h"
#include "simulate/run/frames.h"

namespace sg {

enum class BoxSide { x0, x1, y0, y1, z0, z1, none };
constexpr auto enum_words(BoxSide) {
  using enum BoxSide;
  return std::array{Word{"x0", x0}, Word{"x1", x1}, Word{"y0", y0}, Word{"y1", y1}, Word{"z0", z0}, Word{"z1", z1}, Word{"none", none}};
}

struct SmokeParams : FrameParams {
  int size = 64;
  std::vector<double> bounds;
  FieldType type = FieldType::f32;
  double cfl = 2;
  fluid::Advection advection = fluid::Advection::maccormack;
  fluid::BackTrace trace = fluid::BackTrace::rk2;
  bool limit = true, reflect = false;
  std::vector<double> source, box, obstacle;
  std::optional<double> rate;
  Vec3 obstacle_velocity{0, 0, 0}, obstacle_spin{0, 0, 0};
  double density = 1, temperature = 1;
  Vec3 jet{0, 0, 0};
  std::optional<Vec3> up;
  double lift = 1, weight = 0.1, swirl = 0, viscosity = 0, cooling = 0, fading = 0;
  std::optional<BoxSide> open;
  std::string sides;
  double tolerance = 1e-5;
};
void describe(Schema& s, SmokeParams& p);

enum class SurfaceRole { obstacle, source };
constexpr auto enum_words(SurfaceRole) { return std::array{Word{"obstacle", SurfaceRole::obstacle}, Word{"source", SurfaceRole::source}}; }

struct SmokeRoundParams : SmokeParams {
  SurfaceRole role = SurfaceRole::obstacle;
};
void describe(Schema& s, SmokeRoundParams& p);

/// Smoke from the values of a field.
struct SmokeFromParams : SmokeParams {
  FieldName field, temperature_field;
};
void describe(Schema& s, SmokeFromParams& p);

namespace fluid {

/// The grid that the parameters ask for: cubes over the bounds, whose upper ends give way to whole numbers of them. Flat (one cell along z)
/// where the bounds have no extent along z. Throws Error(usage) for boxes without extent, and for more cells than memory could hold.
MacGrid smoke_grid(const SmokeParams& p, const Context& context);

/// Balls as x,y,z,radius of each. Throws Error(usage) for a wrong count, radii that are not positive, and balls outside of the box.
struct Ball {
  Vec3 middle;
  double radius;
};
/// What lies at the sides, from `open` and `sides`. `up` chooses the open one where neither does.
Sides sides_of(const SmokeParams& p, const MacGrid& g, const Vec3& up);
/// Boxes as x0,x1,y0,y1,z0,z1 of each. Throws Error(usage) for a wrong count, and boxes outside of the air.
std::vector<Box3> boxes_of(const std::vector<double>& numbers, const MacGrid& g, const char* word);
std::vector<Ball> balls_of(const std::vector<double>& numbers, const MacGrid& g, const char* word);

}  // namespace fluid
}  // namespace sg
