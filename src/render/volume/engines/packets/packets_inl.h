// SPDX-License-Identifier: Apache-2.0
// Vector code that both kinds of packets share; included once per target, after highway.h. D is the tag of a packet: one lane per ray.
// Only IEEE operations in a fixed order, fused where it says so (the compiler fuses none): the same bits for any number of lanes.
#if defined(SG_PACKETS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKETS_INL_H
#undef SG_PACKETS_INL_H
#else
#define SG_PACKETS_INL_H
#endif

#include "render/shade/exp-inl.h"
#include "render/volume/engines/packets/gathers_inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using shading::HWY_NAMESPACE::exp_minus;
using simd::HWY_NAMESPACE::mul_add;
using simd::HWY_NAMESPACE::mul_sub;
using simd::HWY_NAMESPACE::neg_mul_add;

template <class D>
HWY_INLINE hn::Vec<D> mixed(D, hn::Vec<D> a, hn::Vec<D> b, hn::Vec<D> f) {
  return mul_add(f, hn::Sub(b, a), a);
}

template <class D>
HWY_INLINE Int<D> to_int(D, hn::Vec<D> v) {
  return simd::HWY_NAMESPACE::truncated(v);
}

/// 1 / sqrt(x) to a part in 500, x > 1e-38.
template <class D>
HWY_INLINE hn::Vec<D> about_one_by_sqrt(D d, hn::Vec<D> x) {
  const IntTag<D> di;
  const auto y = hn::BitCast(d, hn::Sub(hn::Set(di, 0x5F3759DF), hn::ShiftRight<1>(hn::BitCast(di, x))));
  return hn::Mul(y, neg_mul_add(hn::Mul(hn::Set(d, 0.5f), x), hn::Mul(y, y), hn::Set(d, 1.5f)));
}

/// A place along one axis: the cell and the fraction of its edge.
template <class D>
struct Place {
  Int<D> cell;
  hn::Vec<D> fraction;
};

/// The lattice, ready for gathers. T: float, or the unsigned integers of the size of the samples.
template <class D, class T>
struct Source {
  const T* data;
  Int<D> row, layer;
  Integers<D> integers;
  hn::Vec<D> top[3];
  Int<D> last_cell[3];
  ptrdiff_t to_row, to_layer;  ///< row and layer as numbers of samples
  bool loads;                  ///< of gathers.h
  bool within;                 ///< no place that is asked for lies beyond the outermost samples, but for rounding

  HWY_INLINE explicit Source(const Voxels& voxels, bool all_within = false)
      : data(reinterpret_cast<const T*>(voxels.array.raw())),
        integers((int(voxels.array.bytes()) - 4) / int(sizeof(T)), 8 * int(sizeof(T)), has_sign(voxels.array.type())),
        loads(loads_beat_gathers()),
        within(all_within) {
    const D d;
    const IntTag<D> di;
    to_row = ptrdiff_t(voxels.dims[0]), to_layer = ptrdiff_t(voxels.dims[0] * voxels.dims[1]);
    row = hn::Set(di, int(to_row)), layer = hn::Set(di, int(to_layer));
    for (size_t a = 0; a < 3; ++a) top[a] = hn::Set(d, float(voxels.dims[a] - 1)), last_cell[a] = hn::Set(di, int(voxels.dims[a]) - 2);
  }
  HWY_INLINE Place<D> place(int axis, hn::Vec<D> u) const {
    const D d;
    if (!within) u = hn::Max(hn::Zero(d), hn::Min(u, top[axis]));
    const auto cell = hn::Min(to_int(d, u), last_cell[axis]);
    return {cell, hn::Sub(u, hn::ConvertTo(d, cell))};
  }
  /// For places that are known to lie in [0, top).
  HWY_INLINE Place<D> inner_place(hn::Vec<D> u) const {
    const D d;
    const auto cell = to_int(d, u);
    return {cell, hn::Sub(u, hn::ConvertTo(d, cell))};
  }
  HWY_INLINE Int<D> offset(Int<D> i, Int<D> j, Int<D> k) const { return hn::Add(i, hn::Add(hn::Mul(j, row), hn::Mul(k, layer))); }
  /// Pairs so many samples on from `at`, the same for all lanes.
  template <size_t n, class At>
  HWY_INLINE void pairs(At at, const ptrdiff_t (&on)[n], Pair<D>* out) const {
    if constexpr (std::is_same_v<T, float>) gather_pairs(D(), data, on, at, loads, out);
    else gather_pairs(D(), data, on, at, integers, loads, out);
  }
  /// Four samples in a row each.
  template <size_t n>
  HWY_INLINE void quads(Int<D> at, const ptrdiff_t (&on)[n], Quad<D>* out) const {
    if constexpr (std::is_same_v<T, float>) gather_quads(D(), data, on, at, loads, out);
    else gather_quads(D(), data, on, at, integers, loads, out);
  }
  /// The corners of the cell whose lowest one is there: its rows (0, 0), (1, 0), (0, 1), (1, 1) along y and z.
  template <class At>
  HWY_INLINE void corners(At lowest, Pair<D> rows[4]) const {
    pairs(lowest, {0, to_row, to_layer, to_layer + to_row}, rows);
  }
  HWY_INLINE hn::Vec<D> value(const Place<D>& x, const Place<D>& y, const Place<D>& z) const {
    return value(offset(x.cell, y.cell, z.cell), x.fraction, y.fraction, z.fraction);
  }
  /// At the fractions of the cell whose lowest corner is sample `at`. Along x last, as SlopeFinder does: the same bits.
  template <class At>
  HWY_INLINE hn::Vec<D> value(At at, hn::Vec<D> fx, hn::Vec<D> fy, hn::Vec<D> fz) const {
    const D d;
    Pair<D> p;
    if (!value_of_loads(at, fy, fz, p)) {
      Pair<D> rows[4];
      corners(at, rows);
      p.a = across(rows[0].a, rows[1].a, rows[2].a, rows[3].a, fy, fz);
      p.b = across(rows[0].b, rows[1].b, rows[2].b, rows[3].b, fy, fz);
    }
    return mixed(d, p.a, p.b, fx);
  }

 private:
  static bool has_sign(ElementType type) { return type == ElementType::i8 || type == ElementType::i16; }
  static HWY_INLINE hn::Vec<D> across(hn::Vec<D> v0, hn::Vec<D> v1, hn::Vec<D> v2, hn::Vec<D> v3, hn::Vec<D> fy, hn::Vec<D> fz) {
    const D d;
    return mixed(d, mixed(d, v0, v1, fy), mixed(d, v2, v3, fy), fz);
  }
  /// Both values along x where numbers are loaded lane by lane: their rows are mixed while the pairs are side by side.
  template <class At>
  HWY_INLINE bool value_of_loads([[maybe_unused]] At at, [[maybe_unused]] hn::Vec<D> fy, [[maybe_unused]] hn::Vec<D> fz,
                                 [[maybe_unused]] Pair<D>& out) const {
#if SG_HARDWARE_GATHERS
    if constexpr (std::is_same_v<T, float> && lanes_of<D> >= 8) {
      if (loads) {
        SideBySide<D> rows[4];
        load_side_by_side(D(), data, {0, to_row, to_layer, to_layer + to_row}, at, rows);
        const auto y = SideBySide<D>::twice(fy), z = SideBySide<D>::twice(fz);
        out = SideBySide<D>{across(rows[0].x, rows[1].x, rows[2].x, rows[3].x, y.x, z.x),
                            across(rows[0].y, rows[1].y, rows[2].y, rows[3].y, y.y, z.y)}
                  .by_lanes();
        return true;
      }
    }
#endif
    return false;
  }
};

/// Pixels of a packet across and down.
template <class D>
constexpr int packet_width = lanes_of<D> >= 8   ? 4
                             : lanes_of<D> >= 4 ? 2
                                                : 1;

template <class DD>
struct V3 {
  hn::Vec<DD> x, y, z;
};
template <class DD>
HWY_INLINE V3<DD> set3(DD d, Vec3 v) {
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}
template <class DD>
HWY_INLINE hn::Vec<DD> dot3(DD, const V3<DD>& a, const V3<DD>& b) {
  return mul_add(a.z, b.z, mul_add(a.y, b.y, hn::Mul(a.x, b.x)));
}
template <class DD>
HWY_INLINE V3<DD> plus(DD, const V3<DD>& a, const V3<DD>& b, hn::Vec<DD> s) {
  return {mul_add(b.x, s, a.x), mul_add(b.y, s, a.y), mul_add(b.z, s, a.z)};
}
template <class DD>
HWY_INLINE void store_narrow(DD, hn::Vec<DD> v, float* to) {
  const hn::Rebind<float, DD> df;
  hn::StoreU(hn::DemoteTo(df, v), df, to);
}

/// The rays through the pixels from (x, y) on, as far as they lie in the tile; false when none meets the volume.
template <class D>
HWY_INLINE bool set_up(const PacketPlan& plan, int x, int y, int x1, int y1, const Frame& frame, RayPacket& r) {
  constexpr int lanes = lanes_of<D>, width = packet_width<D>;
  using DD = hn::CappedTag<double, lanes>;
  const DD d;
  using V = hn::Vec<DD>;
  const Projection& p = plan.projection;
  const Volume& v = plan.volume;
  alignas(64) double px[lanes], py[lanes], depth[lanes];
  for (int n = 0; n < lanes; ++n) {
    const int i = x + n % width, j = y + n / width;
    px[n] = i + 0.5, py[n] = j + 0.5;
    r.inside[n] = i < x1 && j < y1;
    r.pixel[n] = r.inside[n] ? size_t(j) * size_t(frame.width) + size_t(i) : 0;
    depth[n] = r.inside[n] ? std::min(p.far_plane, double(frame.depth[r.pixel[n]])) : -HUGE_VAL;
    r.before[n] = plan.half && r.inside[n] ? 1 - frame.rgba[4 * r.pixel[n] + 3] : 1;
    if (r.before[n] < plan.budget.stop_below) depth[n] = -HUGE_VAL;
  }
  const Mat3& m = v.to_q;
  const V zero = hn::Zero(d);
  bool any = false;
  for (size_t n = 0; n < size_t(lanes); n += hn::Lanes(d)) {
    const V sx = hn::Div(hn::Sub(hn::Load(d, px + n), hn::Set(d, p.middle_x())), hn::Set(d, p.scale));
    const V sy = hn::Div(hn::Sub(hn::Set(d, p.middle_y()), hn::Load(d, py + n)), hn::Set(d, p.scale));
    const V3<DD> eye = set3(d, p.eye), right = set3(d, p.right), up = set3(d, p.up), forward = set3(d, p.forward);
    V3<DD> origin = eye, direction = forward;
    if (p.parallel) {
      origin = plus(d, plus(d, eye, right, sx), up, sy);
    } else {
      direction = plus(d, plus(d, forward, right, sx), up, sy);
      const V length = hn::Sqrt(dot3(d, direction, direction));
      direction = {hn::Div(direction.x, length), hn::Div(direction.y, length), hn::Div(direction.z, length)};
    }
    const V per_length = dot3(d, direction, forward);
    const V first_depth = dot3(d, V3<DD>{hn::Sub(origin.x, eye.x), hn::Sub(origin.y, eye.y), hn::Sub(origin.z, eye.z)}, forward);
    V enter = hn::Div(hn::Sub(hn::Set(d, p.near_plane), first_depth), per_length);
    V leave = hn::Div(hn::Sub(hn::Load(d, depth + n), first_depth), per_length);
    const V3<DD> away{hn::Sub(origin.x, hn::Set(d, v.origin.x)), hn::Sub(origin.y, hn::Set(d, v.origin.y)),
                      hn::Sub(origin.z, hn::Set(d, v.origin.z))};
    V start[3], along[3], first_enter = enter, last_leave = leave;  // of all lattices
    for (int a = 0; a < 3; ++a) {
      const V3<DD> line = set3(d, Vec3{m.m[a][0], m.m[a][1], m.m[a][2]});
      start[a] = dot3(d, line, away), along[a] = dot3(d, line, direction);
      const V lo = hn::Set(d, v.lo[a]), hi = hn::Set(d, v.hi[a]);
      const auto still = hn::Eq(along[a], zero);
      const auto outside = hn::Or(hn::Lt(start[a], lo), hn::Gt(start[a], hi));
      const V t0 = hn::Div(hn::Sub(lo, start[a]), along[a]), t1 = hn::Div(hn::Sub(hi, start[a]), along[a]);
      enter = hn::IfThenElse(still, enter, hn::Max(enter, hn::Min(t0, t1)));
      leave = hn::IfThenElse(still, leave, hn::Min(leave, hn::Max(t0, t1)));
      leave = hn::IfThenElse(hn::And(still, outside), hn::Set(d, -HUGE_VAL), leave);
      if (!plan.half) continue;
      const V w0 = hn::Div(hn::Sub(hn::Set(d, plan.whole_lo[a]), start[a]), along[a]),
              w1 = hn::Div(hn::Sub(hn::Set(d, plan.whole_hi[a]), start[a]), along[a]);
      first_enter = hn::IfThenElse(still, first_enter, hn::Max(first_enter, hn::Min(w0, w1)));
      last_leave = hn::IfThenElse(still, last_leave, hn::Min(last_leave, hn::Max(w0, w1)));
    }
    for (const ClipPlane& plane : plan.clip) {
      const V3<DD> normal = set3(d, plane.normal);
      const V along_normal = dot3(d, normal, direction), rest = hn::Sub(hn::Set(d, plane.offset), dot3(d, normal, origin));
      const V at = hn::Div(rest, along_normal);
      leave = hn::IfThenElse(hn::Gt(along_normal, zero), hn::Min(leave, at), leave);
      enter = hn::IfThenElse(hn::Lt(along_normal, zero), hn::Max(enter, at), enter);
      const auto outside = hn::And(hn::Eq(along_normal, zero), hn::Lt(rest, zero));
      leave = hn::IfThenElse(outside, hn::Set(d, -HUGE_VAL), leave);
    }
    const auto hit = hn::Gt(leave, enter);
    any = any || !hn::AllFalse(d, hit);
    // A ray that misses has no steps; its places are of no account but finite.
    const V length = hn::IfThenElseZero(hit, hn::Sub(leave, enter)), step = hn::Set(d, v.step);
    V steps = hn::Floor(hn::Div(length, step));
    V rest = hn::Max(zero, neg_mul_add(steps, step, length));
    const V half = hn::Set(d, 0.5);
    enter = hn::IfThenElseZero(hit, enter), leave = hn::IfThenElseZero(hit, leave);
    V t_first = mul_add(half, step, enter), t_last = neg_mul_add(half, rest, leave);
    if (plan.half) {
      // Steps of the whole whose middles lie in this part.
      first_enter = hn::IfThenElseZero(hit, first_enter), last_leave = hn::IfThenElseZero(hit, last_leave);
      const V all = hn::Sub(last_leave, first_enter), count = hn::Floor(hn::Div(all, step));
      const auto number = [&](V t) HWY_ATTR { return hn::Min(count, hn::Ceil(hn::Sub(hn::Div(hn::Sub(t, first_enter), step), half))); };
      const V begin = number(enter);
      steps = hn::IfThenElseZero(hit, hn::Max(zero, hn::Sub(number(leave), begin)));
      t_first = mul_add(hn::Add(begin, half), step, first_enter);
      rest = hn::Max(zero, neg_mul_add(count, step, all));
      t_last = neg_mul_add(half, rest, last_leave);
      rest = hn::IfThenElseZero(hn::And(hit, hn::And(hn::Ge(t_last, enter), hn::Lt(t_last, leave))), rest);
    }
    for (int a = 0; a < 3; ++a) {
      store_narrow(d, mul_add(along[a], t_first, start[a]), r.first[a] + n);
      store_narrow(d, hn::Mul(along[a], step), r.by[a] + n);
      store_narrow(d, mul_add(along[a], t_last, start[a]), r.last[a] + n);
      store_narrow(d, mul_add(along[a], enter, start[a]), r.entry[a] + n);
      store_narrow(d, along[a], r.along[a] + n);
    }
    store_narrow(d, direction.x, r.direction[0] + n), store_narrow(d, direction.y, r.direction[1] + n);
    store_narrow(d, direction.z, r.direction[2] + n);
    store_narrow(d, steps, r.steps + n), store_narrow(d, rest, r.rest + n), store_narrow(d, length, r.length + n);
    hn::Store(enter, d, r.enter + n), hn::Store(leave, d, r.leave + n);
    hn::Store(first_depth, d, r.first_depth + n), hn::Store(per_length, d, r.per_length + n);
  }
  return any;
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
