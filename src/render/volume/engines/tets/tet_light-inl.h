// SPDX-License-Identifier: Apache-2.0
// Light in the tetrahedra that the lanes of a packet cross: the gradient is linear in each, so that the normal turns in one plane and one
// way, and where the surface turns over is known.
#if defined(SG_TET_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_TET_LIGHT_INL
#undef SG_TET_LIGHT_INL
#else
#define SG_TET_LIGHT_INL
#endif
#include "render/shade/blinn_phong-inl.h"
#include "render/volume/engines/tets/tet_medium-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// A factor of the colour, and white on top of it.
struct Shine {
  F diffuse, specular;
};
HWY_ATTR inline F apart(const Shine& a, const Shine& b) {
  return hn::Add(hn::Abs(hn::Sub(a.diffuse, b.diffuse)), hn::Abs(hn::Sub(a.specular, b.specular)));
}
HWY_ATTR inline Shine chosen(M yes, const Shine& a, const Shine& b) {
  return {hn::IfThenElse(yes, a.diffuse, b.diffuse), hn::IfThenElse(yes, a.specular, b.specular)};
}

/// The gradient at a place, and the light on it seen from the side of the viewer.
struct Surface {
  F gradient[3], along;  ///< world; its product with the ray's direction
  F per_size, much;      ///< 1 / its length; how much of a surface there is, 0 to 1
  F nearest;             ///< the cosine to the nearest middle of a highlight
  F facing;              ///< which lamps it faces, as a sum of powers of two
  Shine shine;
};
HWY_ATTR inline Surface chosen(M yes, const Surface& a, const Surface& b) {
  Surface r;
  for (int k = 0; k < 3; ++k) r.gradient[k] = hn::IfThenElse(yes, a.gradient[k], b.gradient[k]);
  r.along = hn::IfThenElse(yes, a.along, b.along), r.per_size = hn::IfThenElse(yes, a.per_size, b.per_size);
  r.much = hn::IfThenElse(yes, a.much, b.much), r.nearest = hn::IfThenElse(yes, a.nearest, b.nearest);
  r.facing = hn::IfThenElse(yes, a.facing, b.facing);
  r.shine = chosen(yes, a.shine, b.shine);
  return r;
}

HWY_ATTR inline F dot(const F a[3], const F b[3]) {
  return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}

/// The lamps, and the rays of the lanes.
class Lighting {
 public:
  const TetLight& light;

  HWY_ATTR Lighting(const TetLight& from, const TetPacket& packet, size_t lane) : light(from), power_(from.material.power) {
    const D d;
    for (int k = 0; k < 3; ++k) direction_[k] = hn::Load(d, packet.direction[k] + lane);
    for (size_t l = 0; l < from.lamps.size(); ++l) {
      all_ += from.lamps[l].intensity;
      if (l < ready) half_way_to(l, half_[l]);
    }
  }

  /// Where the line crosses the face of these vertices.
  HWY_ATTR Surface on_face(const I id[3], const F weight[3]) const {
    Surface s;
    for (int k = 0; k < 3; ++k) s.gradient[k] = hn::Zero(D());
    for (int v = 0; v < 3; ++v) {
      const I of = hn::Add(hn::ShiftLeft<1>(id[v]), id[v]);
      for (int k = 0; k < 3; ++k) s.gradient[k] = hn::Add(s.gradient[k], hn::Mul(weight[v], hn::GatherIndex(D(), light.gradients + k, of)));
    }
    s.along = dot(s.gradient, direction_);
    shine(s, s.along);
    return s;
  }
  /// At a share of the way.
  HWY_ATTR Surface between(const Surface& a, const Surface& b, F share) const {
    Surface s = straight(a, b, share);
    shine(s, s.along);
    return s;
  }
  /// The same without light, which shine() adds.
  HWY_ATTR Surface straight(const Surface& a, const Surface& b, F share) const {
    Surface s;
    for (int k = 0; k < 3; ++k) s.gradient[k] = mixed(a.gradient[k], b.gradient[k], share);
    s.along = mixed(a.along, b.along, share);
    return s;
  }

  /// light_at, on the side of the surface that is seen where the product with the direction is `along`.
  HWY_ATTR void shine(Surface& s, F along) const { shine<false>(s, along, s); }
  /// The limit of the light from the side of another place, which is lit already: at a kink, where rounding does not tell.
  HWY_ATTR void shine_beside(Surface& s, const Surface& other) const { shine<true>(s, other.along, other); }

  /// `like` tells which lamps it faces.
  template <bool beside>
  HWY_ATTR void shine(Surface& s, F along, const Surface& like) const {
    const D d;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const F square = dot(s.gradient, s.gradient);
    const M bent = hn::And(hn::Gt(square, zero), hn::Lt(square, hn::Set(d, 1e30f)));
    const F size = hn::Sqrt(hn::IfThenElse(bent, square, one));
    s.much = hn::IfThenElseZero(bent, hn::Min(one, hn::Mul(size, hn::Set(d, light.edge_per_scale))));
    s.per_size = hn::IfThenElseZero(bent, hn::Div(one, size));
    const M far = hn::Gt(along, zero);
    const F side = hn::IfThenElse(far, hn::Neg(s.per_size), s.per_size);
    F side_there = side;
    if constexpr (beside) side_there = hn::IfThenElse(far, hn::Neg(like.per_size), like.per_size);
    F diffuse = zero, specular = zero;
    s.nearest = s.facing = zero;
    float number = 1;
    for (size_t n = 0; n < light.lamps.size(); ++n) {
      const Lamp& l = light.lamps[n];
      const Vec3f direction(l.direction);
      const F to[3] = {hn::Set(d, direction.x), hn::Set(d, direction.y), hn::Set(d, direction.z)};
      F c = hn::Mul(side, dot(s.gradient, to));
      const F intensity = hn::Set(d, l.intensity);
      if constexpr (beside) {
        // A lamp that reaches the other place shines here, too, at its limit.
        const M faces = hn::Gt(hn::Mul(side_there, dot(like.gradient, to)), zero);
        c = hn::IfThenElse(faces, hn::Max(c, hn::Set(d, 1e-30f)), zero);
      }
      F other[3];
      if (n >= ready) half_way_to(n, other);
      const F h = hn::Mul(side, dot(s.gradient, n < ready ? half_[n] : other));
      const auto terms = shading::HWY_NAMESPACE::lamp_terms(c, h, power_);
      s.nearest = hn::Max(s.nearest, h);
      s.facing = hn::Add(s.facing, hn::IfThenElseZero(terms.reached, hn::Set(d, number)));
      number *= 2;
      diffuse = hn::Add(diffuse, hn::Mul(intensity, terms.diffuse));
      specular = hn::Add(specular, hn::Mul(intensity, terms.specular));
    }
    const Material& m = light.material;
    const F factor = hn::Sub(hn::Add(hn::Set(d, m.ambient), hn::Mul(hn::Set(d, m.diffuse), diffuse)), one);
    s.shine = {hn::Add(one, hn::Mul(s.much, factor)), hn::Mul(s.much, hn::Mul(hn::Set(d, m.specular), specular))};
  }

  /// What a straight line between the light at two places may have wrong in between, no lamp beginning or ceasing to shine and the surface
  /// not turning over; and what a parabola through the middle may. Estimates.
  struct Bend {
    F line, parabola;
  };
  HWY_ATTR Bend may_bend(const Surface& a, const Surface& b) const {
    const D d;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const F cosine = hn::Mul(hn::Mul(dot(a.gradient, b.gradient), a.per_size), b.per_size);
    // None at one end: there all of it counts.
    const F turn = hn::IfThenElseZero(hn::Gt(hn::Max(a.per_size, b.per_size), zero), hn::Max(zero, hn::Sub(one, cosine)));
    // The second derivative of a highlight at this angle beside its middle (see integrate.cpp), from above without an exponential.
    const F away = hn::Sqrt(hn::Max(zero, hn::Sub(one, hn::Max(a.nearest, b.nearest))));
    const F closest = hn::Max(zero, hn::Sub(away, hn::Mul(hn::Set(d, 0.5f), hn::Sqrt(turn))));
    const F power = hn::Set(d, light.material.power), x = hn::Mul(power, hn::Mul(closest, closest));
    const F lobe = hn::Mul(power, hn::Div(hn::Set(d, 1.5f), hn::Add(one, hn::Mul(hn::Set(d, 0.25f), hn::Mul(x, x)))));
    const F second = hn::Add(hn::Set(d, light.material.diffuse), hn::Mul(hn::Set(d, light.material.specular), lobe));
    const F bend = hn::Mul(hn::Mul(turn, second), hn::Set(d, all_ / 12));
    // The amount of surface turns sharply where it becomes whole.
    const F fades = hn::Mul(hn::Set(d, 0.25f), hn::Abs(hn::Sub(a.much, b.much)));
    // The sum of a short gradient and a long one turns with the long one: where it is, light has changed by the share s r / (1 - s + s r)
    // at the share s of the way, r = (1 + f) / (1 - f) the ratio of their lengths. In the mean that is off the line by f (1/3 + f^2 / 6) at
    // most, and off the parabola by f^3 (1/15 + f^2 / 10).
    const F sizes = hn::Add(a.per_size, b.per_size);
    const F ratio = hn::Div(hn::Abs(hn::Sub(a.per_size, b.per_size)), hn::IfThenElse(hn::Gt(sizes, zero), sizes, one));
    const F square = hn::Mul(ratio, ratio), early = hn::Mul(apart(a.shine, b.shine), ratio);
    const F line = hn::Mul(early, hn::Add(hn::Set(d, 1.0f / 3), hn::Mul(square, hn::Set(d, 1.0f / 6))));
    const F parabola = hn::Mul(hn::Mul(early, square), hn::Add(hn::Set(d, 1.0f / 15), hn::Mul(square, hn::Set(d, 0.1f))));
    return {hn::Add(hn::Add(bend, line), fades),
            hn::Add(hn::Add(hn::Mul(hn::Mul(bend, turn), hn::Mul(hn::Set(d, 0.1f), hn::Add(one, lobe))), parabola), fades)};
  }

  /// The next place beyond `at` where the surface turns over, or a lamp begins or ceases to shine on it; 2 when there is none.
  HWY_ATTR F next_kink(const Surface& a, const Surface& b, F at) const {
    const D d;
    F next = hn::Set(d, 2.0f);
    const auto look = [&](F x, F y) HWY_ATTR {
      const F fall = hn::Sub(x, y);
      const M some = hn::And(hn::Le(hn::Mul(x, y), hn::Zero(d)), hn::Ne(fall, hn::Zero(d)));
      const F place = hn::Div(x, hn::IfThenElse(some, fall, hn::Set(d, 1.0f)));
      next = hn::IfThenElse(hn::And(some, hn::Gt(place, at)), hn::Min(next, place), next);
    };
    look(a.along, b.along);
    for (const Lamp& l : light.lamps) {
      const Vec3f direction(l.direction);
      const F to[3] = {hn::Set(d, direction.x), hn::Set(d, direction.y), hn::Set(d, direction.z)};
      look(dot(a.gradient, to), dot(b.gradient, to));
    }
    return next;
  }

  static HWY_ATTR F mixed(F a, F b, F share) { return hn::Add(a, hn::Mul(share, hn::Sub(b, a))); }

 private:
  /// The direction half way between a lamp and the viewer; zero where there is none.
  HWY_ATTR void half_way_to(size_t lamp, F half[3]) const {
    const D d;
    const Vec3f to(light.lamps[lamp].direction);
    half[0] = hn::Sub(hn::Set(d, to.x), direction_[0]), half[1] = hn::Sub(hn::Set(d, to.y), direction_[1]);
    half[2] = hn::Sub(hn::Set(d, to.z), direction_[2]);
    const F square = dot(half, half), one = hn::Set(d, 1.0f);
    const F per = hn::Div(one, hn::Sqrt(hn::IfThenElse(hn::Gt(square, hn::Zero(d)), square, one)));
    for (int k = 0; k < 3; ++k) half[k] = hn::Mul(half[k], per);
  }

  shading::HWY_NAMESPACE::Power power_;  ///< of highlights
  static constexpr size_t ready = 4;     ///< lamps whose half_ is kept; others are asked for each time
  F direction_[3], half_[ready][3];
  float all_ = 0;
};

/// A segment: what it is lit by at its ends, the value there, and its length.
struct LitWay {
  Surface first, last;
  F front, back, length;
};

/// The same for a part on which the light is as good as a parabola through a, m (in the middle) and b.
HWY_ATTR inline void behind_lit(const LinePart& p, F length, M on, const Shine& a, const Shine& m, const Shine& b, Colors& sum) {
  const D d;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const F depth = hn::Mul(p.tau, length);
  const M lit = hn::And(on, hn::Gt(depth, zero));
  const Faded f = fade(hn::IfThenElseZero(lit, depth));
  // Where the light that is seen comes from, on the way: its mean place (the front hides what is behind), and how far it spreads where tau
  // is even (near 1/12 - 1/240 D^2 for thin parts, 1 / D^2 for deep ones).
  const F alpha = hn::IfThenElse(lit, f.alpha, one);
  const F centre = hn::Sub(hn::Div(p.moment, hn::IfThenElse(lit, p.tau, one)), hn::Div(f.hidden, alpha));
  const F spread = hn::Div(hn::Sub(one, p.uneven), hn::Add(hn::Set(d, 12.0f), hn::Mul(hn::Set(d, 0.65f), hn::Mul(depth, depth))));
  const F w = hn::Min(hn::Max(centre, zero), one), v = hn::Sub(one, w), two = hn::Set(d, 2.0f);
  const F wa = hn::Add(hn::Mul(v, hn::Sub(v, w)), hn::Mul(two, spread)), wb = hn::Add(hn::Mul(w, hn::Sub(w, v)), hn::Mul(two, spread));
  const F wm = hn::Sub(hn::Sub(one, wa), wb);
  const auto there = [&](F x, F y, F z) HWY_ATTR { return hn::Add(hn::Add(hn::Mul(wa, x), hn::Mul(wm, y)), hn::Mul(wb, z)); };
  const F diffuse = there(a.diffuse, m.diffuse, b.diffuse), specular = there(a.specular, m.specular, b.specular);
  const F share = hn::IfThenElseZero(lit, sum.pass), gain = hn::Mul(hn::Mul(share, f.ratio), length), loss = hn::Mul(share, f.hidden);
  const F white = hn::Mul(hn::Mul(share, f.alpha), specular);
  F* const to[3] = {&sum.r, &sum.g, &sum.b};
  const F* const mean[3] = {&p.r, &p.g, &p.b};
  for (int k = 0; k < 3; ++k) {
    const F c = hn::Sub(hn::Mul(gain, *mean[k]), hn::Mul(loss, hn::Sub(p.back[k], p.front[k])));
    *to[k] = hn::Add(*to[k], hn::Add(hn::Mul(c, diffuse), white));
  }
  sum.pass = hn::Sub(sum.pass, hn::Mul(share, f.alpha));
}

HWY_ATTR inline Shine half_way(const Shine& a, const Shine& b) {
  const F half = hn::Set(D(), 0.5f);
  return {hn::Mul(half, hn::Add(a.diffuse, b.diffuse)), hn::Mul(half, hn::Add(a.specular, b.specular))};
}

/// May a part be drawn as one?
struct Fair {
  const TetMedium& medium;
  const Lighting& lighting;

  /// With light that is so far off at most.
  HWY_ATTR M operator()(const LinePart& p, F length, F pass, F off, F differ) const {
    const D d;
    const F one = hn::Set(d, 1.0f);
    const F depth = hn::Mul(p.tau, length), change = color_change(p), weight = hn::Mul(pass, hn::Min(depth, one));
    const F share = hn::Set(d, 0.4f * lighting.light.tolerance);
    const F allowed = hn::Mul(share, hn::Add(weight, hn::Mul(length, hn::Set(d, lighting.light.per_ray))));
    // Colour and light that both change have a product that is not straight; and the front hides what is behind, exactly so where tau is
    // even.
    const F product = hn::Mul(change, differ),
            order = hn::Mul(hn::Mul(hn::Add(change, differ), p.uneven), hn::Min(depth, hn::Set(d, 6.0f)));
    const F wrong = hn::Add(off, hn::Mul(hn::Add(product, order), hn::Set(d, 1.0f / 12)));
    return hn::Le(hn::Mul(weight, wrong), allowed);
  }
  /// With the parabola through the middle.
  HWY_ATTR M operator()(const LinePart& p, F length, F pass, const Surface& a, const Surface& m, const Surface& b) const {
    const D d;
    const F bulge = apart(m.shine, half_way(a.shine, b.shine));
    const F unsure = hn::Add(hn::Set(d, 0.05f), hn::Mul(hn::Set(d, 1.0f / 3), p.uneven));
    return (*this)(p, length, pass, hn::Add(hn::Mul(bulge, unsure), lighting.may_bend(a, b).parabola), apart(a.shine, b.shine));
  }
};

/// Puts a lit segment behind what is there: in parts, each as long as it may be.
HWY_ATTR inline void gather_lit(const TetMedium& medium, const Lighting& lighting, const LitWay& way, const Slice& slice, M on,
                                float stop_below, Colors& sum) {
  const D d;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  const Fair fair{medium, lighting};
  const LinePart all = means<Ask::moment>(medium, way.front, way.back, slice(way.front), slice(way.back), on);
  on = hn::And(on, hn::Gt(hn::Mul(all.tau, way.length), zero));
  const Surface &first = way.first, &last = way.last;
  // Where it turns over, at an end too, or meets another lamp, its ends do not tell.
  const M smooth = hn::And(hn::Eq(first.facing, last.facing), hn::Gt(hn::Mul(first.along, last.along), zero));
  const M straight = fair(all, way.length, sum.pass, lighting.may_bend(first, last).line, apart(first.shine, last.shine));
  M as_one = hn::And(on, hn::And(smooth, straight));
  Shine middle = half_way(first.shine, last.shine);
  if (!hn::AllFalse(d, hn::AndNot(straight, hn::And(on, smooth)))) {
    const Surface m = lighting.between(first, last, half);
    as_one = hn::Or(as_one, hn::And(hn::And(on, smooth), fair(all, way.length, sum.pass, first, m, last)));
    middle = chosen(straight, middle, m.shine);  // whatever the lanes beside ask for
  }
  behind_lit(all, way.length, as_one, first.shine, middle, last.shine, sum);
  M more = hn::AndNot(as_one, on);
  if (hn::AllFalse(d, more)) return;

  F at = zero, step = hn::IfThenElse(smooth, half, one), from = way.front;
  Surface a = first;
  M turned = hn::Gt(first.along, zero);  // the side on which `a` is lit
  F facing = first.facing;               // and by which lamps
  while (!hn::AllFalse(d, more)) {
    F end = hn::Min(hn::Min(hn::Add(at, step), one), lighting.next_kink(first, last, at));
    F to = hn::IfThenElse(hn::Ge(end, one), way.back, Lighting::mixed(way.front, way.back, end));
    const M fine = hn::And(more, finest(hn::Sub(end, at)));
    const bool any_fine = !hn::AllFalse(d, fine);
    const F share = any_fine ? end_at_knot(medium, at, from, slice, fine, end, to) : hn::Sub(end, at);
    const Surface m = lighting.between(first, last, hn::Mul(half, hn::Add(at, end)));
    // Its ends are lit as what lies between them: kinks lie in no part.
    const M side = hn::Gt(m.along, zero);
    if (!hn::AllFalse(d, hn::And(more, hn::Or(hn::Xor(side, turned), hn::Ne(m.facing, facing))))) {
      a = lighting.straight(first, last, at);
      lighting.shine_beside(a, m);
      turned = side, facing = m.facing;
    }
    Surface b = lighting.straight(first, last, end);
    lighting.shine_beside(b, m);
    const F length = hn::Mul(way.length, share);
    LinePart p = means<Ask::moment>(medium, from, to, slice(from), slice(to), more);
    const M good = hn::Or(fine, fair(p, length, sum.pass, a, m, b));
    if (any_fine) without_order(fine, p);
    behind_lit(p, length, hn::And(more, good), a.shine, m.shine, b.shine, sum);
    a = chosen(good, b, a);
    at = hn::IfThenElse(good, end, at), from = hn::IfThenElse(good, to, from);
    step = hn::IfThenElse(good, hn::Add(step, step), hn::Mul(half, hn::Sub(end, at)));
    more = hn::And(more, hn::And(hn::Lt(at, one), hn::Ge(sum.pass, hn::Set(d, stop_below))));
  }
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
