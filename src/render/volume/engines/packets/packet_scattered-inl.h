// SPDX-License-Identifier: Apache-2.0
// Light that a volume scatters once along the rays of a packet, by the light maps of the lamps.
#if defined(SG_PACKET_SCATTERED_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_SCATTERED_INL_H
#undef SG_PACKET_SCATTERED_INL_H
#else
#define SG_PACKET_SCATTERED_INL_H
#endif

#include "render/volume/engines/packets/packets-inl.h"
#include "render/volume/engines/packets/scattered_light.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

template <class D>
class ScatteredLanes {
  using F = Float<D>;
  using I = Int<D>;

 public:
  /// `light` may be null.
  HWY_INLINE ScatteredLanes(const ScatteredLight* light, const RayPacket& rays, bool loads) : light_(light), loads_(loads) {
    if (!light) return;
    for (size_t l = 0; l < light->sources.size(); ++l) {
      alignas(64) float weights[most_lanes] = {};
      const ScatteredLight::Source& s = light->sources[l];
      for (size_t n = 0; n < hn::Lanes(D()); ++n) {
        const Vec3f along{rays.direction[0][n], rays.direction[1][n], rays.direction[2][n]};
        if (rays.length[n] > 0) weights[n] = s.strength * light->phase.density(dot(s.towards, along));
      }
      weight_[l] = hn::Load(D(), weights);
    }
  }
  bool any() const { return light_ != nullptr; }

  /// Where rays are in q: LightMap::at of each lamp. Out of line: it is wanted from several sides.
  HWY_NOINLINE F at(const F q[3]) const {
    const D d;
    F sum = set(d, light_->glow);
    for (size_t l = 0; l < light_->sources.size(); ++l) {
      const ScatteredLight::Source& s = light_->sources[l];
      I cell[3];
      F share[3];
      for (int a = 0; a < 3; ++a) {
        const float(&row)[4] = s.from_q[a];
        F at = mul_add(q[2], set(d, row[2]), mul_add(q[1], set(d, row[1]), mul_add(q[0], set(d, row[0]), set(d, row[3]))));
        at = max(0, min(at, float(s.map.n[a] - 1)));
        cell[a] = min(to_int(d, at), int(s.map.n[a]) - 2);
        share[a] = at - convert(d, cell[a]);
      }
      const auto rows = [&](int i, int j) HWY_ATTR {
        const IntTag<D> di;
        const I row = (cell[1] + j) * set(di, int(s.map.n[0])) + (cell[0] + i);
        return along_row(s.map.values, shift_left<1>(row * set(di, int(s.map.n[2])) + cell[2]), share[2]);
      };
      const auto mix = [](F a, F b, F t) HWY_ATTR { return mul_add(t, b - a, a); };
      const F front = mix(rows(0, 0), rows(1, 0), share[0]), back = mix(rows(0, 1), rows(1, 1), share[0]);
      sum = mul_add(weight_[l] * (1.0f / 65535), mix(front, back, share[1]), sum);
    }
    return sum;
  }

 private:
  // Two samples of a row, `byte` from the first one on, mixed.
  HWY_INLINE F along_row(const uint16_t* values, I byte, F share) const {
    const D d;
    const IntTag<D> di;
    const hn::RebindToUnsigned<IntTag<D>> du;
    const I both = gather_words(d, values, byte, loads_);
    const F first = convert(d, both & set(di, 0xFFFF)), second = convert(d, bit_cast(di, shift_right<16>(bit_cast(du, both))));
    return mul_add(share, second - first, first);
  }

  const ScatteredLight* light_;
  bool loads_;
  F weight_[Illumination::most_lamps];
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
