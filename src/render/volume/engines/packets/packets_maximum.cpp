// SPDX-License-Identifier: Apache-2.0
// The largest value along packets of rays, exactly that of the trilinear field (maximum.cpp, one ray at a time, is the reference).
// Bricks are visited from those that promise most on, as long as they promise more than what was found.
#include "render/volume/engines/packets/packet_rays.h"

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/volume/engines/packets/packets_maximum.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/volume/engines/packets/packet_cubic-inl.h"
#include "render/volume/engines/packets/packets-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

template <class D>
HWY_INLINE Float<D> clamped_to(Float<D> x, Float<D> lo, Float<D> hi) {
  return max(lo, min(x, hi));
}

/// 3D DDA through the boxes of `edge` cells that rays cross; box numbers are whole floats. Boxes from `lowest` to `highest` exist, those at
/// the ends reach as far as the ray does.
template <class D>
struct BoxWalk {
  using F = Float<D>;
  using M = Mask<D>;
  const F *entry, *along, *per_along;
  F edge, lowest[3], highest[3], box[3], next[3], t, end;
  M crossed[3];  // through which sides the lanes came in

  HWY_INLINE F crossing(int a) const {
    const D d;
    const M forth = along[a] > 0;
    const F at = ((box[a] + select(forth, set(d, 1.0f), 0)) * edge - entry[a]) * per_along[a];
    const M open = (along[a] == 0) | (box[a] == select(forth, highest[a], lowest[a]));
    return select(open, HUGE_VALF, max(at, t));
  }
  /// From length `from` to `to`.
  HWY_INLINE void start(F from, F to) {
    const D d;
    t = from, end = to;
    for (int a = 0; a < 3; ++a) {
      const F at = (entry[a] + t * along[a]) / edge;
      box[a] = clamped_to<D>(floor(at), lowest[a], highest[a]);
      crossed[a] = set(d, 0) > 0;
    }
    for (int a = 0; a < 3; ++a) next[a] = crossing(a);
  }
  HWY_INLINE F leave() const { return min(min(next[0], next[1]), min(next[2], end)); }
  /// The lanes `m` go on to their next box; returns those for which there is one.
  HWY_INLINE M advance(M m) {
    const D d;
    const F to = leave();
    m = m & (to < end);
    t = select(m, to, t);
    for (int a = 0; a < 3; ++a) {
      crossed[a] = m & (next[a] <= to);
      const F by = select(along[a] > 0, set(d, 1.0f), -1.0f);
      box[a] = select(crossed[a], box[a] + by, box[a]);
    }
    for (int a = 0; a < 3; ++a) next[a] = select(crossed[a], crossing(a), next[a]);
    return m;
  }
};

template <class D, class T>
class MaximumPacket {
  using F = Float<D>;
  using I = Int<D>;
  using M = Mask<D>;

 public:
  HWY_INLINE MaximumPacket(const MaximumPlan& plan, const RayPacket& rays)
      : volume_(plan.volume), skip_(plan.skip_empty), source_(plan.volume.voxels) {
    const D d;
    for (int a = 0; a < 3; ++a) {
      entry_[a] = hn::Load(d, rays.entry[a]), along_[a] = hn::Load(d, rays.along[a]);
      per_along_[a] = 1.0f / along_[a];
      last_cell_[a] = convert(d, source_.last_cell[a]);
    }
    length_ = hn::Load(d, rays.length);
    best_ = set(d, -HUGE_VALF), where_ = set(d, 0);
  }

  HWY_INLINE void run() {
    const D d;
    BoxWalk<D> walk = bricks();
    walk.start(set(d, 0), length_);
    for (M going = length_ > 0; any(going);) {
      going = look(walk, going);
      visit();
    }
  }
  HWY_INLINE void result(float* best, float* where) const {
    const D d;
    hn::Store(best_, d, best), hn::Store(where_, d, where);
  }

 private:
  HWY_INLINE BoxWalk<D> bricks() const {
    const D d;
    BoxWalk<D> w;
    w.entry = entry_, w.along = along_, w.per_along = per_along_, w.edge = set(d, float(MinMaxBricks::edge));
    for (size_t a = 0; a < 3; ++a) w.lowest[a] = set(d, 0), w.highest[a] = set(d, float(volume_.bricks().dims[a] - 1));
    return w;
  }
  HWY_INLINE F highest_in(const BoxWalk<D>& w) const {
    const D d;
    const auto& dims = volume_.bricks().dims;
    const auto id = to_int(d, w.box[0]) + (to_int(d, w.box[1]) * int(dims[0]) + to_int(d, w.box[2]) * int(dims[0] * dims[1]));
    return bit_cast(d, gather_words(d, &volume_.bricks().ranges[0].hi, shift_left<3>(id), source_.loads));
  }

  /// Notes what the next bricks promise; returns the lanes that have more of them.
  HWY_INLINE M look(BoxWalk<D>& walk, M going) {
    const D d;
    hn::Store(walk.t, d, begin_[0]);
    for (seen_ = 0; seen_ < most_seen && any(going); ++seen_) {
      hn::Store(select(going, highest_in(walk), -HUGE_VALF), d, promise_[seen_]);
      const F leave = walk.leave();
      going = walk.advance(going);
      hn::Store(leave, d, begin_[seen_ + 1]);
    }
    return going;
  }
  /// Each lane goes from the brick that promises most, the nearest of those, to the next.
  HWY_INLINE void visit() {
    const D d;
    const IntTag<D> di;
    const I lanes = set(di, lanes_of<D>), lane = hn::Iota(di, 0);
    while (true) {
      F most = skip_ ? best_ : set(d, -HUGE_VALF);
      I which = set(di, -1);
      for (int i = 0; i < seen_; ++i) {
        const F promise = hn::Load(d, promise_[i]);
        which = select(promise > most, i, which), most = max(most, promise);
      }
      const auto chosen = which > -1;
      if (none(chosen)) return;
      alignas(64) int32_t at[most_lanes];
      hn::Store(which, di, at);
      for (int n = 0; n < lanes_of<D>; ++n)
        if (at[n] >= 0) promise_[at[n]][n] = -HUGE_VALF;
      const I from = max(which, 0) * lanes + lane;
      cells(rebind(d, chosen), hn::GatherIndex(d, begin_[0], from), hn::GatherIndex(d, begin_[1], from));
    }
  }

  /// Cells between the lengths; -1 and the number of cells are the halves beyond the outermost samples, where values are clamped.
  HWY_INLINE void cells(M m, F from, F to) {
    const D d;
    BoxWalk<D> w;
    w.entry = entry_, w.along = along_, w.per_along = per_along_, w.edge = set(d, 1.0f);
    for (int a = 0; a < 3; ++a) w.lowest[a] = set(d, -1.0f), w.highest[a] = last_cell_[a] + 1.0f;
    w.start(from, to);
    for (; any(m); m = w.advance(m)) cell(m, w);
  }

  HWY_INLINE void cell(M m, const BoxWalk<D>& w) {
    const D d;
    const F zero = set(d, 0), one = set(d, 1.0f);
    // Corner samples: a cell below what was found is passed over.
    F low[3];
    Int<D> at[3];
    for (int a = 0; a < 3; ++a) low[a] = clamped_to<D>(w.box[a], zero, last_cell_[a]), at[a] = to_int(d, low[a]);
    const auto p = source_.offset(at[0], at[1], at[2]);
    Pair<D> c[4];
    source_.corners(p, c);
    F top = max(max(max(c[0].a, c[0].b), max(c[1].a, c[1].b)), max(max(c[2].a, c[2].b), max(c[3].a, c[3].b)));
    if (skip_) m = m & (top > best_);
    if constexpr (std::is_same_v<T, float>) {  // a cell with a NaN corner is clear
      const F sum = c[0].a + c[0].b + (c[1].a + c[1].b) + (c[2].a + c[2].b + (c[3].a + c[3].b));
      m = m & (sum == sum);
    }
    if (none(m)) return;

    // Fractions of the edges at both ends; where a side is crossed, but for rounding errors, they are whole.
    const F leave = w.leave(), length = leave - w.t, crossing = leave * (1 + 5e-7f);
    F f0[3], df[3];
    for (int a = 0; a < 3; ++a) {
      const M forth = along_[a] > zero, inside = low[a] == w.box[a];
      F enters = clamped_to<D>(entry_[a] + w.t * along_[a] - low[a], zero, one);
      F leaves = clamped_to<D>(entry_[a] + leave * along_[a] - low[a], zero, one);
      enters = select(inside & w.crossed[a], select(forth, zero, one), enters);
      leaves = select(inside & (w.next[a] <= crossing), select(forth, one, zero), leaves);
      f0[a] = enters, df[a] = leaves - enters;
    }
    // The field along the ray is a cubic: its maximum is at an end of the cell, or where its derivative falls through zero.
    const Cubic<D> f = along_way(c, f0, df);
    offer(m, along_cell(c, f0, df, zero), w.t), offer(m, along_cell(c, f0, df, one), leave);
    // Of the zeros of f' = b + 2 c s + 3 e s^2 the one where f'' < 0, by the root that does not cancel.
    const F discriminant = neg_mul_add(3.0f * f.e, f.b, f.c * f.c);
    const F square_root = sqrt(max(discriminant, zero));
    const M falling = f.c > zero;
    const F s = select(falling, -(f.c + square_root), f.b) / select(falling, 3.0f * f.e, square_root - f.c);
    m = m & (discriminant > zero) & ((s > zero) & (s < one));
    if (none(m)) return;
    offer(m, along_cell(c, f0, df, s), mul_add(s, length, w.t));
  }

  /// Exact at the corners.
  static HWY_INLINE F between(F a, F b, F x) { return mul_add(b, x, a * (1.0f - x)); }
  static HWY_INLINE F along_cell(const Pair<D>* c, const F* f0, const F* df, F s) {
    const F x = mul_add(s, df[0], f0[0]), y = mul_add(s, df[1], f0[1]), z = mul_add(s, df[2], f0[2]);
    return between(between(between(c[0].a, c[0].b, x), between(c[1].a, c[1].b, x), y),
                   between(between(c[2].a, c[2].b, x), between(c[3].a, c[3].b, x), y), z);
  }
  HWY_INLINE void offer(M m, F value, F t) {
    const M better = m & (value > best_);
    best_ = select(better, value, best_), where_ = select(better, t, where_);
  }

  const Volume& volume_;
  const bool skip_;
  const Source<D, T> source_;
  F entry_[3], along_[3], per_along_[3], last_cell_[3], length_, best_, where_;
  static constexpr int most_seen = 128;
  int seen_ = 0;  ///< bricks that were looked at
  alignas(64) float promise_[most_seen][lanes_of<D>], begin_[most_seen + 1][lanes_of<D>];
};

template <class D, class T>
HWY_NOINLINE void maximum_all(const MaximumPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  constexpr int lanes = lanes_of<D>, width = packet_width<D>, height = lanes / width;
  const Transfer& transfer = plan.volume.transfer[0];
  RayPacket rays;
  PacketResult result;
  for (int y = y0; y < y1; y += height)
    for (int x = x0; x < x1; x += width) {
      if (!set_up<D>(plan, x, y, x1, y1, frame, rays)) continue;
      MaximumPacket<D, T> packet(plan, rays);
      packet.run();
      alignas(64) float best[most_lanes], where[most_lanes];
      packet.result(best, where);
      for (int n = 0; n < lanes; ++n) {
        result.r[n] = result.g[n] = result.b[n] = 0, result.transmittance[n] = 1, result.surface[n] = -1;
        if (!(best[n] > -HUGE_VALF)) continue;
        const Transfer::Medium& m = transfer.medium(transfer.index(best[n]));
        if (m.density == 0) continue;
        result.r[n] = m.r, result.g[n] = m.g, result.b[n] = m.b, result.transmittance[n] = 0;
        result.surface[n] = rays.enter[n] + double(where[n]);
      }
      put(plan.volume, nullptr, rays, result, lanes, frame);
    }
}

template <class D>
HWY_INLINE void maximum_with(const MaximumPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  switch (plan.volume.voxels.array.type()) {
    case ElementType::u8:
    case ElementType::i8:
    case ElementType::u16:
    case ElementType::i16: return maximum_all<D, SmallInteger>(plan, x0, y0, x1, y1, frame);
    default: return maximum_all<D, float>(plan, x0, y0, x1, y1, frame);
  }
}

void maximum_in_packets(const MaximumPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  maximum_with<hn::CappedTag<float, most_lanes>>(plan, x0, y0, x1, y1, frame);
}

#if HWY_ONCE
void maximum_singly(const MaximumPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  maximum_with<hn::CappedTag<float, 1>>(plan, x0, y0, x1, y1, frame);
}
#endif

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {

HWY_EXPORT(maximum_in_packets);

void draw_tile(const MaximumPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  if (plan.simd) return HWY_DYNAMIC_DISPATCH(maximum_in_packets)(plan, x0, y0, x1, y1, frame);
  return HWY_STATIC_DISPATCH(maximum_singly)(plan, x0, y0, x1, y1, frame);
}

}  // namespace sg::volume
#endif
