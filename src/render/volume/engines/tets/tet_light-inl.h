// SPDX-License-Identifier: Apache-2.0
// Light in the tetrahedra that the lanes of a packet cross: the gradient is linear in each, so that the normal turns in one plane and in
// one direction, and the point where the surface turns over is known.
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
HWY_ATTR inline F apart(const Shine& a, const Shine& b) { return abs(a.diffuse - b.diffuse) + abs(a.specular - b.specular); }
HWY_ATTR inline Shine chosen(M yes, const Shine& a, const Shine& b) {
  return {select(yes, a.diffuse, b.diffuse), select(yes, a.specular, b.specular)};
}

/// The gradient at a place, and the light on it seen from the side of the viewer.
struct Surface {
  F gradient[3], along;  ///< world; its product with the ray's direction
  F per_size, weight;    ///< 1 / its length; of the surface, 0 to 1
  F nearest;             ///< the cosine to the nearest middle of a highlight
  F facing;              ///< which lamps it faces, as a sum of powers of two
  Shine shine;
};
HWY_ATTR inline Surface chosen(M yes, const Surface& a, const Surface& b) {
  Surface r;
  for (int k = 0; k < 3; ++k) r.gradient[k] = select(yes, a.gradient[k], b.gradient[k]);
  r.along = select(yes, a.along, b.along), r.per_size = select(yes, a.per_size, b.per_size);
  r.weight = select(yes, a.weight, b.weight), r.nearest = select(yes, a.nearest, b.nearest);
  r.facing = select(yes, a.facing, b.facing);
  r.shine = chosen(yes, a.shine, b.shine);
  return r;
}

HWY_ATTR inline F dot(const F a[3], const F b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

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
    for (int k = 0; k < 3; ++k) s.gradient[k] = set(D(), 0);
    for (int v = 0; v < 3; ++v) {
      const I of = shift_left<1>(id[v]) + id[v];
      for (int k = 0; k < 3; ++k) s.gradient[k] = s.gradient[k] + weight[v] * hn::GatherIndex(D(), light.gradients + k, of);
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
  /// The one-sided limit of the light, from the side of another point that is lit already: at a kink, where rounding cannot decide.
  HWY_ATTR void shine_beside(Surface& s, const Surface& other) const { shine<true>(s, other.along, other); }

  /// `like` tells which lamps it faces.
  template <bool beside>
  HWY_ATTR void shine(Surface& s, F along, const Surface& like) const {
    const D d;
    const F zero = set(d, 0), one = set(d, 1.0f);
    const F square = dot(s.gradient, s.gradient);
    const M bent = (square > zero) & (square < 1e30f);
    const F size = sqrt(select(bent, square, one));
    s.weight = only(bent, min(one, size * light.edge_per_scale));
    s.per_size = only(bent, one / size);
    const M far = along > zero;
    const F side = select(far, -s.per_size, s.per_size);
    F side_there = side;
    if constexpr (beside) side_there = select(far, -like.per_size, like.per_size);
    F diffuse = zero, specular = zero;
    s.nearest = s.facing = zero;
    float number = 1;
    for (size_t n = 0; n < light.lamps.size(); ++n) {
      const Lamp& l = light.lamps[n];
      const Vec3f direction(l.direction);
      const F to[3] = {set(d, direction.x), set(d, direction.y), set(d, direction.z)};
      F c = side * dot(s.gradient, to);
      const F intensity = set(d, l.intensity);
      if constexpr (beside) {
        // A lamp that reaches the other point shines here too, in the limit.
        const M faces = side_there * dot(like.gradient, to) > zero;
        c = select(faces, max(c, 1e-30f), zero);
      }
      F other[3];
      if (n >= ready) half_way_to(n, other);
      const F h = side * dot(s.gradient, n < ready ? half_[n] : other);
      const auto terms = shading::HWY_NAMESPACE::lamp_terms(c, h, power_);
      s.nearest = max(s.nearest, h);
      s.facing = s.facing + only(terms.reached, set(d, number));
      number *= 2;
      diffuse = diffuse + intensity * terms.diffuse;
      specular = specular + intensity * terms.specular;
    }
    const Material& m = light.material;
    const F factor = m.ambient + m.diffuse * diffuse - one;
    s.shine = {one + s.weight * factor, s.weight * (m.specular * specular)};
  }

  /// Error of a straight line between the light at two points, if no lamp begins or ceases to shine and the surface does not turn over; and
  /// of a parabola through the middle. Estimates.
  struct Bend {
    F line, parabola;
  };
  HWY_ATTR Bend may_bend(const Surface& a, const Surface& b) const {
    const D d;
    const F zero = set(d, 0), one = set(d, 1.0f);
    const F cosine = dot(a.gradient, b.gradient) * a.per_size * b.per_size;
    // No surface at one end: there all of it counts.
    const F turn = only(max(a.per_size, b.per_size) > zero, max(zero, one - cosine));
    // The second derivative of a highlight at this angle beside its middle (see integrate.cpp), from above without an exponential.
    const F away = sqrt(max(zero, one - max(a.nearest, b.nearest)));
    const F closest = max(zero, away - 0.5f * sqrt(turn));
    const F power = set(d, light.material.power), x = power * (closest * closest);
    const F lobe = power * (1.5f / (one + 0.25f * (x * x)));
    const F second = light.material.diffuse + light.material.specular * lobe;
    const F bend = turn * second * (all_ / 12);
    // The amount of surface has a kink where it reaches 1.
    const F fades = 0.25f * abs(a.weight - b.weight);
    // The sum of a short gradient and a long one turns with the long one: where it is, light has changed by the share s r / (1 - s + s r)
    // at the share s of the way, r = (1 + f) / (1 - f) the ratio of their lengths. In the mean that is off the line by f (1/3 + f^2 / 6) at
    // most, and off the parabola by f^3 (1/15 + f^2 / 10).
    const F sizes = a.per_size + b.per_size;
    const F ratio = abs(a.per_size - b.per_size) / select(sizes > zero, sizes, one);
    const F square = ratio * ratio, early = apart(a.shine, b.shine) * ratio;
    const F line = early * (1.0f / 3 + square * (1.0f / 6));
    const F parabola = early * square * (1.0f / 15 + square * 0.1f);
    return {bend + line + fades, bend * turn * (0.1f * (one + lobe)) + parabola + fades};
  }

  /// The next place beyond `at` where the surface turns over, or a lamp begins or ceases to shine on it; 2 when there is none.
  HWY_ATTR F next_kink(const Surface& a, const Surface& b, F at) const {
    const D d;
    F next = set(d, 2.0f);
    const auto look = [&](F x, F y) HWY_ATTR {
      const F fall = x - y;
      const M some = (x * y <= 0) & (fall != 0);
      const F place = x / select(some, fall, 1.0f);
      next = select(some & (place > at), min(next, place), next);
    };
    look(a.along, b.along);
    for (const Lamp& l : light.lamps) {
      const Vec3f direction(l.direction);
      const F to[3] = {set(d, direction.x), set(d, direction.y), set(d, direction.z)};
      look(dot(a.gradient, to), dot(b.gradient, to));
    }
    return next;
  }

  static HWY_ATTR F mixed(F a, F b, F share) { return a + share * (b - a); }

 private:
  /// The direction half way between a lamp and the viewer; zero where there is none.
  HWY_ATTR void half_way_to(size_t lamp, F half[3]) const {
    const D d;
    const Vec3f to(light.lamps[lamp].direction);
    half[0] = to.x - direction_[0], half[1] = to.y - direction_[1];
    half[2] = to.z - direction_[2];
    const F square = dot(half, half), one = set(d, 1.0f);
    const F per = one / sqrt(select(square > 0, square, one));
    for (int k = 0; k < 3; ++k) half[k] = half[k] * per;
  }

  shading::HWY_NAMESPACE::Power power_;  ///< of highlights
  static constexpr size_t ready = 4;     ///< lamps whose half_ is stored; others are computed each time
  F direction_[3], half_[ready][3];
  float all_ = 0;
};

/// A segment: the light at its ends, the values there, and its length.
struct LitWay {
  Surface first, last;
  F front, back, length;
};

/// The same for a part on which the light is as good as a parabola through a, m (in the middle) and b.
HWY_ATTR inline void behind_lit(const LinePart& p, F length, M on, const Shine& a, const Shine& m, const Shine& b, Colors& sum) {
  const D d;
  const F zero = set(d, 0), one = set(d, 1.0f);
  const F depth = p.tau * length;
  const M lit = on & (depth > zero);
  const Faded f = fade(only(lit, depth));
  // Where on the segment the light that is seen comes from: its mean position (the front hides what is behind), and its spread where tau is
  // constant (near 1/12 - 1/240 D^2 for thin parts, 1 / D^2 for deep ones).
  const F alpha = select(lit, f.alpha, one);
  const F centre = p.moment / select(lit, p.tau, one) - f.hidden / alpha;
  const F spread = (one - p.uneven) / (12.0f + 0.65f * (depth * depth));
  const F w = min(max(centre, zero), one), v = one - w, two = set(d, 2.0f);
  const F wa = v * (v - w) + two * spread, wb = w * (w - v) + two * spread;
  const F wm = one - wa - wb;
  const auto there = [&](F x, F y, F z) HWY_ATTR { return wa * x + wm * y + wb * z; };
  const F diffuse = there(a.diffuse, m.diffuse, b.diffuse), specular = there(a.specular, m.specular, b.specular);
  const F share = only(lit, sum.pass), gain = share * f.ratio * length, loss = share * f.hidden;
  const F white = share * f.alpha * specular;
  F* const to[3] = {&sum.r, &sum.g, &sum.b};
  const F* const mean[3] = {&p.r, &p.g, &p.b};
  for (int k = 0; k < 3; ++k) {
    const F c = gain * *mean[k] - loss * (p.back[k] - p.front[k]);
    *to[k] = *to[k] + (c * diffuse + white);
  }
  sum.pass = sum.pass - share * f.alpha;
}

HWY_ATTR inline Shine half_way(const Shine& a, const Shine& b) {
  const F half = set(D(), 0.5f);
  return {half * (a.diffuse + b.diffuse), half * (a.specular + b.specular)};
}

/// Whether a part may be drawn as one.
struct Fair {
  const TetMedium& medium;
  const Lighting& lighting;

  /// With light whose error is at most this.
  HWY_ATTR M operator()(const LinePart& p, F length, F pass, F off, F differ) const {
    const D d;
    const F one = set(d, 1.0f);
    const F depth = p.tau * length, change = color_change(p), weight = pass * min(depth, one);
    const F share = set(d, 0.4f * lighting.light.tolerance);
    const F allowed = share * (weight + length * lighting.light.per_ray);
    // Colour and light that both change have a product that is not straight; and the front hides what is behind, exactly so where tau is
    // constant.
    const F product = change * differ, order = (change + differ) * p.uneven * min(depth, 6.0f);
    const F wrong = off + (product + order) * (1.0f / 12);
    return weight * wrong <= allowed;
  }
  /// With the parabola through the middle.
  HWY_ATTR M operator()(const LinePart& p, F length, F pass, const Surface& a, const Surface& m, const Surface& b) const {
    const F bulge = apart(m.shine, half_way(a.shine, b.shine));
    const F unsure = 0.05f + 1.0f / 3 * p.uneven;
    return (*this)(p, length, pass, bulge * unsure + lighting.may_bend(a, b).parabola, apart(a.shine, b.shine));
  }
};

/// Composites a lit segment behind what is there, in parts as long as the tolerance allows.
HWY_ATTR inline void gather_lit(const TetMedium& medium, const Lighting& lighting, const LitWay& way, const Slice& slice, M on,
                                float stop_below, Colors& sum) {
  const D d;
  const F zero = set(d, 0), one = set(d, 1.0f), half = set(d, 0.5f);
  const Fair fair{medium, lighting};
  const LinePart all = means<Ask::moment>(medium, way.front, way.back, slice(way.front), slice(way.back), on);
  on = on & (all.tau * way.length > zero);
  const Surface &first = way.first, &last = way.last;
  // If it turns over (also at an end) or meets another lamp, its ends are not representative.
  const M smooth = (first.facing == last.facing) & (first.along * last.along > zero);
  const M straight = fair(all, way.length, sum.pass, lighting.may_bend(first, last).line, apart(first.shine, last.shine));
  M as_one = on & (smooth & straight);
  Shine middle = half_way(first.shine, last.shine);
  if (any(on & smooth & !straight)) {
    const Surface m = lighting.between(first, last, half);
    as_one = as_one | (on & smooth & fair(all, way.length, sum.pass, first, m, last));
    middle = chosen(straight, middle, m.shine);  // whatever the neighbouring lanes need
  }
  behind_lit(all, way.length, as_one, first.shine, middle, last.shine, sum);
  M more = on & !as_one;
  if (none(more)) return;

  F at = zero, step = select(smooth, half, one), from = way.front;
  Surface a = first;
  M turned = first.along > zero;  // the side on which `a` is lit
  F facing = first.facing;        // and by which lamps
  while (any(more)) {
    F end = min(min(at + step, one), lighting.next_kink(first, last, at));
    F to = select(end >= one, way.back, Lighting::mixed(way.front, way.back, end));
    const M fine = more & finest(end - at);
    const bool any_fine = any(fine);
    const F share = any_fine ? end_at_knot(medium, at, from, slice, fine, end, to) : end - at;
    const Surface m = lighting.between(first, last, half * (at + end));
    // Its ends are lit as the limit from inside: no part contains a kink.
    const M side = m.along > zero;
    if (any(more & ((side ^ turned) | (m.facing != facing)))) {
      a = lighting.straight(first, last, at);
      lighting.shine_beside(a, m);
      turned = side, facing = m.facing;
    }
    Surface b = lighting.straight(first, last, end);
    lighting.shine_beside(b, m);
    const F length = way.length * share;
    LinePart p = means<Ask::moment>(medium, from, to, slice(from), slice(to), more);
    const M good = fine | fair(p, length, sum.pass, a, m, b);
    if (any_fine) without_order(fine, p);
    behind_lit(p, length, more & good, a.shine, m.shine, b.shine, sum);
    a = chosen(good, b, a);
    at = select(good, end, at), from = select(good, to, from);
    step = select(good, step + step, half * (end - at));
    more = more & ((at < one) & (sum.pass >= stop_below));
  }
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
