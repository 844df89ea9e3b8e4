// SPDX-License-Identifier: Apache-2.0
// Draws a tile by packets of one kind, for one type of samples.
#if defined(SG_PACKET_CAST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_CAST_INL_H
#undef SG_PACKET_CAST_INL_H
#else
#define SG_PACKET_CAST_INL_H
#endif

#include <cstdint>

#include "render/volume/engines/packets/packets-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

template <template <class, class, bool> class Packet, class D, class T, bool shaded, class Plan>
HWY_NOINLINE void cast_all(const Plan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  constexpr int lanes = lanes_of<D>, width = packet_width<D>, height = lanes / width;
  RayPacket rays;
  PacketResult result;
  [[maybe_unused]] uint64_t turns = 0;
  for (int y = y0; y < y1; y += height)
    for (int x = x0; x < x1; x += width) {
      if (!set_up<D>(plan, x, y, x1, y1, frame, rays)) continue;
      Packet<D, T, shaded> packet(plan, rays);
      packet.run(result);
      if constexpr (requires { packet.turns(); }) turns += packet.turns();
      put(plan.volume, part_of(plan), rays, result, lanes, frame);
    }
  if constexpr (requires { plan.turns; })
    if (plan.turns) *plan.turns += turns;
}

template <template <class, class, bool> class Packet, class D, class T, class Plan>
HWY_INLINE void cast_as(const Plan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  if (plan.volume.shaded) cast_all<Packet, D, T, true>(plan, x0, y0, x1, y1, frame);
  else cast_all<Packet, D, T, false>(plan, x0, y0, x1, y1, frame);
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
