// SPDX-License-Identifier: Apache-2.0
#include "filter/probe/resample.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"
#include "data/lattice.h"
#include "filter/probe/sample.h"

namespace sg {

UniformGrid resample_grid(const Dataset& input, const ResampleParams& p) {
  Box3 box = input.bounds();
  if (!p.bounds.empty()) {
    if (p.bounds.size() != 6)
      fail_usage(fmt::format("bounds has {} numbers", p.bounds.size()), "resample", "give six: xmin,xmax,ymin,ymax,zmin,zmax");
    for (int a = 0; a < 3; ++a) {
      box.lo[a] = p.bounds[size_t(2 * a)], box.hi[a] = p.bounds[size_t(2 * a) + 1];
      if (!(box.lo[a] <= box.hi[a]) || !std::isfinite(box.hi[a] - box.lo[a]))
        fail_usage(fmt::format("bounds of {} run from {} to {}", "xyz"[a], short_number(box.lo[a]), short_number(box.hi[a])), "resample",
                   "give the smaller first");
    }
  }
  if (box.empty() || !std::isfinite(box.diagonal())) fail_usage("the mesh has no finite extent", "resample", "give bounds");
  const Vec3 extent = box.size();
  const double longest = std::max({extent.x, extent.y, extent.z});
  UniformGrid g;
  g.origin = box.lo;
  if (!p.dims.empty() && p.dims.size() != 3)
    fail_usage(fmt::format("dims has {} numbers", p.dims.size()), "resample", "give three: nx,ny,nz");
  double points = 1;
  for (int a = 0; a < 3; ++a) {
    const bool flat = extent[a] <= 1e-9 * longest;
    size_t n = 1;
    if (!p.dims.empty()) n = size_t(p.dims[size_t(a)]);
    else if (!flat) n = std::max<size_t>(2, size_t(std::lround(extent[a] / longest * double(p.size - 1))) + 1);
    if (flat && n > 1)
      fail_usage(fmt::format("{} points along {}, where the box has no extent", n, "xyz"[a]), "resample",
                 "give 1 for that axis, or bounds with an extent");
    if (n == 1 && !flat) g.origin[a] = box.center()[a];
    g.dims[size_t(a)] = n;
    g.spacing[a] = n > 1 ? extent[a] / double(n - 1) : 1.0;
    points *= double(n);
  }
  if (points > 1e12) fail_usage("the grid has more than 10^12 points", "resample", "give smaller dims");
  return g;
}

DatasetPtr resample(const DatasetPtr& input, const ResampleParams& p, Context& context) {
  const UniformGrid grid = resample_grid(*input, p);
  if (p.mode == ResampleMode::conservative) return resample_conservative(input, grid, p.tolerance, context);
  const Mesh mesh = grid;
  const Lattice lattice(mesh);
  FieldSampler sampler(*input, lattice.view().points());
  sample_grid(input, lattice.view(), sampler, context);
  DatasetParts parts;
  parts.mesh = grid;
  parts.fields = sampler.take();
  parts.time = input->time();
  parts.notes = input->notes();
  return make_dataset(std::move(parts));
}

}  // namespace sg
