// SPDX-License-Identifier: Apache-2.0
// Smoothing of surfaces that does not shrink them.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct SmoothParams {
  int iterations = 20;
  double lambda = 0.6307;
  double pass_band = 0.1;
  double feature_angle = 180;
  bool border = true;
  bool keep_volume = true;
};
inline void describe(Schema& s, SmoothParams& p) {
  s("iterations", p.iterations, "Number of pairs of a shrinking and an inflating step.").range(0, 100000);
  s("lambda", p.lambda, "Fraction of the way to the mean of the neighbours in a shrinking step.").range(0, 1);
  s("pass_band", p.pass_band,
    "Frequency limit, 0 to 2: lower frequencies are kept, higher ones removed, so smaller is smoother; mu = 1 / (pass_band - 1 / lambda).")
      .range(0, 2);
  s("feature_angle", p.feature_angle, "Edges with a larger angle are smoothed only along themselves; 180: none.").range(0, 180).unit("deg");
  s("border", p.border, "Smooth open edges along themselves; otherwise their points stay fixed.");
  s("keep_volume", p.keep_volume, "Scale each closed piece about its centroid to its original volume.");
}

/// Taubin 1995: x += lambda L x, then x += mu L x with mu < -lambda, L the mean of the neighbours less the point: a low-pass filter
/// that keeps the volume to first order; as its low frequencies grow a little with every pair, closed pieces are scaled back. Points on
/// open, sharp and many-sided edges follow their neighbours on such edges, ends and crossings of those stay. Points at equal places move
/// together. The field with role normals is dropped, since it is no longer valid. Other mesh kinds: their surface. Throws Error(usage) when
/// mu would not be below -lambda. Parallel, O(iterations * edges).
DatasetPtr smooth(const DatasetPtr& in, const SmoothParams& p, Context& ctx);

}  // namespace sg
