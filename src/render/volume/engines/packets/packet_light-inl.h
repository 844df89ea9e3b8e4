// SPDX-License-Identifier: Apache-2.0
// Surfaces that the gradients of a field make, seen along the rays of a packet, and the light on them.
#if defined(SG_PACKET_LIGHT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_LIGHT_INL_H
#undef SG_PACKET_LIGHT_INL_H
#else
#define SG_PACKET_LIGHT_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "render/shade/blinn_phong-inl.h"
#include "render/volume/engines/packets/packet_axes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

template <class D>
struct LitLanes {
  Float<D> diffuse, specular;
};

/// The difference of light: diffuse and specular together.
template <class D>
HWY_INLINE Float<D> apart(const LitLanes<D>& x, const LitLanes<D>& y) {
  return abs(x.diffuse - y.diffuse) + abs(x.specular - y.specular);
}

/// Where a field has a gradient: a surface, seen along a ray.
template <class D>
struct FieldSurface {
  Float<D> normal[3];  ///< unit, along the gradient
  Float<D> along;      ///< of the normal and the ray: the cosine
  Float<D> weight;     ///< of the surface: 0 where there is none (no gradient, or one beyond numbers), 1 and more where it is all surface

  HWY_INLINE void take(const FieldSurface& o, Mask<D> which) {
    for (int a = 0; a < 3; ++a) normal[a] = select(which, o.normal[a], normal[a]);
    along = select(which, o.along, along), weight = select(which, o.weight, weight);
  }
};

/// 1 - cosine of the angle by which the surface turns from one place to another.
template <class D>
HWY_INLINE Float<D> turn_between(const FieldSurface<D>& a, const FieldSurface<D>& b) {
  const Float<D> cosine = mul_add(a.normal[2], b.normal[2], mul_add(a.normal[1], b.normal[1], a.normal[0] * b.normal[0]));
  return 1.0f - cosine;
}
/// Where the gradient goes straight it turns fastest where it is small: half way it has turned by this share, if it began at 0.
template <class D>
HWY_INLINE Float<D> turned_half_way(const FieldSurface<D>& a, const FieldSurface<D>& b) {
  return b.weight / max(a.weight + b.weight, 1e-30f);
}

/// The weight of a surface between two places where the gradient goes straight: around a place without one it fades
/// (FieldSurface::weight), and a ray that passes by there may end with the weight with which it began.
template <class D>
struct Fade {
  Float<D> middle;  ///< half way, 1 at most
  Float<D> hollow;  ///< by how much less there is somewhere than a straight line between the ends would have it

  HWY_INLINE Fade(const FieldSurface<D>& a, const FieldSurface<D>& b, Float<D> turn) {
    using F = Float<D>;
    const D d;
    const F zero = set(d, 0), one = set(d, 1.0f), half = set(d, 0.5f), least = set(d, 1e-30f);
    middle = one, hollow = zero;
    // The triangle of both gradients is at least as high as it would be if both were as the smaller one.
    const F smaller = min(a.weight, b.weight);
    const auto fading = smaller * smaller * neg_mul_add(half, turn, one) < one;
    if (none(fading)) return;
    const F aa = a.weight * a.weight, bb = b.weight * b.weight, ab = a.weight * b.weight * (one - turn);
    const F ends = half * (min(a.weight, one) + min(b.weight, one));
    const F half_way = min(one, half * sqrt(max(zero, aa + bb + (ab + ab))));
    // The nearest to nothing, where that lies between: the height of that triangle.
    const F square = max(zero, neg_mul_add(ab, ab, aa * bb)) / max(aa + bb - (ab + ab), least);
    const F nearest = select(ab < min(aa, bb), sqrt(square), smaller);
    const F dip = min(one, smaller) - min(one, nearest);
    middle = select(fading, half_way, one);
    hollow = only(fading, max(ends - half_way, dip));
  }
};
/// Is the ray so near to the surface's edge that it may turn over and back between two places?
template <class D>
HWY_INLINE Mask<D> grazing(const FieldSurface<D>& a, const FieldSurface<D>& b) {
  return min(abs(a.along), abs(b.along)) < turn_between(a, b);
}
/// The same where the gradient may leave the straight line between them by `astray`, told as weights of surfaces.
template <class D>
HWY_INLINE Mask<D> grazing(const FieldSurface<D>& a, const FieldSurface<D>& b, Float<D> astray) {
  return grazing(a, b) | (min(abs(a.along) * a.weight, abs(b.along) * b.weight) < astray);
}

/// The lamps of a picture and the rays that they are seen along.
template <class D>
class Lighting {
  using F = Float<D>;
  using I = Int<D>;

 public:
  Lighting() = default;
  HWY_INLINE Lighting(const Volume& volume, const Illumination& light, const RayPacket& rays)
      : volume_(&volume), light_(&light), edge_(float(volume.edge)) {
    const D d;
    for (int a = 0; a < 3; ++a) ray[a] = hn::Load(d, rays.direction[a]);
    const auto& m = volume.shade_plan.to_world;
    upright_ = m[0][1] == 0 && m[0][2] == 0 && m[1][0] == 0 && m[1][2] == 0 && m[2][0] == 0 && m[2][1] == 0;
    if (!volume.shaded) return;
    power_ = shading::HWY_NAMESPACE::Power(light.material.power);
    for (size_t l = 0; l < light.lamps.size(); ++l) {
      intensity_ += light.lamps[l].intensity;
      // Half way between the light and the viewer.
      const Vec3f to(light.lamps[l].direction);
      const F h[3] = {to.x - ray[0], to.y - ray[1], to.z - ray[2]};
      const F length = sqrt(dot(h, h));
      const F per = only(length > 0, 1.0f / length);
      for (int a = 0; a < 3; ++a) half_[l][a] = h[a] * per;
    }
  }

  static HWY_INLINE F dot(const F a[3], const F b[3]) { return mul_add(a[2], b[2], mul_add(a[1], b[1], a[0] * b[0])); }

  /// A gradient of the field per world length, from one per cell.
  HWY_INLINE void to_world(const F g[3], F out[3]) const {
    const D d;
    const auto& m = volume_->shade_plan.to_world;
    for (int a = 0; a < 3; ++a) {
      if (upright_) {
        out[a] = m[a][a] * g[a];
        continue;
      }
      const F row[3] = {set(d, m[a][0]), set(d, m[a][1]), set(d, m[a][2])};
      out[a] = dot(row, g);
    }
  }

  /// The same with the rays in another order.
  HWY_INLINE Lighting permuted(Int<D> order) const {
    const D d;
    const auto to = hn::IndicesFromVec(d, order);
    Lighting l;
    l.volume_ = volume_, l.light_ = light_, l.edge_ = edge_, l.upright_ = upright_, l.power_ = power_, l.intensity_ = intensity_;
    for (int a = 0; a < 3; ++a) l.ray[a] = hn::TableLookupLanes(ray[a], to);
    for (size_t n = 0; n < light_->lamps.size(); ++n)
      for (int a = 0; a < 3; ++a) l.half_[n][a] = hn::TableLookupLanes(half_[n][a], to);
    return l;
  }

  /// The surface where the field has this gradient (world); it changes by `over_edge` over an edge of a cell.
  HWY_INLINE FieldSurface<D> surface(const F g[3]) const {
    const F square = dot(g, g), length = sqrt(square);
    return surface(g, square, length, length * edge_);
  }
  HWY_INLINE FieldSurface<D> surface(const F g[3], F over_edge) const {
    const F square = dot(g, g);
    return surface(g, square, sqrt(square), over_edge);
  }

  /// Light on the face that is seen.
  HWY_INLINE LitLanes<D> on(const FieldSurface<D>& s) const { return lit<false>(s, facing(s), nullptr, nullptr); }
  /// The same; `sides` tells on which side of its kinks the light is: bit 0 for the face that is seen, bit 1 for whether its
  /// weight is 1 or more, then one for every lamp that reaches it. `nearest`: the cosine to the nearest middle of a highlight.
  HWY_INLINE LitLanes<D> on(const FieldSurface<D>& s, I& sides, F& nearest) const { return lit<true>(s, facing(s), &sides, &nearest); }
  /// Light on the face that is not seen.
  HWY_INLINE LitLanes<D> on_back(const FieldSurface<D>& s) const { return lit<false>(s, facing(s) ^ flipped(), nullptr, nullptr); }
  /// What `sides` differ by where only the face that is seen is another.
  HWY_INLINE I turned_over() const { return set(IntTag<D>(), 1 | ((1 << light_->lamps.size()) - 1) << 2); }

  /// The second derivative of the light over the angle of the surface, at most, on an arc of `turn` (1 - cosine) from a place that is
  /// `nearest` to the middle of a highlight, or to such a place. A highlight is exp(-p x^2 / 2) at the angle x.
  HWY_INLINE F bend(F nearest, F turn) const {
    const D d;
    const Material& m = light_->material;
    const F zero = set(d, 0), one = set(d, 1.0f);
    const F away = sqrt(max(zero, one - nearest)), half_arc = 0.5f * sqrt(max(zero, turn));
    const F closest = max(zero, away - half_arc), fall = closest * closest;
    const F lobe = power_(one - fall) * max(one, 2 * m.power * fall);
    return mul_add(intensity_ * m.specular * m.power, lobe, intensity_ * m.diffuse);
  }
  /// The same anywhere.
  HWY_INLINE F most_bend() const {
    return set(D(), intensity_ * (light_->material.diffuse + light_->material.specular * light_->material.power));
  }

  /// By how much light may differ between where there is a surface and where there is none.
  HWY_INLINE F most_fade() const {
    const Material& m = light_->material;
    const float flat = std::abs(1 - m.ambient), lit = std::abs(m.ambient + m.diffuse * intensity_ - 1);
    return set(D(), std::max(flat, lit) + m.specular * intensity_);
  }

  /// By how much light may differ where a surface turns over or a lamp begins to reach it.
  HWY_INLINE F most_jump() const { return set(D(), intensity_ * (light_->material.diffuse + light_->material.specular)); }

  const Material& material() const { return light_->material; }
  size_t lamps() const { return light_->lamps.size(); }
  HWY_INLINE void towards(size_t lamp, F out[3]) const {
    const Vec3f to(light_->lamps[lamp].direction);
    out[0] = set(D(), to.x), out[1] = set(D(), to.y), out[2] = set(D(), to.z);
  }

  F ray[3];  ///< directions

 private:
  const Volume* volume_ = nullptr;
  const Illumination* light_ = nullptr;
  float edge_ = 1;                       ///< of a cell
  bool upright_ = false;                 ///< the axes of the lattice are those of the world
  float intensity_ = 0;                  ///< of all lamps
  shading::HWY_NAMESPACE::Power power_;  ///< of highlights
  F half_[Illumination::most_lamps][3];

  static HWY_INLINE F flipped() { return hn::SignBit(D()); }
  /// The sign bit where the normal points away from the viewer: then the other face is seen.
  static HWY_INLINE F facing(const FieldSurface<D>& s) { return only(s.along > 0, flipped()); }

  HWY_INLINE FieldSurface<D> surface(const F g[3], F square, F length, F over_edge) const {
    const F per = 1.0f / max(length, 1e-30f);
    FieldSurface<D> s;
    for (int a = 0; a < 3; ++a) s.normal[a] = g[a] * per;
    s.along = dot(s.normal, ray);
    const auto some = (square > 0) & (square < 1e30f);
    s.weight = only(some, over_edge * volume_->shade_plan.per_scale);
    return s;
  }

  template <bool tell>
  HWY_INLINE LitLanes<D> lit(const FieldSurface<D>& s, F flip, I* sides, F* nearest) const {
    const D d;
    const IntTag<D> di;
    const F zero = set(d, 0), one = set(d, 1.0f);
    if constexpr (tell) {
      const auto bit = [&](auto mask, int n) HWY_ATTR { return only(mask, set(di, 1 << n)); };
      *sides = bit(s.along > zero, 0) | bit(s.weight < one, 1);
      *nearest = zero;
    }
    const Material& m = light_->material;
    F diffuse = zero, specular = zero;
    for (size_t l = 0; l < light_->lamps.size(); ++l) {
      const Vec3f to(light_->lamps[l].direction);
      const F lamp[3] = {set(d, to.x), set(d, to.y), set(d, to.z)};
      const F c = flip ^ dot(s.normal, lamp), h = flip ^ dot(s.normal, half_[l]);
      const F intensity = set(d, light_->lamps[l].intensity);
      const auto terms = shading::HWY_NAMESPACE::lamp_terms(c, h, power_);
      diffuse = mul_add(intensity, terms.diffuse, diffuse);
      specular = mul_add(intensity, terms.specular, specular);
      if constexpr (tell) {
        *sides = *sides | only(terms.reached, set(di, 4 << l));
        *nearest = max(*nearest, only(terms.reached, h));
      }
    }
    // Where there is no surface normals may be no numbers.
    const auto some = s.weight > zero;
    const F weight = min(s.weight, one);
    const F change = mul_add(m.diffuse, diffuse, m.ambient) - one;
    return {select(some, mul_add(weight, change, one), one), only(some, weight * (m.specular * specular))};
  }
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
