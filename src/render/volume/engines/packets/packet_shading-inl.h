// SPDX-License-Identifier: Apache-2.0
// Lit samples of a packet: queued, lit a full vector at a time, added to their rays in the order of the samples.
#if defined(SG_PACKET_SHADING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_SHADING_INL_H
#undef SG_PACKET_SHADING_INL_H
#else
#define SG_PACKET_SHADING_INL_H
#endif

#include "base/compress-inl.h"
#include "render/volume/engines/packets/packet_light-inl.h"
#include "render/volume/engines/packets/packet_slopes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

template <class D, class T>
class ShadeQueue {
  using F = Float<D>;
  using I = Int<D>;
  static constexpr size_t lanes_ = lanes_of<D>;
  enum { at_sample, at_r, at_g, at_b, at_flash, at_lane, parts };

 public:
  HWY_INLINE void start(const MarchingPlan& plan, const RayPacket& rays) {
    count_ = 0, lighting_ = Lighting<D>(plan.volume, plan.light, rays);
  }

  /// The number of the sample; negative: the last, shorter step. Colours and `flash` (the share of what is mirrored) are weighted already.
  HWY_INLINE void push(const MarchingPlan& plan, const RayPacket& rays, PacketResult& result, Mask<D> which, F sample, F r, F g, F b,
                       F flash) {
    const D d;
    const F part[parts] = {sample, r, g, b, flash, convert(d, hn::Iota(IntTag<D>(), 0))};
    size_t n = 0;
    for (int i = 0; i < parts; ++i) n = sg::HWY_NAMESPACE::compress_store(d, part[i], which, queue_[i] + count_);
    count_ += n;
    if (count_ < lanes_) return;
    light(plan, rays, result, lanes_);
    count_ -= lanes_;
    for (auto& q : queue_) hn::Store(hn::Load(d, q + lanes_), d, q);
  }
  HWY_INLINE void finish(const MarchingPlan& plan, const RayPacket& rays, PacketResult& result) {
    if (count_ == 0) return;
    // What stands behind the last entry is old: any place will do.
    for (auto& q : queue_)
      for (size_t n = count_; n < lanes_; ++n) q[n] = q[0];
    light(plan, rays, result, count_);
  }

 private:
  HWY_NOINLINE void light(const MarchingPlan& plan, const RayPacket& rays, PacketResult& result, size_t count) {
    const D d;
    const Source<D, T> source(plan.volume.voxels);
    const I order = to_int(d, hn::Load(d, queue_[at_lane]));
    const auto lane = hn::IndicesFromVec(d, order);
    const F sample = hn::Load(d, queue_[at_sample]);
    const auto in_last = sample < 0;
    F at[3];
    for (int a = 0; a < 3; ++a) {
      at[a] = mul_add(sample, of_lanes(rays.by[a], lane), of_lanes(rays.first[a], lane));
      at[a] = select(in_last, of_lanes(rays.last[a], lane), at[a]);
    }
    const Slope<D> slope = SlopeFinder<D, T>(source, at[0], at[1], at[2]).find();
    const F cells[3] = {slope.x, slope.y, slope.z};
    F g[3];
    lighting_.to_world(cells, g);
    const Lighting<D> lighting = lighting_.permuted(order);
    const LitLanes<D> lit = lighting.on(lighting.surface(g, slope.per_cell));
    const F flash = hn::Load(d, queue_[at_flash]) * lit.specular;
    for (const int i : {at_r, at_g, at_b}) hn::Store(mul_add(hn::Load(d, queue_[i]), lit.diffuse, flash), d, queue_[i]);
    for (size_t n = 0; n < count; ++n) {
      const auto to = size_t(queue_[at_lane][n]);
      result.r[to] += queue_[at_r][n], result.g[to] += queue_[at_g][n], result.b[to] += queue_[at_b][n];
    }
  }
  template <class Indices>
  static HWY_INLINE F of_lanes(const float* values, const Indices& lane) {
    return hn::TableLookupLanes(hn::Load(D(), values), lane);
  }

  Lighting<D> lighting_;
  alignas(64) float queue_[parts][3 * most_lanes];
  size_t count_;
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
