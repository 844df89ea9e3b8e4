// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/quality.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "data/lattice.h"

namespace sg::serve {

namespace {

// The length of the shortest edge of a voxel; 0 where cells have no common size.
double voxel_edge(const Dataset& data) {
  const auto* grid = data.as<UniformGrid>();
  if (!grid) return 0;
  double shortest = HUGE_VAL;
  for (int a = 0; a < 3; ++a)
    if (grid->dims[size_t(a)] > 1) shortest = std::min(shortest, std::abs(grid->spacing[a]));
  return std::isfinite(shortest) ? shortest : 0;
}

}  // namespace

Scene rough(Scene scene, Quality quality) {
  if (quality == Quality::exact) return scene;
  const bool moving = quality == Quality::moving;
  for (Item& item : scene.items) {
    auto* volume = std::get_if<VolumeItem>(&item);
    if (!volume || volume->method != VolumeMethod::ray) continue;
    if (const double edge = voxel_edge(*volume->data); edge > 0) volume->sampling.step = moving ? edge : edge / 2;
    else volume->sampling.tolerance = std::max(volume->sampling.tolerance, moving ? 0.125 : 0.02);
    volume->sampling.jitter = false, volume->sampling.antialias = VolumeAntialias::none;
    if (moving) volume->sampling.kernel = Kernel::linear, volume->sampling.classify = VolumeClassify::post;
  }
  return scene;
}

double coarseness(double pixels, double seconds_per_sample, double seconds) {
  constexpr std::array steps{1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0};
  if (!(seconds_per_sample > 0)) return 4;
  for (const double c : steps)
    if (pixels / (c * c) * seconds_per_sample <= seconds) return c;
  return steps.back();
}

void paste_enlarged(const Image& part, int x, int y, int width, int height, Image& whole) {
  const size_t channels = size_t(part.channels);
  // Which pixels of `part` a pixel lies between, and the share of the second one.
  struct Between {
    int first, second;
    int share;  // of 256
  };
  const auto between = [](int count, int of) {
    std::vector<Between> all;
    for (int i = 0; i < count; ++i) {
      const double at = std::clamp((i + 0.5) * of / count - 0.5, 0.0, double(of - 1));
      const int first = int(at);
      all.push_back({first, std::min(first + 1, of - 1), int((at - first) * 256)});
    }
    return all;
  };
  const std::vector<Between> columns = between(width, part.width), rows = between(height, part.height);
  parallel_for(size_t(height), 16, [&](size_t begin, size_t end) {
    for (size_t j = begin; j < end; ++j) {
      const Between& r = rows[j];
      const uint8_t* above = part.at(0, r.first);
      const uint8_t* below = part.at(0, r.second);
      uint8_t* to = whole.at(x, y + int(j));
      for (size_t i = 0; i < size_t(width); ++i) {
        const Between& c = columns[i];
        const size_t left = channels * size_t(c.first), right = channels * size_t(c.second);
        for (size_t k = 0; k < channels; ++k) {
          const int up = above[left + k] * (256 - c.share) + above[right + k] * c.share;
          const int down = below[left + k] * (256 - c.share) + below[right + k] * c.share;
          *to++ = uint8_t((up * (256 - r.share) + down * r.share + (1 << 15)) >> 16);
        }
      }
    }
  });
}

}  // namespace sg::serve
