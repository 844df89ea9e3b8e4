// SPDX-License-Identifier: Apache-2.0
#include "render/volume/effects/scatter_colors.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "color/widgets/transfer_widget.h"
#include "image/image.h"
#include "render/shade/phase_function.h"
#include "render/shade/scatter_albedo.h"

namespace sg::volume {

namespace {

void scatter(Vec3f& srgb, float g) {
  const Vec3f albedo = single_scatter_albedo({srgb_decode(srgb.x), srgb_decode(srgb.y), srgb_decode(srgb.z)}, g);
  srgb = {srgb_encode(albedo.x), srgb_encode(albedo.y), srgb_encode(albedo.z)};
}

// More stops between those of a map: what lies between them is mixed of shares, not of colours.
void refine(Colormap& map) {
  const size_t n = map.colors.size();
  if (map.categorical() || n < 2) return;
  const auto place = [&](size_t i) { return map.positions.size() == n ? map.positions[i] : double(i) / double(n - 1); };
  std::vector<Vec3f> colors;
  std::vector<double> positions;
  for (size_t i = 0; i + 1 < n; ++i) {
    const double from = place(i), width = place(i + 1) - from;
    const int parts = std::max(1, int(std::ceil(256 * width)));
    for (int k = 0; k < parts; ++k) {
      const float t = float(k) / float(parts);
      colors.push_back(map.colors[i] * (1 - t) + map.colors[i + 1] * t), positions.push_back(from + width * k / parts);
    }
  }
  colors.push_back(map.colors.back()), positions.push_back(place(n - 1));
  map.colors = std::move(colors), map.positions = std::move(positions);
}

void scatter(ColorScale& scale, float g) {
  refine(scale.map);
  for (Vec3f& c : scale.map.colors) scatter(c, g);
  if (scale.below) scatter(*scale.below, g);
  if (scale.above) scatter(*scale.above, g);
  scatter(scale.nan, g);
}

}  // namespace

VolumeItem with_scatter_colors(VolumeItem item) {
  const float g = PhaseFunction(item.scattering).mean_cosine();
  scatter(item.color, g), scatter(item.detail.second_color, g);
  for (TransferWidget& w : item.detail.widgets)
    if (w.color.x >= 0) scatter(w.color, g);
  return item;
}

}  // namespace sg::volume
