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

#include "base/simd/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::texture::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

using DD = hn::CappedTag<double, 8>;
using DL = hn::Rebind<int64_t, DD>;
using V = Float<DD>;
using M = Mask<DD>;

struct Flow2 {
  const float* velocity;
  V most[2], last_cell[2], width;

  HWY_INLINE explicit Flow2(const PixelFlow& f) : velocity(f.velocity()) {
    const DD d;
    for (int a = 0; a < 2; ++a) most[a] = set(d, double(f.n(a) - 1)), last_cell[a] = set(d, double(f.n(a) - 2));
    width = set(d, double(f.n(0)));
  }

  HWY_INLINE V inside(V x, int a) const { return min(max(x, 0), most[a]); }

  // Two floats of a pixel, from one load.
  HWY_INLINE void corner(hn::Vec<DL> index, size_t offset, V* v) const {
    const DD d;
    const DL dl;
    const hn::Rebind<uint32_t, DD> du;
    const hn::Rebind<uint64_t, DD> dul;
    const hn::Rebind<float, DD> df;
    const auto both = bit_cast(dul, hn::GatherIndex(dl, reinterpret_cast<const int64_t*>(velocity) + offset, index));
    v[0] = hn::PromoteTo(d, bit_cast(df, hn::TruncateTo(du, both)));
    v[1] = hn::PromoteTo(d, bit_cast(df, hn::TruncateTo(du, shift_right<32>(both))));
  }

  HWY_INLINE void at_nearest(V x, V y, size_t stride, V* v) const {
    const DD d;
    const V px = inside(x, 0), py = inside(y, 1);
    const V i = min(floor(px), last_cell[0]), j = min(floor(py), last_cell[1]);
    const V f = px - i, g = py - j, one = set(d, 1.0), f0 = one - f, g0 = one - g;
    const auto index = convert(DL(), i + width * j);
    V c[4][2];
    corner(index, 0, c[0]), corner(index, 1, c[1]), corner(index, stride, c[2]), corner(index, stride + 1, c[3]);
    for (int a = 0; a < 2; ++a) v[a] = g0 * (f0 * c[0][a] + f * c[1][a]) + g * (f0 * c[2][a] + f * c[3][a]);
  }
};

HWY_INLINE V pass_dye(const BackTrace& how, const V* from, const V* to, V nearest, M alive) {
  const DD d;
  for (const Vec3& place : how.dye) {
    V a[2], w[2], ww = set(d, 0), aw = set(d, 0);
    for (int k = 0; k < 2; ++k) {
      const V pitch = set(d, how.pitch[k]);
      a[k] = (from[k] - place[k]) * pitch, w[k] = (to[k] - from[k]) * pitch;
      ww = ww + w[k] * w[k], aw = aw + a[k] * w[k];
    }
    const M moves = ww > 0;
    const V quotient = (0 - aw) / select(moves, ww, 1.0);
    const V t = only(moves, min(max(quotient, 0), 1.0));
    V mm = set(d, 0);
    for (int k = 0; k < 2; ++k) {
      const V m = a[k] + t * w[k];
      mm = mm + m * m;
    }
    nearest = select(alive, min(nearest, mm), nearest);
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
  const V half = set(d, how.h / 2), whole = set(d, how.h), sixth = set(d, how.h / 6), two = set(d, 2.0);
  const V slack = set(d, 1e-6), below = set(d, -1e-6);
  M alive = hn::FirstN(d, count), left = hn::FirstN(d, 0), odd = left;
  nearest = pass_dye(how, p, p, nearest, alive);
  for (int64_t s = 0; s < how.steps; ++s) {
    V k[4][2];
    g.at_nearest(p[0], p[1], stride, k[0]);
    for (int stage = 1; stage < 4; ++stage) {
      const V part = stage == 3 ? whole : half;
      g.at_nearest(p[0] + part * k[stage - 1][0], p[1] + part * k[stage - 1][1], stride, k[stage]);
    }
    V step[2], q[2];
    for (int a = 0; a < 2; ++a) {
      step[a] = sixth * (k[0][a] + two * k[1][a] + two * k[2][a] + k[3][a]);
      q[a] = p[a] + step[a];
    }
    // The sum holds all velocities met: it is a number exactly when they are.
    const V sum = step[0] + step[1];
    const M holes = alive & !(abs(sum) < HUGE_VAL);
    odd = odd | holes, alive = alive & !holes;
    nearest = pass_dye(how, p, q, nearest, alive);
    const M moved = (step[0] != 0) | (step[1] != 0);
    M out = hn::FirstN(d, 0);
    for (int a = 0; a < 2; ++a) {
      out = out | ((q[a] < below) | (q[a] > g.most[a] + slack));
      p[a] = select(alive, g.inside(q[a], a), p[a]);
    }
    left = left | (out & alive);
    alive = alive & (moved & !out);
    if (none(alive)) break;
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
