// SPDX-License-Identifier: Apache-2.0
// Which volumes packets draw, and which code draws a tile for the type of samples.
#include "render/volume/engines/packets/packets.h"

#include <cmath>
#include <cstdint>

#include "render/composite/over.h"
#include "render/volume/engines/packets/packet_rays.h"

namespace sg::volume {

namespace {

/// Calls f with a sample of the type that vector code is compiled for.
template <class F>
void with_samples(const Volume& volume, F&& f) {
  switch (volume.voxels.array.type()) {
    case ElementType::u8:
    case ElementType::i8:
    case ElementType::u16:
    case ElementType::i16: return f(SmallInteger());
    default: return f(float());
  }
}

}  // namespace

bool in_packets(const Volume& v) {
  const size_t bytes = v.voxels.array.bytes();
  const bool offsets_fit = bytes >= 4 && bytes < (size_t(1) << 31) && v.voxels.array.count() < (size_t(1) << 29);
  return v.direct && (v.affine || UnevenAxes::fits(v)) && offsets_fit;
}

bool in_packets(const Illumination& light) { return light.lamps.size() <= Illumination::most_lamps && whole_power(light.material); }

void draw_tile(const MarchingPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  with_samples(plan.volume, [&](auto sample) { march_tile<decltype(sample)>(plan, x0, y0, x1, y1, frame); });
}
void draw_tile(const StridingPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  with_samples(plan.volume, [&](auto sample) { stride_tile<decltype(sample)>(plan, x0, y0, x1, y1, frame); });
}
void draw_tile(const UnevenPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  with_samples(plan.volume, [&](auto sample) { uneven_tile<decltype(sample)>(plan, x0, y0, x1, y1, frame); });
}
void draw_tile(const DetailPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  with_samples(plan.volume, [&](auto sample) { detail_tile<decltype(sample)>(plan, x0, y0, x1, y1, frame); });
}

void put(const Volume& volume, const LatticePart* part, const RayPacket& rays, const PacketResult& result, int lanes, Frame& frame) {
  for (int n = 0; n < lanes; ++n) {
    if (!rays.inside[n] || !(rays.length[n] > 0)) continue;
    const size_t p = rays.pixel[n];
    float* out = &frame.rgba[4 * p];
    if (part) {
      out[0] += result.r[n], out[1] += result.g[n], out[2] += result.b[n], out[3] = 1 - result.transmittance[n];
      if (result.surface[n] >= 0 && rays.before[n] >= 0.5f && part->half[p] == HUGE_VALF)
        part->half[p] = float(rays.first_depth[n] + result.surface[n] * rays.per_length[n]);
      continue;
    }
    Gathered sum{result.r[n], result.g[n], result.b[n], result.transmittance[n]};
    sum.behind(out);
    out[0] = sum.r, out[1] = sum.g, out[2] = sum.b, out[3] = 1 - sum.transmittance;
    // A volume that hides what is behind it can be picked.
    if (result.surface[n] >= 0 && !(frame.depth[p] < HUGE_VALF))
      frame.depth[p] = float(rays.first_depth[n] + result.surface[n] * rays.per_length[n]), frame.ids[p] = volume.id;
  }
}

}  // namespace sg::volume
