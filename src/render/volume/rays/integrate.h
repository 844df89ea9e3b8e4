// SPDX-License-Identifier: Apache-2.0
// The integral of emission and absorption along a ray, with a bound on its error instead of a step.
//
// On a stretch the field is a cubic, and between two knots of the medium tau and colour are straight lines over it. A stretch without a
// knot is integrated as a whole (its optical depth exactly: the mean of the Bernstein coefficients). One with knots is cut into pieces
// on which the cubic is straight enough, and these at the knots; there tau and colour are linear in t, and the optical depth is exact.
#pragma once
#include <vector>

#include "render/volume/medium/cubic.h"
#include "render/volume/medium/detail.h"
#include "render/volume/medium/medium.h"
#include "render/volume/medium/preintegrated.h"
#include "render/volume/medium/ray_state.h"
#include "render/volume/medium/stretch.h"
#include "render/volume/rays/light_model.h"

namespace sg::volume {

/// Error bounds of an integral.
struct Budget {
  double tolerance = 1.0 / 512;  ///< of full scale, for a whole ray
  double length = 1;             ///< world length of the longest ray through the volume
  float stop_below = 0;          ///< a ray ends when less than this share of the light passes
};

/// What a volume is made of and how it is lit.
struct Look {
  const Medium& medium;
  Budget budget;
  uint32_t id = 0;
  const LitRay* lit = nullptr;  ///< null = not shaded
  float per_scale = 1;          ///< 1 / change of the value over `edge` from which on there is a surface
  float edge = 1;
  const Detail* detail = nullptr;  ///< null = the medium determines everything
};

/// Light at t of a stretch; look.lit must not be null.
Lit light_on(const Look& look, RayField& walker, const Stretch& stretch, double t);

/// Composites one stretch behind what the ray has accumulated. `walker` is asked for gradients where the look is lit. With a detail, tau is
/// integrated by Simpson's rule on parts that are halved until it agrees with the trapezoid rule and no line of the curves may lie between
/// its samples, 10 times at most: an estimate, not a bound.
void composite(const Look& look, const Stretch& stretch, RayField& walker, RayState& state);

/// A piece of the ray on which the value goes straight from `a` to `b` (pre-integrated classification is this over a step).
void composite_straight(const Look& look, double from, double to, float a, float b, const Lit* lit, RayState& state);
/// One sample that represents a length of the ray.
void composite_sample(const Look& look, double from, double length, float value, const Lit* lit, RayState& state);
/// Optical properties that represent a length of the ray.
void composite_optics(const Look& look, double from, double length, const Optics& optics, const Lit* lit, RayState& state);
/// Table lookup for a piece.
void composite_segment(const Look& look, double from, double length, const Preintegrated::Segment& segment, const Lit* lit,
                       RayState& state);
/// Several media at once on stretches with common ends (joint.cpp): cut where a value turns or meets a knot of its medium, and these parts
/// until Gauss's rule of three places on a part and on its halves differ by less than their share of the smallest tolerance, 14 times at
/// most: an estimate, not a bound.
struct Joint {
  const Look* look;
  RayField* walker;
  Stretch stretch;
};
void composite_joint(const std::vector<Joint>& joint, RayState& state);

}  // namespace sg::volume
