// SPDX-License-Identifier: Apache-2.0
// The lines of a batch side by side: a vector holds one number of as many lines as fit. Both ways are walked in turn, so that the loads of
// one hide behind the sums of the other. No fused multiply-add: the same bytes on every machine.
#include <algorithm>

#include "base/vector_targets.h"
#include "filter/flow/texture/line_batch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/flow/texture/line_batch_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/simd/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::texture::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

using DF = hn::CappedTag<float, lanes>;
using DI = hn::Rebind<int32_t, DF>;
using F = hn::Vec<DF>;
using I = hn::Vec<DI>;
using M = hn::Mask<DF>;

HWY_INLINE F whole(I i) { return convert(DF(), i); }
HWY_INLINE F mixed(F a, F b, F t) { return a + t * (b - a); }

template <int D>
HWY_INLINE void unpack(I code, F* v) {
  if constexpr (D == 2) {
    v[0] = whole(shift_right<16>(shift_left<16>(code)));
    v[1] = whole(shift_right<16>(code));
  } else {
    v[0] = whole(shift_right<22>(shift_left<22>(code)));
    v[1] = whole(shift_right<22>(shift_left<12>(code)));
    v[2] = whole(shift_right<22>(shift_left<2>(code)));
  }
}

// The interpolated direction at p, in the numbers of the code.
template <int D>
HWY_INLINE void look(const DirectionGrid& g, const F* p, F* v) {
  const DI di;
  const auto* codes = reinterpret_cast<const int32_t*>(g.codes);
  F f[D], c[4][D];
  I index = set(di, 0);
  for (int a = D - 1; a >= 0; --a) {
    const I i = min(convert(di, p[a]), g.n[a] - 2);
    f[a] = p[a] - whole(i);
    index = a == D - 1 ? i : index * g.n[a] + i;
  }
  const int32_t* slab = codes;
  for (int z = 0; z < D - 1; ++z, slab += size_t(g.n[0]) * size_t(g.n[1])) {
    F lower[D], upper[D];
    for (int y = 0; y < 2; ++y) {
      F* row = y == 0 ? lower : upper;
      F left[D], right[D];
      unpack<D>(hn::GatherIndex(di, slab + y * g.n[0], index), left);
      unpack<D>(hn::GatherIndex(di, slab + y * g.n[0] + 1, index), right);
      for (int b = 0; b < D; ++b) row[b] = mixed(left[b], right[b], f[0]);
    }
    for (int b = 0; b < D; ++b) c[z][b] = mixed(lower[b], upper[b], f[1]);
  }
  for (int b = 0; b < D; ++b)
    if constexpr (D == 2) v[b] = c[0][b];
    else v[b] = mixed(c[0][b], c[1][b], f[2]);
}

// One way along 16 lines, or as many as a vector holds.
template <int D>
struct Walk {
  const DirectionGrid& g;
  LineBatch& batch;
  int part, way;
  F p[D], last[D], longer, shorter, whole_step, least;
  M alive;
  I made, since;

  HWY_INLINE Walk(const DirectionGrid& grid, LineBatch& b, int first_lane, int sign) : g(grid), batch(b), part(first_lane), way(sign) {
    const DF df;
    const float h = float(way) * batch.step / code_scale(D), l = least_direction * code_scale(D);
    longer = set(df, 1.5f * h), shorter = set(df, 0.5f * h), whole_step = set(df, h), least = set(df, l * l);
    for (int a = 0; a < D; ++a) p[a] = hn::LoadU(df, batch.start[a] + part), last[a] = set(df, 0);
    alive = hn::FirstN(df, size_t(lanes));
    made = set(DI(), 0), since = set(DI(), -1);
  }

  HWY_INLINE void step(int k) {
    const DF df;
    const DI di;
    F v[D], q[D];
    look<D>(g, p, v);
    F square = v[0] * v[0];
    for (int a = 1; a < D; ++a) square = square + v[a] * v[a];
    alive = alive & (square > least);
    if (k == 0) {
      F m[D], w[D];
      for (int a = 0; a < D; ++a) m[a] = min(max(p[a] + shorter * v[a], 0), float(g.n[a] - 1));
      look<D>(g, m, w);
      for (int a = 0; a < D; ++a) q[a] = p[a] + whole_step * w[a];
    } else {
      for (int a = 0; a < D; ++a) q[a] = p[a] + (longer * v[a] - shorter * last[a]);
    }
    for (int a = 0; a < D; ++a) alive = alive & ((q[a] >= 0) & (q[a] <= float(g.n[a] - 1)));
    for (int a = 0; a < D; ++a) last[a] = v[a], p[a] = select(alive, q[a], p[a]);
    const auto walks = rebind(di, alive);
    made = select(walks, k + 1, made);
    const auto inside = record(way * (k + 1), alive);
    if (batch.tail > 0) {
      since = select(inside, k, since);
      alive = alive & rebind(df, since > k - batch.tail);
    }
  }

  // The nearest pixels of the lines that are alive; which of them lie in the box?
  HWY_INLINE hn::Mask<DI> record(int k, M valid) {
    const DF df;
    const DI di;
    I pixel = set(di, 0), local = set(di, 0);
    auto inside = rebind(di, valid);
    const bool boxed = batch.tail > 0;
    for (int a = D - 1; a >= 0; --a) {
      const I i = convert(di, p[a] + 0.5f);
      pixel = a == D - 1 ? i : pixel * g.n[a] + i;
      if (!boxed) continue;
      const I in = i - batch.box_lo[a], edge = set(di, batch.box_hi[a] - batch.box_lo[a]);
      local = a == D - 1 ? in : local * edge + in;
      inside = inside & ((in > -1) & (in < edge));
    }
    const size_t row = size_t(batch.steps + k) * lanes + size_t(part);
    hn::StoreU(only(valid, hn::GatherIndex(df, g.noise, pixel)), df, batch.noise.data() + row);
    if (!batch.pixels.empty()) hn::StoreU(select(inside, boxed ? local : pixel, -1), di, batch.pixels.data() + row);
    return inside;
  }

  // Rows behind those that were walked.
  void finish(int walked) {
    for (int k = walked; k < batch.steps; ++k) {
      const size_t row = size_t(batch.steps + way * (k + 1)) * lanes + size_t(part);
      hn::StoreU(set(DF(), 0), DF(), batch.noise.data() + row);
      if (!batch.pixels.empty()) hn::StoreU(set(DI(), -1), DI(), batch.pixels.data() + row);
    }
    hn::StoreU(made, DI(), (way > 0 ? batch.forth : batch.back) + part);
  }
};

template <int D>
void trace(const DirectionGrid& g, LineBatch& batch) {
  const DF df;
  for (int part = 0; part < lanes; part += int(hn::Lanes(df))) {
    Walk<D> forth(g, batch, part, 1), back(g, batch, part, -1);
    forth.record(0, forth.alive);
    int a = 0, b = 0;
    bool more_a = true, more_b = true;
    for (int k = 0; k < batch.steps && (more_a || more_b); ++k) {
      if (more_a) forth.step(k), a = k + 1, more_a = any(forth.alive);
      if (more_b) back.step(k), b = k + 1, more_b = any(back.alive);
    }
    forth.finish(a), back.finish(b);
  }
}

void trace_2d(const DirectionGrid& g, LineBatch& batch) { trace<2>(g, batch); }
void trace_3d(const DirectionGrid& g, LineBatch& batch) { trace<3>(g, batch); }

void convolve(const LineBatch& batch, const Weights& weights, int first, int last, float* out) {
  const DF df;
  const int rows = 2 * batch.steps + 1, n = weights.steps;
  for (int part = 0; part < lanes; part += int(hn::Lanes(df))) {
    const float* noise = batch.noise.data() + part;
    auto row = [&](int r) HWY_ATTR { return r < 0 || r >= rows ? set(df, 0) : hn::LoadU(df, noise + size_t(r) * lanes); };
    F s = set(df, 0);
    for (int m = first; m <= last; ++m) {
      if (!weights.box || m == first) {
        s = set(df, 0);
        for (int k = std::max(-n, -m); k <= std::min(n, rows - 1 - m); ++k)
          s = s + weights.w[size_t(n + k)] * hn::LoadU(df, noise + size_t(m + k) * lanes);
      } else {
        s = s + (row(m + n) - row(m - n - 1));
      }
      hn::StoreU(s, df, out + size_t(m - first) * lanes + part);
    }
  }
}

}  // namespace sg::texture::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::texture {
HWY_EXPORT(trace_2d);
HWY_EXPORT(trace_3d);
HWY_EXPORT(convolve);

void trace_lines(const DirectionGrid& grid, LineBatch& batch) {
  if (grid.dimension == 2) HWY_DYNAMIC_DISPATCH(trace_2d)(grid, batch);
  else HWY_DYNAMIC_DISPATCH(trace_3d)(grid, batch);
}
void convolve_lines(const LineBatch& batch, const Weights& weights, int first, int last, float* out) {
  HWY_DYNAMIC_DISPATCH(convolve)(batch, weights, first, last, out);
}
}  // namespace sg::texture
#endif
