// SPDX-License-Identifier: Apache-2.0
// Vectors of points and the light on them, for files that are compiled once for each target and have included Highway. Inside
// render only. No fused multiply-add and no libm: every target gives the same bits.
#if defined(SG_RASTER_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_RASTER_LIGHT_INL
#undef SG_RASTER_LIGHT_INL
#else
#define SG_RASTER_LIGHT_INL
#endif
#include "render/shade/shade.h"

HWY_BEFORE_NAMESPACE();
namespace sg::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::ScalableTag<float>;
using DI = hn::RebindToSigned<DF>;
using F = hn::Vec<DF>;
using I = hn::Vec<DI>;
using M = hn::Mask<DF>;

struct V3 {
  F x, y, z;
};
HWY_INLINE V3 operator-(V3 a, V3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE V3 operator+(V3 a, V3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE V3 operator*(V3 a, F s) { return {a.x * s, a.y * s, a.z * s}; }
HWY_INLINE F dot3(V3 a, V3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HWY_INLINE V3 cross3(V3 a, V3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
HWY_INLINE V3 set3(const float* a) {
  const DF d;
  return {hn::Set(d, a[0]), hn::Set(d, a[1]), hn::Set(d, a[2])};
}
HWY_INLINE V3 gather3(const float* base, I index) {
  const DF d;
  const I at = index + index + index;
  return {hn::GatherIndex(d, base, at), hn::GatherIndex(d, base + 1, at), hn::GatherIndex(d, base + 2, at)};
}
HWY_INLINE V3 select3(M m, V3 a, V3 b) { return {hn::IfThenElse(m, a.x, b.x), hn::IfThenElse(m, a.y, b.y), hn::IfThenElse(m, a.z, b.z)}; }

/// x^p for x in [0, 1]: 2^(p log2 x) by series whose errors stay below 1e-6 for the powers in use.
HWY_INLINE F power(F x, float p) {
  const DF d;
  const DI di;
  const F one = hn::Set(d, 1.0f);
  const F safe = hn::Max(x, hn::Set(d, 1e-30f));
  // log2: mantissa in [sqrt(1/2), sqrt(2)), then the series of artanh
  const I bits = hn::BitCast(di, safe) - hn::Set(di, 0x3F3504F3);
  const I exponent = hn::ShiftRight<23>(bits);
  const F m = hn::BitCast(d, hn::And(bits, hn::Set(di, 0x7FFFFF)) + hn::Set(di, 0x3F3504F3));
  const F t = (m - one) / (m + one), t2 = t * t;
  F series = hn::Set(d, 1.0f / 9) * t2 + hn::Set(d, 1.0f / 7);
  series = series * t2 + hn::Set(d, 1.0f / 5);
  series = series * t2 + hn::Set(d, 1.0f / 3);
  series = series * t2 + one;
  const F log2 = hn::ConvertTo(d, exponent) + t * series * hn::Set(d, 2.8853900817779268f);
  // exp2: integer part into the exponent, the rest by Taylor's series about 0
  const F y = hn::Max(log2 * hn::Set(d, p), hn::Set(d, -126.0f));
  const I whole = hn::NearestInt(y);
  const F f = (y - hn::ConvertTo(d, whole)) * hn::Set(d, 0.69314718055994531f);
  F e = hn::Set(d, 1.0f / 5040) * f + hn::Set(d, 1.0f / 720);
  e = e * f + hn::Set(d, 1.0f / 120);
  e = e * f + hn::Set(d, 1.0f / 24);
  e = e * f + hn::Set(d, 1.0f / 6);
  e = e * f + hn::Set(d, 0.5f);
  e = e * f + one;
  e = e * f + one;
  const F r = hn::BitCast(d, hn::BitCast(di, e) + hn::ShiftLeft<23>(whole));
  return hn::IfThenElseZero(hn::Gt(x, hn::Set(d, 1e-30f)), hn::IfThenElseZero(hn::Gt(y, hn::Set(d, -126.0f)), r));
}

HWY_INLINE V3 unit(V3 a, V3 otherwise) {
  const DF d;
  const F l2 = dot3(a, a);
  const M good = hn::And(hn::Gt(l2, hn::Zero(d)), hn::Lt(l2, hn::Set(d, 3e38f)));
  return select3(good, a * (hn::Set(d, 1.0f) / hn::Sqrt(l2)), otherwise);
}

/// Light and gloss of a surface with face normal `normal` (any length and side) whose smooth normal is smooth(face, otherwise the face's).
template <class Smooth>
HWY_INLINE void light_up(const Material& m, const WorldLight* lights, size_t light_count, V3 ray, V3 normal, Smooth&& smooth, F& light,
                         F& gloss) {
  const DF d;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  light = one, gloss = zero;
  if (!m.lit) return;
  const V3 back = {zero - ray.x, zero - ray.y, zero - ray.z};
  const V3 view = unit(back, back);
  // Edge lengths may be tiny or huge: bring the face normal near 1 before it is squared.
  const F largest = hn::Max(hn::Max(hn::Abs(normal.x), hn::Abs(normal.y)), hn::Abs(normal.z));
  V3 face = unit(normal * (one / largest), view);
  face = select3(hn::Lt(dot3(face, view), zero), V3{zero - face.x, zero - face.y, zero - face.z}, face);
  const V3 n = smooth(face);
  F diffuse = zero, specular = zero;
  const F nv = dot3(n, view);
  for (size_t i = 0; i < light_count; ++i) {
    const WorldLight& l = lights[i];
    const V3 to = {hn::Set(d, l.x), hn::Set(d, l.y), hn::Set(d, l.z)};
    const F nl = dot3(n, to), strength = hn::Set(d, l.intensity);
    diffuse = diffuse + hn::Max(nl, zero) * strength;
    if (m.specular == 0) continue;
    const F mirrored = hn::Min(hn::Max((nl + nl) * nv - dot3(to, view), zero), one);  // reflected light . viewer
    specular = specular + hn::IfThenElseZero(hn::Gt(nl, zero), power(mirrored, m.power) * strength);
  }
  light = hn::Set(d, m.ambient) + hn::Set(d, m.diffuse) * diffuse, gloss = hn::Set(d, m.specular) * specular;
}

/// A smooth normal of any length, turned to the side that is seen.
HWY_INLINE V3 lit_side(V3 mixed, V3 face) {
  const F zero = hn::Zero(DF());
  const V3 n = unit(mixed, face);
  return select3(hn::Lt(dot3(n, face), zero), V3{zero - n.x, zero - n.y, zero - n.z}, n);
}

}  // namespace sg::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
