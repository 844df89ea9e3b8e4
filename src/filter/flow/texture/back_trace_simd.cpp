// SPDX-License-Identifier: Apache-2.0
// Flat paths side by side. A path that meets a velocity without value is left to the reference, which knows about holes.
#include <algorithm>
#include <cmath>

#include "base/vector_targets.h"
#include "filter/flow/texture/back_trace.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/flow/texture/back_trace_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sg::texture::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DD = hn::CappedTag<double, 8>;
using DL = hn::Rebind<int64_t, DD>;
using V = hn::Vec<DD>;
using M = hn::Mask<DD>;

struct Flow2 {
  const float* velocity;
  V most[2], last_cell[2], width;

  HWY_INLINE explicit Flow2(const PixelFlow& f) : velocity(f.velocity()) {
    const DD d;
    for (int a = 0; a < 2; ++a) most[a] = hn::Set(d, double(f.n(a) - 1)), last_cell[a] = hn::Set(d, double(f.n(a) - 2));
    width = hn::Set(d, double(f.n(0)));
  }

  HWY_INLINE V inside(V x, int a) const { return hn::Min(hn::Max(x, hn::Zero(DD())), most[a]); }

  // Two floats of a pixel, from one load.
  HWY_INLINE void corner(hn::Vec<DL> index, size_t offset, V* v) const {
    const DD d;
    const DL dl;
    const hn::Rebind<uint32_t, DD> du;
    const hn::Rebind<uint64_t, DD> dul;
    const hn::Rebind<float, DD> df;
    const auto both = hn::BitCast(dul, hn::GatherIndex(dl, reinterpret_cast<const int64_t*>(velocity) + offset, index));
    v[0] = hn::PromoteTo(d, hn::BitCast(df, hn::TruncateTo(du, both)));
    v[1] = hn::PromoteTo(d, hn::BitCast(df, hn::TruncateTo(du, hn::ShiftRight<32>(both))));
  }

  HWY_INLINE void at_nearest(V x, V y, size_t stride, V* v) const {
    const DD d;
    const V px = inside(x, 0), py = inside(y, 1);
    const V i = hn::Min(hn::Floor(px), last_cell[0]), j = hn::Min(hn::Floor(py), last_cell[1]);
    const V f = hn::Sub(px, i), g = hn::Sub(py, j), one = hn::Set(d, 1.0), f0 = hn::Sub(one, f), g0 = hn::Sub(one, g);
    const auto index = hn::ConvertTo(DL(), hn::Add(i, hn::Mul(width, j)));
    V c[4][2];
    corner(index, 0, c[0]), corner(index, 1, c[1]), corner(index, stride, c[2]), corner(index, stride + 1, c[3]);
    for (int a = 0; a < 2; ++a)
      v[a] = hn::Add(hn::Mul(g0, hn::Add(hn::Mul(f0, c[0][a]), hn::Mul(f, c[1][a]))),
                     hn::Mul(g, hn::Add(hn::Mul(f0, c[2][a]), hn::Mul(f, c[3][a]))));
  }
};

HWY_INLINE V pass_dye(const BackTrace& how, const V* from, const V* to, V nearest, M alive) {
  const DD d;
  for (const Vec3& place : how.dye) {
    V a[2], w[2], ww = hn::Zero(d), aw = hn::Zero(d);
    for (int k = 0; k < 2; ++k) {
      const V pitch = hn::Set(d, how.pitch[k]);
      a[k] = hn::Mul(hn::Sub(from[k], hn::Set(d, place[k])), pitch), w[k] = hn::Mul(hn::Sub(to[k], from[k]), pitch);
      ww = hn::Add(ww, hn::Mul(w[k], w[k])), aw = hn::Add(aw, hn::Mul(a[k], w[k]));
    }
    const M moves = hn::Gt(ww, hn::Zero(d));
    const V quotient = hn::Div(hn::Sub(hn::Zero(d), aw), hn::IfThenElse(moves, ww, hn::Set(d, 1.0)));
    const V t = hn::IfThenElseZero(moves, hn::Min(hn::Max(quotient, hn::Zero(d)), hn::Set(d, 1.0)));
    V mm = hn::Zero(d);
    for (int k = 0; k < 2; ++k) {
      const V m = hn::Add(a[k], hn::Mul(t, w[k]));
      mm = hn::Add(mm, hn::Mul(m, m));
    }
    nearest = hn::IfThenElse(alive, hn::Min(nearest, mm), nearest);
  }
  return nearest;
}

// Up to a vector of paths; returns a bit for each that the reference has to walk.
uint32_t trace_some(const PixelFlow& flow, const BackTrace& how, BackPath* paths, size_t count) {
  const DD d;
  const Flow2 g(flow);
  const size_t n = hn::Lanes(d), stride = size_t(flow.n(0));
  HWY_ALIGN double buffer[3][8] = {};
  for (size_t l = 0; l < n; ++l) {
    const BackPath& p = paths[std::min(l, count - 1)];
    buffer[0][l] = p.x[0], buffer[1][l] = p.x[1], buffer[2][l] = p.nearest;
  }
  V p[2] = {hn::Load(d, buffer[0]), hn::Load(d, buffer[1])}, nearest = hn::Load(d, buffer[2]);
  const V half = hn::Set(d, how.h / 2), whole = hn::Set(d, how.h), sixth = hn::Set(d, how.h / 6), two = hn::Set(d, 2.0);
  const V slack = hn::Set(d, 1e-6), below = hn::Set(d, -1e-6);
  M alive = hn::FirstN(d, count), left = hn::FirstN(d, 0), odd = left;
  nearest = pass_dye(how, p, p, nearest, alive);
  for (int64_t s = 0; s < how.steps; ++s) {
    V k[4][2];
    g.at_nearest(p[0], p[1], stride, k[0]);
    for (int stage = 1; stage < 4; ++stage) {
      const V part = stage == 3 ? whole : half;
      g.at_nearest(hn::Add(p[0], hn::Mul(part, k[stage - 1][0])), hn::Add(p[1], hn::Mul(part, k[stage - 1][1])), stride, k[stage]);
    }
    V step[2], q[2];
    for (int a = 0; a < 2; ++a) {
      step[a] = hn::Mul(sixth, hn::Add(hn::Add(hn::Add(k[0][a], hn::Mul(two, k[1][a])), hn::Mul(two, k[2][a])), k[3][a]));
      q[a] = hn::Add(p[a], step[a]);
    }
    // The sum holds all velocities met: it is a number exactly when they are.
    const V sum = hn::Add(step[0], step[1]);
    const M holes = hn::AndNot(hn::Lt(hn::Abs(sum), hn::Set(d, HUGE_VAL)), alive);
    odd = hn::Or(odd, holes), alive = hn::AndNot(holes, alive);
    nearest = pass_dye(how, p, q, nearest, alive);
    const M moved = hn::Or(hn::Ne(step[0], hn::Zero(d)), hn::Ne(step[1], hn::Zero(d)));
    M out = hn::FirstN(d, 0);
    for (int a = 0; a < 2; ++a) {
      out = hn::Or(out, hn::Or(hn::Lt(q[a], below), hn::Gt(q[a], hn::Add(g.most[a], slack))));
      p[a] = hn::IfThenElse(alive, g.inside(q[a], a), p[a]);
    }
    left = hn::Or(left, hn::And(out, alive));
    alive = hn::And(alive, hn::AndNot(out, moved));
    if (hn::AllFalse(d, alive)) break;
  }
  hn::Store(p[0], d, buffer[0]), hn::Store(p[1], d, buffer[1]), hn::Store(nearest, d, buffer[2]);
  uint8_t left_bits[8] = {}, odd_bits[8] = {};
  hn::StoreMaskBits(d, left, left_bits), hn::StoreMaskBits(d, odd, odd_bits);
  for (size_t l = 0; l < count; ++l) {
    if (odd_bits[0] >> l & 1) continue;
    paths[l].x[0] = buffer[0][l], paths[l].x[1] = buffer[1][l], paths[l].nearest = buffer[2][l], paths[l].left = left_bits[0] >> l & 1;
  }
  return odd_bits[0];
}

void trace_all(const PixelFlow& flow, const BackTrace& how, BackPath* paths, size_t count) {
  const size_t n = hn::Lanes(DD());
  for (size_t i = 0; i < count; i += n) {
    const size_t some = std::min(n, count - i);
    const uint32_t odd = trace_some(flow, how, paths + i, some);
    for (size_t l = 0; l < some; ++l)
      if (odd >> l & 1) trace_back_scalar(flow, how, paths + i + l, 1);
  }
}

}  // namespace sg::texture::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::texture {
HWY_EXPORT(trace_all);

void trace_back(const PixelFlow& flow, const BackTrace& how, BackPath* paths, size_t count) {
  if (flow.dimension() == 2) HWY_DYNAMIC_DISPATCH(trace_all)(flow, how, paths, count);
  else trace_back_scalar(flow, how, paths, count);
}
}  // namespace sg::texture
#endif
