// SPDX-License-Identifier: Apache-2.0
// surface_lic: the directions of a flow as a texture on a surface, in space.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "filter/flow/texture/line_fade.h"

namespace sg {

struct SurfaceLicParams {
  FieldName field;
  std::optional<double> density = {};
  int steps = 40;
  double step = 0;
  LineFade kernel = LineFade::hann;
  bool stretch = true;
  int64_t seed = 1;
};
inline void describe(Schema& s, SurfaceLicParams& p) {
  s("field", p.field, "Vector field on points or cells to follow; default: the active vectors.").takes(fields::vectors);
  s("density", p.density,
    "Samples along the diagonal of the bounding box: triangles are split until their edges are no longer than the diagonal divided by "
    "this; 0 keeps the triangles of the mesh. Default: 400, or fewer if that would make more than 150 000 to 300 000 triangles.")
      .range(0, 100000);
  s("steps", p.steps, "Steps of each line in each direction.").range(1, 10000);
  s("step", p.step, "Length of a step; 0: half the mean edge of the split triangles.").unit("length").at_least(0);
  s("kernel", p.kernel, "Weights along a line: hann fades out, box is uniform.");
  s("stretch", p.stretch, "Spread the means over 0 to 1 by their known variance (for map=gray); false keeps the means of the noise.");
  s("seed", p.seed, "Random seed of the noise.");
}

/// Line integral convolution (Cabral, Leedom 1993) in object space: every point of the surface, whose triangles are first split to be
/// small, gets the weighted mean of noise (uniform in 0..1, one number per point) along the line through it. Lines are straight in pieces
/// and of second order: in each triangle by the midpoint of its linear field's part along the triangle, from edge to edge through any
/// number of triangles; along an edge where both sides run into it; they end at open edges, at edges of three and more triangles, and where
/// there is no direction (zero, NaN, across the surface). A sample takes the noise that its triangle's
/// corners have there, interpolated. Result: a
/// SurfaceMesh of triangles with the point field "lic" (f32, 0..1, 0.5 where no line starts; role scalars) before all others; lines and
/// vertices are left out. Other mesh kinds: their surface. Throws Error(usage) for no vectors, other than 2 or 3 components, no faces, and
/// more than 64 million triangles. Parallel, O(points * steps).
DatasetPtr surface_lic(const DatasetPtr& in, const SurfaceLicParams& p, Context& context);

}  // namespace sg
