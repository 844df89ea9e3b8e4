// SPDX-License-Identifier: Apache-2.0
// Rays with fixed steps leap over bricks that draw nothing: their lanes, the bricks around them, and the leap.
#if defined(SG_PACKET_LEAPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_LEAPS_INL_H
#undef SG_PACKET_LEAPS_INL_H
#else
#define SG_PACKET_LEAPS_INL_H
#endif

#include "render/volume/engines/packets/packets-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// Bricks that draw nothing, ready for gathers.
template <class D>
struct Space {
  const uint8_t* distance;
  Int<D> row, layer, last[3], up[3];  ///< up: of SpaceAhead
  Float<D> margin, edges[3];

  HWY_INLINE explicit Space(const MarchingPlan& plan) : distance(plan.ahead ? plan.ahead->bricks.data() : plan.volume.distance.data()) {
    const D d;
    const IntTag<D> di;
    const Volume& v = plan.volume;
    for (size_t a = 0; a < 3; ++a) up[a] = set(di, plan.ahead ? plan.ahead->up[a] : 0);
    const auto& dims = v.fine().dims;
    row = set(di, int(dims[0])), layer = set(di, int(dims[0] * dims[1]));
    for (size_t a = 0; a < 3; ++a) last[a] = set(di, int(dims[a]) - 1), edges[a] = set(d, float(dims[a]));
    margin = set(d, float(std::max({v.margin.x, v.margin.y, v.margin.z})));
  }
};

/// Where the lanes of a packet are: sample s of `end`, at first + s * by.
template <class D>
struct Lanes {
  Float<D> first[3], by[3], per_by[3], s, end;

  HWY_INLINE Lanes(const RayPacket& r, const float (*per)[most_lanes], Float<D> sample) : s(sample) {
    const D d;
    for (int a = 0; a < 3; ++a) first[a] = hn::Load(d, r.first[a]), by[a] = hn::Load(d, r.by[a]), per_by[a] = hn::Load(d, per[a]);
    end = hn::Load(d, r.steps);
  }
  HWY_INLINE Float<D> u(int a) const { return u(a, s); }
  HWY_INLINE Float<D> u(int a, Float<D> sample) const { return mul_add(sample, by[a], first[a]); }
};

/// The bricks that the lanes are in.
template <class D>
struct Nearby {
  Int<D> brick[3];
  Int<D> free;  ///< so many bricks around draw nothing

  template <class T>
  HWY_INLINE void find(const Source<D, T>& source, const Space<D>& space, const Lanes<D>& lanes) {
    const D d;
    for (int a = 0; a < 3; ++a) {
      const auto cell = to_int(d, max(0, min(lanes.u(a), source.top[a])));
      brick[a] = min(shift_right<FineBricks::shift>(cell), space.last[a]);
    }
    auto id = brick[0] + (brick[1] * space.row + brick[2] * space.layer);
    for (int a = 0; a < 3; ++a) id = id + only(lanes.by[a] > 0, space.up[a]);
    free = gather_words(d, space.distance, id, source.loads) & 255;
  }
};

/// Takes the lanes that are `looking`, if they are in bricks that draw nothing, to their first sample beyond those that are known to be so.
/// Whether that is in such a brick, too, is asked with the next look: to go on at once would let the other lanes wait.
template <class D>
HWY_INLINE void leap(const Space<D>& space, const Nearby<D>& here, Lanes<D>& lanes, Mask<D> looking) {
  const D d;
  const auto zero = set(d, 0), one = set(d, 1.0f);
  looking = looking & rebind(d, here.free > 0);
  if (none(looking)) return;
  // All bricks nearer than that are empty: leave their cube, but for a margin wider than rounding errors.
  const auto reach = convert(d, here.free);
  auto out = lanes.end;
  for (int a = 0; a < 3; ++a) {
    const auto forth = lanes.by[a] > zero;
    const auto side = convert(d, here.brick[a]) + select(forth, reach, one - reach);
    const auto at = mul_add(side, float(FineBricks::edge), select(forth, -space.margin, space.margin));
    const auto there = (at - lanes.first[a]) * lanes.per_by[a];
    // Beyond the outermost bricks there is nothing else.
    const auto open = (side <= zero) | (side >= space.edges[a]) | (lanes.by[a] == zero);
    out = select(open, out, min(out, there));
  }
  // Always by twos, as samples are taken.
  const auto next = floor(ceil(out) * 0.5f) * 2.0f;
  lanes.s = select(looking, max(next, lanes.s), lanes.s);
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
