// SPDX-License-Identifier: Apache-2.0
// The walk of 16 rays through tetrahedra, and what they gather (no fused multiply-add: the same bits everywhere).
#include "render/volume/cells/tet_rays.h"
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

/// 1 - exp(-x) for x >= 0.
HWY_ATTR inline F fade(F x) {
  const D d;
  // Below 1/2 the series, which loses nothing for small x; else exp by powers of two.
  const auto term = [&](F sum, float c) HWY_ATTR { return hn::Add(hn::Mul(sum, x), hn::Set(d, c)); };
  F s = hn::Set(d, 1.0f / 40320);
  s = term(hn::Neg(s), 1.0f / 5040), s = term(hn::Neg(s), 1.0f / 720), s = term(hn::Neg(s), 1.0f / 120);
  s = term(hn::Neg(s), 1.0f / 24), s = term(hn::Neg(s), 1.0f / 6), s = term(hn::Neg(s), 0.5f), s = term(hn::Neg(s), 1.0f);
  const F small = hn::Mul(s, x);
  const M large = hn::Gt(x, hn::Set(d, 0.5f));
  if (hn::AllFalse(d, large)) return small;
  const DI di;
  const F clamped = hn::Min(x, hn::Set(d, 87.0f));
  const F y = hn::Mul(clamped, hn::Set(d, 1.44269504f));
  const I whole = hn::ConvertTo(di, y);
  const F f = hn::Mul(hn::Sub(y, hn::ConvertTo(d, whole)), hn::Set(d, 0.69314718f));  // exp(-x) = 2^-whole exp(-f), 0 <= f < 0.7
  F e = hn::Set(d, 1.0f / 5040);
  for (float c : {1.0f / 720, 1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f}) e = hn::Sub(hn::Set(d, c), hn::Mul(e, f));
  const F power = hn::BitCast(d, hn::ShiftLeft<23>(hn::Sub(hn::Set(di, 127), whole)));
  return hn::IfThenElse(large, hn::Sub(hn::Set(d, 1.0f), hn::Mul(e, power)), small);
}

struct Colors {
  F r, g, b, pass;
};

/// The field goes from f0 to f1 over `length` in the lanes of `on`.
HWY_ATTR inline void gather(const TetMedium& m, F f0, F f1, F length, I slice0, M on, Colors& sum) {
  const D d;
  const DI di;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const auto* table = reinterpret_cast<const float*>(m.intervals.data());
  constexpr int stride = int(sizeof(TetMedium::Interval) / 4);
  const F change = hn::Sub(f1, f0);
  const M up = hn::Gt(change, zero), still = hn::Eq(change, zero);
  const F per_change = hn::Div(one, hn::IfThenElse(still, one, change));
  const auto column = [&](I interval, int k) HWY_ATTR { return hn::GatherIndex(d, table + k, hn::Mul(interval, hn::Set(di, stride))); };

  // The interval that is entered: a knot belongs to the one in which the field goes on.
  I at = hn::GatherIndex(di, m.first.data(), slice0);
  for (;;) {
    const F hi = column(at, 1);
    const M past = hn::And(on, hn::Or(hn::Gt(f0, hi), hn::And(hn::Not(hn::And(hn::Not(up), hn::Not(still))), hn::Eq(f0, hi))));
    if (hn::AllFalse(d, past)) break;
    at = hn::IfThenElse(to_int(past), hn::Add(at, hn::Set(di, 1)), at);
  }

  F from = f0, part = zero;
  for (;;) {
    const F lo = column(at, 0), hi = column(at, 1);
    const F ahead = hn::IfThenElse(up, hn::Min(f1, hi), hn::Max(f1, lo));
    const M last = hn::Eq(ahead, f1);
    const F end = hn::IfThenElse(last, one, hn::Mul(hn::Sub(ahead, f0), per_change));
    const F h = hn::Mul(hn::Max(hn::Sub(end, part), zero), length);
    const F x0 = hn::Sub(from, lo), x1 = hn::Sub(ahead, lo);
    const F tau = column(at, 2), per_tau = column(at, 6);
    const F tau0 = hn::Max(hn::Add(tau, hn::Mul(per_tau, x0)), zero), tau1 = hn::Max(hn::Add(tau, hn::Mul(per_tau, x1)), zero);
    const F depth = hn::Mul(hn::Mul(hn::Set(d, 0.5f), h), hn::Add(tau0, tau1));
    const M lit = hn::And(on, hn::Gt(depth, zero));
    if (!hn::AllFalse(d, lit)) {
      // C = c0 m + c1 (alpha - m), m = the mean of 1 - exp(-depth so far)
      const F half = hn::Mul(hn::Mul(hn::Set(d, 0.125f), h), hn::Add(hn::Mul(hn::Set(d, 3.0f), tau0), tau1));
      const F alpha = fade(depth);
      const F m0 = hn::Mul(hn::Add(hn::Mul(hn::Set(d, 4.0f), fade(half)), alpha), hn::Set(d, 1.0f / 6));
      const F share = hn::IfThenElseZero(lit, sum.pass);
      const F w0 = hn::Mul(share, m0), w1 = hn::Mul(share, hn::Sub(alpha, m0)), w = hn::Add(w0, w1);
      const F moment = hn::Add(hn::Mul(w0, x0), hn::Mul(w1, x1));  // colours are linear: w0 c0 + w1 c1 = w c(lo) + moment * slope
      sum.r = hn::Add(sum.r, hn::Add(hn::Mul(w, column(at, 3)), hn::Mul(moment, column(at, 7))));
      sum.g = hn::Add(sum.g, hn::Add(hn::Mul(w, column(at, 4)), hn::Mul(moment, column(at, 8))));
      sum.b = hn::Add(sum.b, hn::Add(hn::Mul(w, column(at, 5)), hn::Mul(moment, column(at, 9))));
      sum.pass = hn::Sub(sum.pass, hn::Mul(share, alpha));
    }
    on = hn::AndNot(last, on);
    if (hn::AllFalse(d, on)) return;
    from = ahead, part = end;
    const I step = hn::IfThenElse(to_int(up), hn::Set(di, 1), hn::Set(di, -1));
    at = hn::IfThenElse(to_int(on), hn::Add(at, step), at);
  }
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
  const I last_slice = hn::Set(di, int32_t(medium.first.size()) - 1);

  const auto corner = [&](I id) HWY_ATTR {
    const I at = hn::ShiftLeft<2>(id);
    const F z = hn::GatherIndex(d, tables.eye + 2, at);
    return Corner{hn::Sub(hn::Sub(hn::GatherIndex(d, tables.eye, at), x0), hn::Mul(dx, z)),
                  hn::Sub(hn::Sub(hn::GatherIndex(d, tables.eye + 1, at), y0), hn::Mul(dy, z)), z, hn::GatherIndex(d, tables.eye + 3, at),
                  id};
  };
  const auto cross_at = [&](const Corner& a, const Corner& b, const Corner& c, F& f) HWY_ATTR {
    const F wa = hn::Max(turn(b.x, b.y, c.x, c.y), zero), wb = hn::Max(turn(c.x, c.y, a.x, a.y), zero);
    const F wc = hn::Max(turn(a.x, a.y, b.x, b.y), zero), all = hn::Add(hn::Add(wa, wb), wc);
    const M some = hn::Gt(all, hn::Set(d, 1e-37f));
    const F per = hn::Div(one, hn::IfThenElse(some, all, one)), third = hn::Set(d, 1.0f / 3);
    const F u = hn::IfThenElse(some, hn::Mul(wa, per), third), v = hn::IfThenElse(some, hn::Mul(wb, per), third);
    const F w = hn::IfThenElse(some, hn::Mul(wc, per), third);
    f = hn::Add(hn::Add(hn::Mul(u, a.f), hn::Mul(v, b.f)), hn::Mul(w, c.f));
    return hn::Add(hn::Add(hn::Mul(u, a.z), hn::Mul(v, b.z)), hn::Mul(w, c.z));
  };
  const auto slice = [&](F f) HWY_ATTR {
    const F at = hn::Mul(hn::Sub(f, hn::Set(d, medium.slice_lo)), hn::Set(d, medium.per_slice));
    const F most = hn::Set(d, 1e6f);
    const I s = hn::Add(hn::ConvertTo(di, hn::Min(hn::Max(at, hn::Set(d, -1.0f)), most)), hn::Set(di, 1));
    return hn::Min(hn::Max(hn::IfThenElse(to_int(hn::Lt(at, zero)), hn::Zero(di), s), hn::Zero(di)), last_slice);
  };

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
    const I seen = hn::Sub(hn::GatherIndex(di, medium.seen.data() + 1, hn::Max(slice0, slice1)),
                           hn::GatherIndex(di, medium.seen.data(), hn::Min(slice0, slice1)));
    const M lit = hn::And(some, to_float(hn::Gt(seen, hn::Zero(di))));
    if (!hn::AllFalse(d, lit)) {
      gather(medium, g0, g1, hn::Mul(hn::Sub(to, from), length), slice0, lit, sum);
      const M now = hn::And(hn::And(lit, hn::Lt(sum.pass, hn::Set(d, 0.5f))), hn::Ne(half, half));
      half = hn::IfThenElse(now, to, half);
    }
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

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {
HWY_EXPORT(walk);
void walk_tets(const TetTables& tables, TetPacket& packet) { HWY_DYNAMIC_DISPATCH(walk)(tables, packet); }
}  // namespace sg::volume
#endif
