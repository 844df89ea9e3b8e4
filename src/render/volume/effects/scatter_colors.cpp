// SPDX-License-Identifier: Apache-2.0
#include "render/volume/effects/scatter_colors.h"

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

void scatter(ColorScale& scale, float g) {
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
