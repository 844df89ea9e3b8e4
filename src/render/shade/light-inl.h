// SPDX-License-Identifier: Apache-2.0
// Vectors of points and the light on them, for files that are compiled once for each target and have included Highway. Inside
// render only. No libm: every target gives the same bits.
#if defined(SG_RASTER_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_RASTER_LIGHT_INL
#undef SG_RASTER_LIGHT_INL
#else
#define SG_RASTER_LIGHT_INL
#endif
#include "render/shade/blinn_phong-inl.h"
#include "render/shade/shade.h"

HWY_BEFORE_NAMESPACE();
namespace sg::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

using DF = hn::ScalableTag<float>;
using DI = hn::RebindToSigned<DF>;
using F = hn::Vec<DF>;
using I = hn::Vec<DI>;
using M = hn::Mask<DF>;

// Beside those of V3.
using simd::HWY_NAMESPACE::operator+;
using simd::HWY_NAMESPACE::operator-;
using simd::HWY_NAMESPACE::operator*;

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
  return {set(d, a[0]), set(d, a[1]), set(d, a[2])};
}
HWY_INLINE V3 gather3(const float* base, I index) {
  const DF d;
  const I at = index + index + index;
  return {hn::GatherIndex(d, base, at), hn::GatherIndex(d, base + 1, at), hn::GatherIndex(d, base + 2, at)};
}
HWY_INLINE V3 select3(M m, V3 a, V3 b) { return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)}; }

/// n.h for the half vector h between a lamp and the viewer, all unit: from n.l, n.v and l.v.
HWY_INLINE F cosine_to_half(F n_l, F n_v, F l_v) {
  const F square = 2.0f + l_v + l_v;  // of l + v; 0 where the lamp is behind all that is seen
  return (n_l + n_v) / sqrt(max(square, 1e-12f));
}

HWY_INLINE V3 unit(V3 a, V3 otherwise) {
  const F l2 = dot3(a, a);
  const M good = (l2 > 0) & (l2 < 3e38f);
  return select3(good, a * (1.0f / sqrt(l2)), otherwise);
}

/// Light and gloss of a surface with face normal `normal` (any length and side) whose smooth normal is smooth(face, otherwise the face's).
template <class Smooth>
HWY_INLINE void light_up(const Material& m, std::span<const Lamp> lamps, V3 ray, V3 normal, Smooth&& smooth, F& light, F& gloss) {
  const DF d;
  const F zero = set(d, 0), one = set(d, 1.0f);
  light = one, gloss = zero;
  if (!m.lit) return;
  const V3 back = {zero - ray.x, zero - ray.y, zero - ray.z};
  const V3 view = unit(back, back);
  // Edge lengths may be tiny or huge: bring the face normal near 1 before it is squared.
  const F largest = max(max(abs(normal.x), abs(normal.y)), abs(normal.z));
  V3 face = unit(normal * (one / largest), view);
  face = select3(dot3(face, view) < zero, V3{zero - face.x, zero - face.y, zero - face.z}, face);
  const V3 n = smooth(face);
  F diffuse = zero, specular = zero;
  const F nv = dot3(n, view);
  const shading::HWY_NAMESPACE::Power power(m.power);
  for (const Lamp& lamp : lamps) {
    const Vec3f direction(lamp.direction);
    const V3 to = {set(d, direction.x), set(d, direction.y), set(d, direction.z)};
    const F nl = dot3(n, to), intensity = set(d, lamp.intensity);
    const auto terms = shading::HWY_NAMESPACE::lamp_terms(nl, cosine_to_half(nl, nv, dot3(to, view)), power);
    diffuse = diffuse + terms.diffuse * intensity, specular = specular + terms.specular * intensity;
  }
  light = set(d, m.ambient) + m.diffuse * diffuse, gloss = m.specular * specular;
}

/// A smooth normal of any length, turned to the side that is seen.
HWY_INLINE V3 lit_side(V3 mixed, V3 face) {
  const F zero = set(DF(), 0);
  const V3 n = unit(mixed, face);
  return select3(dot3(n, face) < zero, V3{zero - n.x, zero - n.y, zero - n.z}, n);
}

}  // namespace sg::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
