// SPDX-License-Identifier: Apache-2.0
// The integral within a tolerance along packets of rays through a rectilinear grid. Cells are crossed one by one: strides would have to
// know how long they are.
#include "render/volume/engines/packets/packet_rays.h"

#include "base/vector_targets.h"

// The build compiles this file once for each type of samples (cmake/packets.cmake).
#ifndef SG_SAMPLES
#define SG_SAMPLES float
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/volume/engines/packets/packets_uneven.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/volume/engines/packets/packet_cast-inl.h"
#include "render/volume/engines/packets/packet_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

template <class D, class T, bool shaded>
using UnevenPacket = CellByCell<D, PacketCells<D, T, shaded, UnevenLanes<D>>>;

namespace {

void cast_uneven_in_packets(const UnevenPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  cast_as<UnevenPacket, hn::CappedTag<float, most_lanes>, SG_SAMPLES>(plan, x0, y0, x1, y1, frame);
}

#if HWY_ONCE
void cast_uneven_singly(const UnevenPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  cast_as<UnevenPacket, hn::CappedTag<float, 1>, SG_SAMPLES>(plan, x0, y0, x1, y1, frame);
}
#endif

}  // namespace

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {

HWY_EXPORT(cast_uneven_in_packets);

template <class T>
void uneven_tile(const UnevenPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  if (plan.simd) return HWY_DYNAMIC_DISPATCH(cast_uneven_in_packets)(plan, x0, y0, x1, y1, frame);
  return HWY_STATIC_DISPATCH(cast_uneven_singly)(plan, x0, y0, x1, y1, frame);
}
template void uneven_tile<SG_SAMPLES>(const UnevenPlan&, int, int, int, int, Frame&);

}  // namespace sg::volume
#endif
