// SPDX-License-Identifier: Apache-2.0
// The walk of 16 rays through tetrahedra, and what they gather (no fused multiply-add: the same bits everywhere).
#include "render/volume/cells/project.h"
#include "render/volume/cells/tet_walk.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/volume/cells/tet_rays_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, TetPacket::lanes>;
using DI = hn::RebindToSigned<D>;
using F = hn::Vec<D>;
using I = hn::Vec<DI>;
using M = hn::Mask<D>;

HWY_ATTR inline F turn(F ax, F ay, F bx, F by) { return hn::Sub(hn::Mul(ax, by), hn::Mul(ay, bx)); }
HWY_ATTR inline M to_float(hn::Mask<DI> m) { return hn::RebindMask(D(), m); }
HWY_ATTR inline hn::Mask<DI> to_int(M m) { return hn::RebindMask(DI(), m); }

struct Faded {
  F alpha, ratio, hidden;
};

/// Of an optical depth x >= 0: alpha = 1 - exp(-x), alpha / x, and hidden = alpha / 2 - alpha / x + exp(-x).
HWY_ATTR inline Faded fade(F x) {
  const D d;
  // Below 1/2 by their series, which lose nothing for small x; else exp by powers of two.
  const auto term = [&](F sum, float c) HWY_ATTR { return hn::Sub(hn::Set(d, c), hn::Mul(sum, x)); };
  F ratio = hn::Set(d, 1.0f / 5040);
  ratio = term(ratio, 1.0f / 720), ratio = term(ratio, 1.0f / 120), ratio = term(ratio, 1.0f / 24), ratio = term(ratio, 1.0f / 6);
  ratio = term(ratio, 0.5f), ratio = term(ratio, 1.0f);
  F hidden = hn::Set(d, 1.0f / 80);
  hidden = term(hidden, 1.0f / 24), hidden = hn::Mul(hn::Mul(term(hidden, 1.0f / 12), x), x);
  Faded r{hn::Mul(ratio, x), ratio, hidden};
  const M large = hn::Gt(x, hn::Set(d, 0.5f));
  if (hn::AllFalse(d, large)) return r;
  const DI di;
  const F one = hn::Set(d, 1.0f), y = hn::Mul(hn::Min(x, hn::Set(d, 87.0f)), hn::Set(d, 1.44269504f));
  const I whole = hn::ConvertTo(di, y);
  const F f = hn::Mul(hn::Sub(y, hn::ConvertTo(d, whole)), hn::Set(d, 0.69314718f));  // exp(-x) = 2^-whole exp(-f), 0 <= f < 0.7
  F e = hn::Set(d, 1.0f / 5040);
  for (float c : {1.0f / 720, 1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f}) e = hn::Sub(hn::Set(d, c), hn::Mul(e, f));
  const F pass = hn::Mul(e, hn::BitCast(d, hn::ShiftLeft<23>(hn::Sub(hn::Set(di, 127), whole))));
  const F alpha = hn::Sub(one, pass), share = hn::Div(alpha, hn::IfThenElse(large, x, one));
  r.alpha = hn::IfThenElse(large, alpha, r.alpha), r.ratio = hn::IfThenElse(large, share, r.ratio);
  r.hidden = hn::IfThenElse(large, hn::Add(hn::Sub(hn::Mul(alpha, hn::Set(d, 0.5f)), share), pass), r.hidden);
  return r;
}

struct Colors {
  F r, g, b, pass;
};

/// The means of tau and of tau times colour over part of one line of the medium, and the colours at its ends.
struct LinePart {
  F tau, r, g, b, front[3], back[3];
};

HWY_ATTR inline F column(const TetMedium& m, I line, int k) {
  constexpr int stride = int(sizeof(TetMedium::Interval) / 4);
  static_assert(stride == 16);
  return hn::GatherIndex(D(), reinterpret_cast<const float*>(m.intervals.data()) + k, hn::ShiftLeft<4>(line));
}

HWY_ATTR inline LinePart part_of_line(const TetMedium& m, I line, F lo, F from, F to) {
  const D d;
  const F x0 = hn::Sub(from, lo), x1 = hn::Sub(to, lo), middle = hn::Mul(hn::Set(d, 0.5f), hn::Add(x0, x1)), width = hn::Sub(to, from);
  const F per_tau = column(m, line, 6), bend = hn::Mul(hn::Mul(hn::Mul(width, width), per_tau), hn::Set(d, 1.0f / 12));
  LinePart p;
  p.tau = hn::Max(hn::Add(column(m, line, 2), hn::Mul(per_tau, middle)), hn::Zero(d));
  F* const mean[3] = {&p.r, &p.g, &p.b};
  for (int k = 0; k < 3; ++k) {
    const F c = column(m, line, 3 + k), slope = column(m, line, 7 + k);
    p.front[k] = hn::Add(c, hn::Mul(slope, x0)), p.back[k] = hn::Add(c, hn::Mul(slope, x1));
    *mean[k] = hn::Add(hn::Mul(p.tau, hn::Add(c, hn::Mul(slope, middle))), hn::Mul(slope, bend));
  }
  return p;
}

/// Slices of the value.
struct Slice {
  const TetMedium& m;
  HWY_ATTR I operator()(F f) const {
    const D d;
    const DI di;
    const F at = hn::Mul(hn::Sub(f, hn::Set(d, m.slice_lo)), hn::Set(d, m.per_slice)), most = hn::Set(d, 1e6f);
    const I s = hn::Add(hn::ConvertTo(di, hn::Min(hn::Max(at, hn::Set(d, -1.0f)), most)), hn::Set(di, 1));
    const I last = hn::Set(di, int32_t(m.first.size()) - 1);
    return hn::Min(hn::IfThenElse(to_int(hn::Lt(at, hn::Zero(d))), hn::Zero(di), s), last);
  }
  /// Is there anything to see between two slices?
  HWY_ATTR M lit(I a, I b) const {
    const DI di;
    const I seen = hn::Sub(hn::GatherIndex(di, m.seen.data() + 1, hn::Max(a, b)), hn::GatherIndex(di, m.seen.data(), hn::Min(a, b)));
    return to_float(hn::Gt(seen, hn::Zero(di)));
  }
};

/// The line that a value belongs to when the field comes from (or goes to) higher values: a knot belongs to the side of the field.
HWY_ATTR inline I line_of(const TetMedium& m, F f, I slice, M above, M on, F& lo, F& hi) {
  const DI di;
  I at = hn::GatherIndex(di, m.first.data(), slice);
  for (;;) {
    hi = column(m, at, 1);
    const M past = hn::And(on, hn::Or(hn::Gt(f, hi), hn::And(above, hn::Eq(f, hi))));
    if (hn::AllFalse(D(), past)) break;
    at = hn::IfThenElse(to_int(past), hn::Add(at, hn::Set(di, 1)), at);
  }
  lo = column(m, at, 0);
  return at;
}

/// Means over the field from f0 to f1.
HWY_ATTR inline LinePart means(const TetMedium& m, F f0, F f1, I slice0, I slice1, M on) {
  const D d;
  const DI di;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const F change = hn::Sub(f1, f0);
  const M down = hn::Lt(change, zero), up = hn::Gt(change, zero);
  F lo0, hi0, lo1, hi1;
  const I line0 = line_of(m, f0, slice0, hn::Not(down), on, lo0, hi0);
  const I line1 = line_of(m, f1, slice1, hn::Not(up), on, lo1, hi1);
  const M same = hn::Or(hn::Or(hn::Not(on), hn::Not(hn::Or(up, down))), to_float(hn::Eq(line0, line1)));
  if (hn::AllTrue(d, same)) return part_of_line(m, line0, lo0, f0, f1);

  // To the end of the first line, over whole lines, and from the beginning of the last one.
  const F leave = hn::IfThenElse(same, f1, hn::IfThenElse(up, hi0, lo0)), enter = hn::IfThenElse(up, lo1, hi1);
  LinePart a = part_of_line(m, line0, lo0, f0, leave);
  const LinePart b = part_of_line(m, line1, lo1, enter, f1);
  const F per = hn::Div(one, hn::IfThenElse(same, one, change));
  const F share0 = hn::IfThenElse(same, one, hn::Mul(hn::Sub(leave, f0), per));
  const F share1 = hn::IfThenElseZero(hn::Not(same), hn::Mul(hn::Sub(f1, enter), per));
  // Sums stand for the lines before a line: up they are those before line1 less those before line0 + 1, down the other way round.
  const I first = hn::IfThenElse(to_int(up), hn::Add(line0, hn::Set(di, 1)), line0);
  const I last = hn::IfThenElse(to_int(up), line1, hn::Add(line1, hn::Set(di, 1)));
  const M more = hn::AndNot(same, to_float(hn::Ne(first, last)));
  const bool any = !hn::AllFalse(d, more);
  const auto total = [&](F x, F y, int k) HWY_ATTR {
    F sum = hn::Add(hn::Mul(share0, x), hn::IfThenElseZero(hn::Not(same), hn::Mul(share1, y)));
    if (any) {
      const F whole = hn::Sub(column(m, last, k), column(m, first, k));
      sum = hn::Add(sum, hn::IfThenElseZero(more, hn::Mul(whole, per)));
    }
    return sum;
  };
  LinePart r;
  r.tau = total(a.tau, b.tau, 10), r.r = total(a.r, b.r, 11), r.g = total(a.g, b.g, 12), r.b = total(a.b, b.b, 13);
  for (int k = 0; k < 3; ++k) r.front[k] = a.front[k], r.back[k] = hn::IfThenElse(same, a.back[k], b.back[k]);
  return r;
}

/// Light on a segment: a factor of its colour, and white on top of it.
struct Shine {
  F diffuse, specular;
};

/// Puts one segment behind what is there: C = mean alpha - change hidden, exact for constant tau.
HWY_ATTR inline void behind(const LinePart& p, F length, M on, const Shine* shine, Colors& sum) {
  const D d;
  const F depth = hn::Mul(p.tau, length);
  const M lit = hn::And(on, hn::Gt(depth, hn::Zero(d)));
  const Faded f = fade(hn::IfThenElseZero(lit, depth));
  const F share = hn::IfThenElseZero(lit, sum.pass), gain = hn::Mul(hn::Mul(share, f.ratio), length), loss = hn::Mul(share, f.hidden);
  F* const to[3] = {&sum.r, &sum.g, &sum.b};
  const F* const mean[3] = {&p.r, &p.g, &p.b};
  for (int k = 0; k < 3; ++k) {
    F c = hn::Sub(hn::Mul(gain, *mean[k]), hn::Mul(loss, hn::Sub(p.back[k], p.front[k])));
    if (shine) c = hn::Add(hn::Mul(c, shine->diffuse), hn::Mul(hn::Mul(share, f.alpha), shine->specular));
    *to[k] = hn::Add(*to[k], c);
  }
  sum.pass = hn::Sub(sum.pass, hn::Mul(share, f.alpha));
}

/// The field goes from f0 to f1 over `length` in the lanes of `on`.
HWY_ATTR inline void gather(const TetMedium& m, F f0, F f1, F length, I slice0, I slice1, const Slice& slice, M on, const Shine* shine,
                            Colors& sum) {
  const D d;
  const LinePart all = means(m, f0, f1, slice0, slice1, on);
  // Deep segments in parts, so that the order of colours within them counts.
  F bend = hn::Set(d, 1.0f / 256);
  for (int k = 0; k < 3; ++k) bend = hn::Max(bend, hn::Abs(hn::Sub(all.back[k], all.front[k])));
  const F fine = hn::Mul(hn::Set(d, m.fine), hn::Sqrt(bend));
  const F parts = hn::Min(hn::Ceil(hn::Mul(hn::Mul(all.tau, length), fine)), hn::Set(d, float(TetMedium::most_parts)));
  const M deep = hn::And(on, hn::And(hn::Gt(parts, hn::Set(d, 1.0f)), hn::Ne(f0, f1)));
  behind(all, length, hn::AndNot(deep, on), shine, sum);
  if (hn::AllFalse(d, deep)) return;
  const F per = hn::Div(hn::Set(d, 1.0f), hn::Max(parts, hn::Set(d, 1.0f))), step = hn::Mul(hn::Sub(f1, f0), per);
  F from = f0, number = hn::Set(d, 1.0f);
  for (M more = deep; !hn::AllFalse(d, more);) {
    const M last = hn::Ge(number, parts);
    const F to = hn::IfThenElse(last, f1, hn::Add(f0, hn::Mul(step, number)));
    behind(means(m, from, to, slice(from), slice(to), more), hn::Mul(length, per), more, shine, sum);
    more = hn::AndNot(last, more), from = to, number = hn::Add(number, hn::Set(d, 1.0f));
  }
}

/// light_at for the lanes of `on`; the light falls on both sides of the gradient.
HWY_ATTR inline Shine shine_at(const TetLight& light, const F g[3], const F direction[3], M on) {
  const D d;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const auto dot = [](const F a[3], const F b[3])
                       HWY_ATTR { return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2])); };
  const F square = dot(g, g);
  const M bent = hn::And(on, hn::And(hn::Gt(square, zero), hn::Lt(square, hn::Set(d, 1e30f))));
  const F size = hn::Sqrt(hn::IfThenElse(bent, square, one));
  const F surface = hn::Min(one, hn::Mul(size, hn::Set(d, light.edge_per_scale)));
  const F side = hn::Div(hn::IfThenElse(hn::Gt(dot(g, direction), zero), hn::Set(d, -1.0f), one), size);
  F diffuse = zero, specular = zero;
  for (const TetLight::Lamp& l : light.lamps) {
    const F to[3] = {hn::Set(d, l.direction.x), hn::Set(d, l.direction.y), hn::Set(d, l.direction.z)};
    const F c = hn::Mul(side, dot(g, to)), intensity = hn::Set(d, l.intensity);
    const M faces = hn::Gt(c, zero);
    diffuse = hn::Add(diffuse, hn::IfThenElseZero(faces, hn::Mul(intensity, c)));
    const F half[3] = {hn::Sub(to[0], direction[0]), hn::Sub(to[1], direction[1]), hn::Sub(to[2], direction[2])};
    const F half2 = dot(half, half);
    const F h = hn::Div(hn::Mul(side, dot(g, half)), hn::Sqrt(hn::IfThenElse(hn::Gt(half2, zero), half2, one)));
    F base = hn::Max(h, zero), power = one;
    for (int n = light.power; n > 0; n >>= 1, base = hn::Mul(base, base))
      if (n & 1) power = hn::Mul(power, base);
    specular = hn::Add(specular, hn::IfThenElseZero(faces, hn::Mul(intensity, power)));
  }
  const F factor = hn::Sub(hn::Add(hn::Set(d, light.ambient), hn::Mul(hn::Set(d, light.diffuse), diffuse)), one);
  return {hn::IfThenElse(bent, hn::Add(one, hn::Mul(surface, factor)), one),
          hn::IfThenElseZero(bent, hn::Mul(surface, hn::Mul(hn::Set(d, light.specular), specular)))};
}

struct Corner {
  F x, y, z, f;
  I id;
};

/// Where two products were equal: as TetWalk decides it.
HWY_NOINLINE HWY_ATTR M decide(F ax, F ay, F bx, F by, M found, M unsure) {
  const D d;
  const DI di;
  alignas(64) float a[2][TetPacket::lanes], b[2][TetPacket::lanes];
  alignas(64) int32_t yes[TetPacket::lanes], ask[TetPacket::lanes];
  hn::Store(ax, d, a[0]), hn::Store(ay, d, a[1]), hn::Store(bx, d, b[0]), hn::Store(by, d, b[1]);
  hn::Store(hn::VecFromMask(di, to_int(found)), di, yes), hn::Store(hn::VecFromMask(di, to_int(unsure)), di, ask);
  for (size_t i = 0; i < hn::Lanes(d); ++i)
    if (ask[i]) yes[i] = turns_left(double(a[0][i]), double(a[1][i]), double(b[0][i]), double(b[1][i])) ? -1 : 0;
  return to_float(hn::MaskFromVec(hn::Load(di, yes)));
}

HWY_ATTR inline M left(const Corner& a, const Corner& b) {
  const F p = hn::Mul(a.x, b.y), q = hn::Mul(a.y, b.x);
  const M equal = hn::Eq(p, q), found = hn::Gt(p, q);
  if (hn::AllFalse(D(), equal)) return found;
  return decide(a.x, a.y, b.x, b.y, found, equal);
}

HWY_ATTR inline Corner chosen(M yes, const Corner& a, const Corner& b) {
  return {hn::IfThenElse(yes, a.x, b.x), hn::IfThenElse(yes, a.y, b.y), hn::IfThenElse(yes, a.z, b.z), hn::IfThenElse(yes, a.f, b.f),
          hn::IfThenElse(to_int(yes), a.id, b.id)};
}

/// The lanes from `lane` on, as many as a vector has.
HWY_ATTR void walk_lanes(const TetTables& tables, TetPacket& p, size_t lane) {
  const D d;
  const DI di;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const F x0 = hn::Load(d, p.x0 + lane), y0 = hn::Load(d, p.y0 + lane), dx = hn::Load(d, p.dx + lane), dy = hn::Load(d, p.dy + lane);
  const F length = hn::Load(d, p.length + lane), limit = hn::Load(d, p.limit + lane);
  F done = hn::Load(d, p.done + lane), half = hn::Load(d, p.half + lane);
  I tet = hn::Load(di, p.tet + lane), end_tet = hn::Set(di, -1), end_gone = hn::Zero(di);
  Colors sum{hn::Load(d, p.r + lane), hn::Load(d, p.g + lane), hn::Load(d, p.b + lane), hn::Load(d, p.pass + lane)};
  const auto* links = reinterpret_cast<const int32_t*>(tables.links);
  const TetMedium& medium = *tables.medium;

  const auto corner = [&](I id) HWY_ATTR {
    const I at = hn::ShiftLeft<2>(id);
    const F z = hn::GatherIndex(d, tables.eye + 2, at);
    return Corner{hn::Sub(hn::Sub(hn::GatherIndex(d, tables.eye, at), x0), hn::Mul(dx, z)),
                  hn::Sub(hn::Sub(hn::GatherIndex(d, tables.eye + 1, at), y0), hn::Mul(dy, z)), z, hn::GatherIndex(d, tables.eye + 3, at),
                  id};
  };
  F weight[3];  // of a, b, c where the line crosses their face
  const auto cross_at = [&](const Corner& a, const Corner& b, const Corner& c, F& f) HWY_ATTR {
    const F wa = hn::Max(turn(b.x, b.y, c.x, c.y), zero), wb = hn::Max(turn(c.x, c.y, a.x, a.y), zero);
    const F wc = hn::Max(turn(a.x, a.y, b.x, b.y), zero), all = hn::Add(hn::Add(wa, wb), wc);
    const M some = hn::Gt(all, hn::Set(d, 1e-37f));
    const F per = hn::Div(one, hn::IfThenElse(some, all, one)), third = hn::Set(d, 1.0f / 3);
    const F u = hn::IfThenElse(some, hn::Mul(wa, per), third), v = hn::IfThenElse(some, hn::Mul(wb, per), third);
    const F w = hn::IfThenElse(some, hn::Mul(wc, per), third);
    weight[0] = u, weight[1] = v, weight[2] = w;
    f = hn::Add(hn::Add(hn::Mul(u, a.f), hn::Mul(v, b.f)), hn::Mul(w, c.f));
    return hn::Add(hn::Add(hn::Mul(u, a.z), hn::Mul(v, b.z)), hn::Mul(w, c.z));
  };
  const Slice slice{medium};
  // The light at the face behind, in the lanes that have asked for it.
  const TetLight* light = tables.light;
  const F direction[3] = {hn::Load(d, p.direction[0] + lane), hn::Load(d, p.direction[1] + lane), hn::Load(d, p.direction[2] + lane)};
  Shine before{one, zero};
  M known_before = hn::Lt(one, zero);

  Corner a = corner(hn::Load(di, p.id[0] + lane)), b = corner(hn::Load(di, p.id[1] + lane)), c = corner(hn::Load(di, p.id[2] + lane));
  F f, z = cross_at(a, b, c, f);
  M on = hn::Not(to_float(hn::Lt(tet, hn::Zero(di))));
  while (!hn::AllFalse(d, on)) {
    // The fourth corner, and the one that is left behind for it.
    const I link = hn::IfThenElseZero(to_int(on), hn::Add(hn::ShiftLeft<2>(tet), tet));
    const I known = hn::Xor(hn::Xor(a.id, b.id), c.id);
    const I fourth = hn::IfThenElse(to_int(on), hn::Xor(hn::GatherIndex(di, links, link), known), a.id);
    const Corner e = corner(fourth);
    const M la = left(e, a), lb = left(e, b), lc = left(e, c);
    const M no_c = hn::AndNot(lb, la), no_b = hn::And(hn::AndNot(la, lc), hn::Not(no_c));
    const I gone = hn::IfThenElse(to_int(no_c), c.id, hn::IfThenElse(to_int(no_b), b.id, a.id));
    const auto less = [&](I id) HWY_ATTR { return hn::VecFromMask(di, hn::Lt(id, gone)); };
    const I rank = hn::Neg(hn::Add(hn::Add(less(a.id), less(b.id)), hn::Add(less(c.id), less(e.id))));
    const I next = hn::GatherIndex(di, links + 1, hn::Add(link, rank));
    c = chosen(no_c, e, c), b = chosen(no_b, e, b), a = chosen(hn::Or(no_c, no_b), a, e);
    F f1;
    const F z1 = cross_at(a, b, c, f1);

    // What lies between, cut to what is not drawn yet and not hidden.
    const F from = hn::Max(z, done), to = hn::Min(z1, limit);
    const M some = hn::And(on, hn::Gt(to, from));
    F g0 = f, g1 = f1;
    if (tables.cell_values) {
      const I index = hn::IfThenElseZero(to_int(on), tet);
      g0 = g1 = hn::GatherIndex(d, tables.cell_values,
                                tables.cells ? hn::GatherIndex(di, reinterpret_cast<const int32_t*>(tables.cells), index) : index);
    } else if (!hn::AllTrue(d, hn::Or(hn::Not(some), hn::And(hn::Eq(from, z), hn::Eq(to, z1))))) {
      const F per = hn::Div(hn::Sub(f1, f), hn::IfThenElse(some, hn::Sub(z1, z), one));
      g0 = hn::IfThenElse(hn::Eq(from, z), f, hn::Add(f, hn::Mul(hn::Sub(from, z), per)));
      g1 = hn::IfThenElse(hn::Eq(to, z1), f1, hn::Add(f, hn::Mul(hn::Sub(to, z), per)));
    }
    const I slice0 = slice(g0), slice1 = slice(g1);
    const M lit = hn::And(some, slice.lit(slice0, slice1));
    if (!hn::AllFalse(d, lit)) {
      Shine shine{one, zero};
      if (light) {
        // The mean of the light on the two faces; in front of the first segment of a row there is none yet.
        F g[3];
        const I of[3] = {hn::Add(hn::ShiftLeft<1>(a.id), a.id), hn::Add(hn::ShiftLeft<1>(b.id), b.id),
                         hn::Add(hn::ShiftLeft<1>(c.id), c.id)};
        for (int k = 0; k < 3; ++k) {
          g[k] = zero;
          for (int v = 0; v < 3; ++v) g[k] = hn::Add(g[k], hn::Mul(weight[v], hn::GatherIndex(d, light->gradients + k, of[v])));
        }
        const Shine here = shine_at(*light, g, direction, lit);
        const F half_of = hn::Set(d, 0.5f);
        shine.diffuse = hn::IfThenElse(known_before, hn::Mul(half_of, hn::Add(before.diffuse, here.diffuse)), here.diffuse);
        shine.specular = hn::IfThenElse(known_before, hn::Mul(half_of, hn::Add(before.specular, here.specular)), here.specular);
        before = here;
      }
      gather(medium, g0, g1, hn::Mul(hn::Sub(to, from), length), slice0, slice1, slice, lit, light ? &shine : nullptr, sum);
      const M now = hn::And(hn::And(lit, hn::Lt(sum.pass, hn::Set(d, 0.5f))), hn::IsNaN(half));
      half = hn::IfThenElse(now, to, half);
    }
    known_before = lit;
    done = hn::IfThenElse(some, to, done);
    z = z1, f = f1;

    const M left_mesh = hn::And(on, to_float(hn::Lt(next, hn::Zero(di))));
    end_tet = hn::IfThenElse(to_int(left_mesh), tet, end_tet), end_gone = hn::IfThenElse(to_int(left_mesh), gone, end_gone);
    tet = next;
    on = hn::And(hn::AndNot(left_mesh, on), hn::And(hn::Lt(done, limit), hn::Ge(sum.pass, hn::Set(d, tables.stop_below))));
  }
  hn::Store(done, d, p.done + lane), hn::Store(half, d, p.half + lane);
  hn::Store(end_tet, di, p.last + lane), hn::Store(end_gone, di, p.gone + lane);
  hn::Store(sum.r, d, p.r + lane), hn::Store(sum.g, d, p.g + lane), hn::Store(sum.b, d, p.b + lane), hn::Store(sum.pass, d, p.pass + lane);
}

HWY_ATTR void walk(const TetTables& tables, TetPacket& packet) {
  for (size_t lane = 0; lane < size_t(TetPacket::lanes); lane += hn::Lanes(D())) walk_lanes(tables, packet, lane);
}

HWY_ATTR void put(const TetMedium& medium, SegmentPacket& p) {
  const D d;
  const Slice slice{medium};
  for (size_t lane = 0; lane < size_t(SegmentPacket::lanes); lane += hn::Lanes(d)) {
    const F length = hn::Load(d, p.length + lane), f0 = hn::Load(d, p.front + lane), f1 = hn::Load(d, p.back + lane);
    const I slice0 = slice(f0), slice1 = slice(f1);
    const M lit = hn::And(hn::Gt(length, hn::Zero(d)), slice.lit(slice0, slice1));
    if (hn::AllFalse(d, lit)) continue;
    Colors sum{hn::Load(d, p.r + lane), hn::Load(d, p.g + lane), hn::Load(d, p.b + lane), hn::Load(d, p.pass + lane)};
    gather(medium, f0, f1, length, slice0, slice1, slice, lit, nullptr, sum);
    hn::Store(sum.r, d, p.r + lane), hn::Store(sum.g, d, p.g + lane), hn::Store(sum.b, d, p.b + lane),
        hn::Store(sum.pass, d, p.pass + lane);
  }
}

HWY_ATTR uint32_t cut(const ColumnTet& t, const float y[4], RowCut& out) {
  const D d;
  constexpr int faces[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
  uint32_t bits = 0;
  for (size_t lane = 0; lane < size_t(ColumnTet::lanes); lane += hn::Lanes(d)) {
    Corner v[4];
    for (int k = 0; k < 4; ++k) v[k].x = hn::Load(d, t.x[k] + lane), v[k].y = hn::Set(d, y[k]);
    M left_of[4][4];
    F size[4][4];
    for (int a = 0; a < 4; ++a)
      for (int b = a + 1; b < 4; ++b) {
        left_of[a][b] = left(v[a], v[b]);
        size[a][b] = hn::Abs(turn(v[a].x, v[a].y, v[b].x, v[b].y));
      }
    F enter = hn::Set(d, 1e30f), leave = hn::Set(d, -1e30f), front = hn::Zero(d), back = hn::Zero(d);
    M any = hn::Lt(enter, leave);
    for (const auto& [a, b, c] : faces) {
      const M ab = left_of[a][b], bc = left_of[b][c], ac = left_of[a][c];
      const M in = hn::Or(hn::AndNot(ac, hn::And(ab, bc)), hn::And(ac, hn::Not(hn::Or(ab, bc))));
      if (hn::AllFalse(d, in)) continue;
      const F all = hn::Add(hn::Add(size[b][c], size[a][c]), size[a][b]);
      const M some = hn::Gt(all, hn::Set(d, 1e-37f));
      const F per = hn::Div(hn::Set(d, 1.0f), hn::IfThenElse(some, all, hn::Set(d, 1.0f))), third = hn::Set(d, 1.0f / 3);
      const F wa = hn::IfThenElse(some, hn::Mul(size[b][c], per), third), wb = hn::IfThenElse(some, hn::Mul(size[a][c], per), third);
      const F wc = hn::IfThenElse(some, hn::Mul(size[a][b], per), third);
      const auto mix = [&](const float* q) HWY_ATTR {
        return hn::Add(hn::Add(hn::Mul(wa, hn::Set(d, q[a])), hn::Mul(wb, hn::Set(d, q[b]))), hn::Mul(wc, hn::Set(d, q[c])));
      };
      const F z = mix(t.z), f = mix(t.f);
      const M nearer = hn::And(in, hn::Lt(z, enter)), farther = hn::And(in, hn::Gt(z, leave));
      enter = hn::IfThenElse(nearer, z, enter), front = hn::IfThenElse(nearer, f, front);
      leave = hn::IfThenElse(farther, z, leave), back = hn::IfThenElse(farther, f, back);
      any = hn::Or(any, in);
    }
    if (hn::AllFalse(d, any)) continue;
    hn::Store(enter, d, out.enter + lane), hn::Store(leave, d, out.leave + lane);
    hn::Store(front, d, out.front + lane), hn::Store(back, d, out.back + lane);
    uint8_t mask[8] = {};
    hn::StoreMaskBits(d, any, mask);
    bits |= (uint32_t(mask[0]) | uint32_t(mask[1]) << 8) << lane;
  }
  return bits;
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {
HWY_EXPORT(walk);
HWY_EXPORT(put);
HWY_EXPORT(cut);
void walk_tets(const TetTables& tables, TetPacket& packet) { HWY_DYNAMIC_DISPATCH(walk)(tables, packet); }
void put_segments(const TetMedium& medium, SegmentPacket& packet) { HWY_DYNAMIC_DISPATCH(put)(medium, packet); }
uint32_t cut_row(const ColumnTet& tet, const float y[4], RowCut& out) { return HWY_DYNAMIC_DISPATCH(cut)(tet, y, out); }
}  // namespace sg::volume
#endif
