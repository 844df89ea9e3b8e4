// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/quality.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "data/lattice.h"

namespace sg::serve {

namespace {

// The length of the shortest edge of a voxel; 0 where cells have no common size.
double voxel_edge(const Dataset& data) {
  const auto* grid = data.as<UniformGrid>();
  return grid ? shortest_spacing(*grid) : 0;
}

}  // namespace

Scene rough(Scene scene, Quality quality, double coarse) {
  if (quality == Quality::exact) return scene;
  const bool moving = quality == Quality::moving;
  for (Item& item : scene.items) {
    auto* volume = std::get_if<VolumeItem>(&item);
    if (!volume || volume->method != VolumeMethod::ray) continue;
    if (const double edge = voxel_edge(*volume->data); edge > 0)
      volume->sampling.step = moving ? edge * std::max(1.0, coarse / most_pixels_a_sample) : edge / 2;
    else volume->sampling.tolerance = std::max(volume->sampling.within(), moving ? 0.125 : 0.02);
    volume->sampling.jitter = false, volume->sampling.antialias = VolumeAntialias::none;
    if (moving) volume->sampling.kernel = Kernel::linear, volume->sampling.classify = VolumeClassify::post;
  }
  return scene;
}

double next_coarseness(double coarse, double seconds, double budget) {
  constexpr std::array steps{1.0, 1.5, 2.0, 3.0, 4.0, 6.0, most_pixels_a_sample, 12.0, 16.0};
  const auto now = std::lower_bound(steps.begin(), steps.end(), coarse);
  if (seconds > budget) return now + 1 < steps.end() ? *(now + 1) : steps.back();
  if (now == steps.begin()) return coarse;
  // Were all of the time spent on samples, a finer picture would take so much longer; a good part of it is not.
  const double finer = *(now - 1), at_most = seconds * (coarse / finer) * (coarse / finer);
  return at_most <= 1.3 * budget ? finer : coarse;
}

}  // namespace sg::serve
