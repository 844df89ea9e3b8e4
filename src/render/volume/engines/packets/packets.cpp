// SPDX-License-Identifier: Apache-2.0
// Which volumes packets draw, and which of them draws a tile: by the type of samples and by what the plan asks for.
#include "render/volume/engines/packets/packets.h"

#include <cmath>
#include <cstdint>

#include "render/composite/over.h"
#include "render/volume/engines/packets/packet_rays.h"

namespace sg::volume {

namespace {

/// Calls f with a sample of the type that vector code is compiled for.
template <class F>
void with_samples(const PacketPlan& plan, F&& f) {
  switch (plan.volume.voxels.array.type()) {
    case ElementType::u8:
    case ElementType::i8:
    case ElementType::u16:
    case ElementType::i16: return f(SmallInteger());
    default: return f(float());
  }
}

}  // namespace

bool in_packets(const PacketPlan& plan) {
  const Volume& v = plan.volume;
  const size_t bytes = v.voxels.array.bytes();
  const bool offsets_fit = bytes >= 4 && bytes < (size_t(1) << 31) && v.voxels.array.count() < (size_t(1) << 29);
  return v.affine && v.direct && offsets_fit && plan.lamps.size() <= PacketPlan::most_lamps && whole_power(plan.material);
}

bool in_tolerant_packets(const PacketPlan& plan) {
  const Volume& v = plan.volume;
  const size_t bytes = v.voxels.array.bytes();
  const bool offsets_fit = bytes >= 4 && bytes < (size_t(1) << 31) && v.voxels.array.count() < (size_t(1) << 29);
  return v.direct && (v.affine || UnevenAxes::fits(v)) && plan.medium->linear() && offsets_fit &&
         plan.lamps.size() <= PacketPlan::most_lamps && whole_power(plan.material);
}

void march_tile(const PacketPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  if (plan.volume.mode == VolumeItem::Mode::maximum) return maximum_tile(plan, x0, y0, x1, y1, frame);
  with_samples(plan, [&](auto sample) { march_even_tile<decltype(sample)>(plan, x0, y0, x1, y1, frame); });
}

void cast_tile(const PacketPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  with_samples(plan, [&](auto sample) {
    using T = decltype(sample);
    if (plan.uneven) cast_uneven_tile<T>(plan, x0, y0, x1, y1, frame);
    else if (plan.detail) cast_detail_tile<T>(plan, x0, y0, x1, y1, frame);
    else cast_even_tile<T>(plan, x0, y0, x1, y1, frame);
  });
}

void put(const PacketPlan& plan, const RayPacket& rays, const PacketResult& result, int lanes, Frame& frame) {
  for (int n = 0; n < lanes; ++n) {
    if (!rays.inside[n] || !(rays.length[n] > 0)) continue;
    const size_t p = rays.pixel[n];
    float* out = &frame.rgba[4 * p];
    if (plan.half) {
      out[0] += result.r[n], out[1] += result.g[n], out[2] += result.b[n], out[3] = 1 - result.transmittance[n];
      if (result.surface[n] >= 0 && rays.before[n] >= 0.5f && plan.half[p] == HUGE_VALF)
        plan.half[p] = float(rays.first_depth[n] + result.surface[n] * rays.per_length[n]);
      continue;
    }
    Gathered sum{result.r[n], result.g[n], result.b[n], result.transmittance[n]};
    sum.behind(out);
    out[0] = sum.r, out[1] = sum.g, out[2] = sum.b, out[3] = 1 - sum.transmittance;
    // A volume that hides what is behind it can be picked.
    if (result.surface[n] >= 0 && !(frame.depth[p] < HUGE_VALF))
      frame.depth[p] = float(rays.first_depth[n] + result.surface[n] * rays.per_length[n]), frame.ids[p] = plan.volume.id;
  }
}

}  // namespace sg::volume
