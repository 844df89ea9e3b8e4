// SPDX-License-Identifier: Apache-2.0
// The integral within a tolerance along packets of rays through a rectilinear grid. Cells are crossed one by one: strides would have to
// know how long they are.
#include "render/volume/lattice/packet_rays.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/volume/lattice/packets_uneven.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/volume/lattice/packet_cast_inl.h"
#include "render/volume/lattice/packet_walk_inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

template <class D, class T, bool shaded>
class UnevenPacket : CellWalk<D, T, shaded, UnevenLanes<D>> {
  using Walk = CellWalk<D, T, shaded, UnevenLanes<D>>;
  using typename Walk::F, typename Walk::I, typename Walk::M;

 public:
  HWY_INLINE UnevenPacket(const PacketPlan& plan, const RayPacket& rays) : Walk(plan, rays) {}

  HWY_INLINE void run(PacketResult& result) {
    const D d;
    const F stop = hn::Set(d, this->plan_.budget.stop_below);
    F t = hn::Zero(d);
    I cell[3];
    for (int a = 0; a < 3; ++a) cell[a] = this->cell_at(a, t);
    while (true) {
      const M going = hn::And(hn::Lt(t, this->end_), hn::Ge(this->cells_.sum.pass, stop));
      if (hn::AllFalse(d, going)) break;
      const auto here = this->passage(cell);
      const M leaping = hn::And(going, here.empty()), crossing = hn::AndNot(leaping, going);
      if (!hn::AllFalse(d, leaping)) this->leap(here, leaping, cell, t);
      if (!hn::AllFalse(d, crossing)) this->cross(crossing, cell, t);
    }
    this->store(result);
  }
};

void cast_uneven_in_packets(const PacketPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  cast_with<UnevenPacket, hn::CappedTag<float, most_lanes>>(plan, x0, y0, x1, y1, frame);
}

#if HWY_ONCE
void cast_uneven_singly(const PacketPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  cast_with<UnevenPacket, hn::CappedTag<float, 1>>(plan, x0, y0, x1, y1, frame);
}
#endif

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {

HWY_EXPORT(cast_uneven_in_packets);

void cast_uneven_tile(const PacketPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  if (plan.knobs.simd) return HWY_DYNAMIC_DISPATCH(cast_uneven_in_packets)(plan, x0, y0, x1, y1, frame);
  return HWY_STATIC_DISPATCH(cast_uneven_singly)(plan, x0, y0, x1, y1, frame);
}

}  // namespace sg::volume
#endif
