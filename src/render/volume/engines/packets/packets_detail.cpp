// SPDX-License-Identifier: Apache-2.0
// The integral within a tolerance where opacity hangs on the gradient, too: packets of rays through a uniform grid, cell by cell.
#include "render/volume/engines/packets/packet_rays.h"

#include "base/vector_targets.h"

// The build compiles this file once for each type of samples (cmake/packets.cmake).
#ifndef SG_SAMPLES
#define SG_SAMPLES float
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/volume/engines/packets/packets_detail.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/volume/engines/packets/packet_cast-inl.h"
#include "render/volume/engines/packets/packet_detail-inl.h"
#include "render/volume/engines/packets/packet_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

template <class D, class T, bool shaded>
using DetailPacket = CellByCell<D, DetailCells<D, T, shaded, EvenAxes<D>>>;

namespace {

void cast_detail_in_packets(const DetailPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  cast_as<DetailPacket, hn::CappedTag<float, most_lanes>, SG_SAMPLES>(plan, x0, y0, x1, y1, frame);
}

#if HWY_ONCE
void cast_detail_singly(const DetailPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  cast_as<DetailPacket, hn::CappedTag<float, 1>, SG_SAMPLES>(plan, x0, y0, x1, y1, frame);
}
#endif

}  // namespace

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {

HWY_EXPORT(cast_detail_in_packets);

template <class T>
void detail_tile(const DetailPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  if (plan.simd) return HWY_DYNAMIC_DISPATCH(cast_detail_in_packets)(plan, x0, y0, x1, y1, frame);
  return HWY_STATIC_DISPATCH(cast_detail_singly)(plan, x0, y0, x1, y1, frame);
}
template void detail_tile<SG_SAMPLES>(const DetailPlan&, int, int, int, int, Frame&);

}  // namespace sg::volume
#endif
