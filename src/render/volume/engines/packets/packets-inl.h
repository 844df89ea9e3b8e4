// SPDX-License-Identifier: Apache-2.0
// Vector code that all kinds of packets share; included once per target, after highway.h. D is the tag of a packet: one lane per ray.
// Only IEEE operations in a fixed order, fused where it says so (the compiler fuses none): the same bits for any number of lanes.
#if defined(SG_PACKETS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKETS_INL_H
#undef SG_PACKETS_INL_H
#else
#define SG_PACKETS_INL_H
#endif

#include "render/shade/exp-inl.h"
#include "render/volume/engines/packets/gathers-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;
using shading::HWY_NAMESPACE::exp_minus;

template <class D>
HWY_INLINE Float<D> mixed(D, Float<D> a, Float<D> b, Float<D> f) {
  return mul_add(f, b - a, a);
}

template <class D>
HWY_INLINE Int<D> to_int(D, Float<D> v) {
  return truncated(v);
}

/// 1 / sqrt(x) to a part in 500, x > 1e-38.
template <class D>
HWY_INLINE Float<D> about_one_by_sqrt(D d, Float<D> x) {
  const IntTag<D> di;
  const auto y = bit_cast(d, 0x5F3759DF - shift_right<1>(bit_cast(di, x)));
  return y * neg_mul_add(0.5f * x, y * y, 1.5f);
}

/// A place along one axis: the cell and the fraction of its edge.
template <class D>
struct Place {
  Int<D> cell;
  Float<D> fraction;
};

/// The lattice, ready for gathers. T: float, or SmallInteger.
template <class D, class T>
struct Source {
  const T* data;
  Int<D> row, layer;
  Integers<D> integers;
  Float<D> top[3];
  Int<D> last_cell[3];
  ptrdiff_t to_row, to_layer;  ///< row and layer as numbers of samples
  bool loads;                  ///< of gathers.h
  bool within;                 ///< no place that is asked for lies beyond the outermost samples, but for rounding

  HWY_INLINE explicit Source(const Voxels& voxels, bool all_within = false)
      : data(reinterpret_cast<const T*>(voxels.array.raw())),
        integers(voxels.array.bytes(), element_size(voxels.array.type()), has_sign(voxels.array.type())),
        loads(loads_beat_gathers()),
        within(all_within) {
    const D d;
    const IntTag<D> di;
    to_row = ptrdiff_t(voxels.dims[0]), to_layer = ptrdiff_t(voxels.dims[0] * voxels.dims[1]);
    row = set(di, int(to_row)), layer = set(di, int(to_layer));
    for (size_t a = 0; a < 3; ++a) top[a] = set(d, float(voxels.dims[a] - 1)), last_cell[a] = set(di, int(voxels.dims[a]) - 2);
  }
  HWY_INLINE Place<D> place(int axis, Float<D> u) const {
    const D d;
    if (!within) u = max(0, min(u, top[axis]));
    const auto cell = min(to_int(d, u), last_cell[axis]);
    return {cell, u - convert(d, cell)};
  }
  /// For places that are known to lie in [0, top).
  HWY_INLINE Place<D> inner_place(Float<D> u) const {
    const D d;
    const auto cell = to_int(d, u);
    return {cell, u - convert(d, cell)};
  }
  HWY_INLINE Int<D> offset(Int<D> i, Int<D> j, Int<D> k) const { return i + (j * row + k * layer); }
  /// Pairs so many samples on from `at`, the same for all lanes.
  template <size_t n, class At>
  HWY_INLINE void pairs(At at, const ptrdiff_t (&on)[n], Pair<D>* out) const {
    if constexpr (std::is_same_v<T, float>) gather_pairs(D(), data, on, at, loads, out);
    else if (integers.two_bytes) gather_pairs(D(), reinterpret_cast<const uint16_t*>(data), on, at, integers, loads, out);
    else gather_pairs(D(), reinterpret_cast<const uint8_t*>(data), on, at, integers, loads, out);
  }
  /// Four samples in a row each.
  template <size_t n>
  HWY_INLINE void quads(Int<D> at, const ptrdiff_t (&on)[n], Quad<D>* out) const {
    if constexpr (std::is_same_v<T, float>) gather_quads(D(), data, on, at, loads, out);
    else if (integers.two_bytes) gather_quads(D(), reinterpret_cast<const uint16_t*>(data), on, at, integers, loads, out);
    else gather_quads(D(), reinterpret_cast<const uint8_t*>(data), on, at, integers, loads, out);
  }
  /// The corners of the cell whose lowest one is there: its rows (0, 0), (1, 0), (0, 1), (1, 1) along y and z.
  template <class At>
  HWY_INLINE void corners(At lowest, Pair<D> rows[4]) const {
    pairs(lowest, {0, to_row, to_layer, to_layer + to_row}, rows);
  }
  HWY_INLINE Float<D> value(const Place<D>& x, const Place<D>& y, const Place<D>& z) const {
    return value(offset(x.cell, y.cell, z.cell), x.fraction, y.fraction, z.fraction);
  }
  /// At the fractions of the cell whose lowest corner is sample `at`. Along x last, as SlopeFinder does: the same bits.
  template <class At>
  HWY_INLINE Float<D> value(At at, Float<D> fx, Float<D> fy, Float<D> fz) const {
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
  static HWY_INLINE Float<D> across(Float<D> v0, Float<D> v1, Float<D> v2, Float<D> v3, Float<D> fy, Float<D> fz) {
    const D d;
    return mixed(d, mixed(d, v0, v1, fy), mixed(d, v2, v3, fy), fz);
  }
  /// Both values along x where numbers are loaded lane by lane: their rows are mixed while the pairs are side by side.
  template <class At>
  HWY_INLINE bool value_of_loads([[maybe_unused]] At at, [[maybe_unused]] Float<D> fy, [[maybe_unused]] Float<D> fz,
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
  Float<DD> x, y, z;
};
template <class DD>
HWY_INLINE V3<DD> set3(DD d, Vec3 v) {
  return {set(d, v.x), set(d, v.y), set(d, v.z)};
}
template <class DD>
HWY_INLINE Float<DD> dot3(DD, const V3<DD>& a, const V3<DD>& b) {
  return mul_add(a.z, b.z, mul_add(a.y, b.y, a.x * b.x));
}
template <class DD>
HWY_INLINE V3<DD> plus(DD, const V3<DD>& a, const V3<DD>& b, Float<DD> s) {
  return {mul_add(b.x, s, a.x), mul_add(b.y, s, a.y), mul_add(b.z, s, a.z)};
}
template <class DD>
HWY_INLINE void store_narrow(DD, Float<DD> v, float* to) {
  const hn::Rebind<float, DD> df;
  hn::StoreU(hn::DemoteTo(df, v), df, to);
}

/// The rays through the pixels from (x, y) on, as far as they lie in the tile; false when none meets the volume.
template <class D, class Plan>
HWY_INLINE bool set_up(const Plan& plan, int x, int y, int x1, int y1, const Frame& frame, RayPacket& r) {
  constexpr int lanes = lanes_of<D>, width = packet_width<D>;
  using DD = hn::CappedTag<double, lanes>;
  const DD d;
  using V = Float<DD>;
  const Projection& p = plan.projection;
  const Volume& v = plan.volume;
  const LatticePart* const part = part_of(plan);
  alignas(64) double px[lanes], py[lanes], depth[lanes];
  for (int n = 0; n < lanes; ++n) {
    const int i = x + n % width, j = y + n / width;
    px[n] = i + 0.5, py[n] = j + 0.5;
    r.inside[n] = i < x1 && j < y1;
    r.pixel[n] = r.inside[n] ? size_t(j) * size_t(frame.width) + size_t(i) : 0;
    depth[n] = r.inside[n] ? std::min(p.far_plane, double(frame.depth[r.pixel[n]])) : -HUGE_VAL;
    r.before[n] = part && r.inside[n] ? 1 - frame.rgba[4 * r.pixel[n] + 3] : 1;
    if (part && r.before[n] < part->stop_below) depth[n] = -HUGE_VAL;
  }
  const Mat3& m = v.to_q;
  const V zero = set(d, 0);
  bool meets = false;
  for (size_t n = 0; n < size_t(lanes); n += hn::Lanes(d)) {
    // Ray: origin and direction in the world, near and far plane along it.
    const V sx = (hn::Load(d, px + n) - p.middle_x()) / p.scale;
    const V sy = (p.middle_y() - hn::Load(d, py + n)) / p.scale;
    const V3<DD> eye = set3(d, p.eye), right = set3(d, p.right), up = set3(d, p.up), forward = set3(d, p.forward);
    V3<DD> origin = eye, direction = forward;
    if (p.parallel) {
      origin = plus(d, plus(d, eye, right, sx), up, sy);
    } else {
      direction = plus(d, plus(d, forward, right, sx), up, sy);
      const V length = sqrt(dot3(d, direction, direction));
      direction = {direction.x / length, direction.y / length, direction.z / length};
    }
    const V per_length = dot3(d, direction, forward);
    const V first_depth = dot3(d, V3<DD>{origin.x - eye.x, origin.y - eye.y, origin.z - eye.z}, forward);
    V enter = (p.near_plane - first_depth) / per_length;
    V leave = (hn::Load(d, depth + n) - first_depth) / per_length;
    // Box of the lattice (slabs), then clip planes.
    const V3<DD> away{origin.x - v.origin.x, origin.y - v.origin.y, origin.z - v.origin.z};
    V start[3], along[3], first_enter = enter, last_leave = leave;  // of all lattices
    for (int a = 0; a < 3; ++a) {
      const V3<DD> line = set3(d, Vec3{m.m[a][0], m.m[a][1], m.m[a][2]});
      start[a] = dot3(d, line, away), along[a] = dot3(d, line, direction);
      const V lo = set(d, v.lo[a]), hi = set(d, v.hi[a]);
      const auto still = along[a] == zero;
      const auto outside = (start[a] < lo) | (start[a] > hi);
      const V t0 = (lo - start[a]) / along[a], t1 = (hi - start[a]) / along[a];
      enter = select(still, enter, max(enter, min(t0, t1)));
      leave = select(still, leave, min(leave, max(t0, t1)));
      leave = select(still & outside, -HUGE_VAL, leave);
      if (!part) continue;
      const V w0 = (part->whole_lo[a] - start[a]) / along[a], w1 = (part->whole_hi[a] - start[a]) / along[a];
      first_enter = select(still, first_enter, max(first_enter, min(w0, w1)));
      last_leave = select(still, last_leave, min(last_leave, max(w0, w1)));
    }
    for (const ClipPlane& plane : plan.clip) {
      const V3<DD> normal = set3(d, plane.normal);
      const V along_normal = dot3(d, normal, direction), rest = plane.offset - dot3(d, normal, origin);
      const V at = rest / along_normal;
      leave = select(along_normal > zero, min(leave, at), leave);
      enter = select(along_normal < zero, max(enter, at), enter);
      const auto outside = (along_normal == zero) & (rest < zero);
      leave = select(outside, -HUGE_VAL, leave);
    }
    const auto hit = leave > enter;
    meets = meets || any(hit);
    // A ray that misses has no steps; its places are unused, but must stay finite.
    const V length = only(hit, leave - enter), step = set(d, v.step);
    V steps = floor(length / step);
    V rest = max(zero, neg_mul_add(steps, step, length));
    const V half = set(d, 0.5);
    enter = only(hit, enter), leave = only(hit, leave);
    V t_first = mul_add(half, step, enter), t_last = neg_mul_add(half, rest, leave);
    if (part) {
      // Steps of the whole whose middles lie in this part.
      first_enter = only(hit, first_enter), last_leave = only(hit, last_leave);
      const V all = last_leave - first_enter, count = floor(all / step);
      const auto number = [&](V t) HWY_ATTR { return min(count, ceil((t - first_enter) / step - half)); };
      const V begin = number(enter);
      steps = only(hit, max(zero, number(leave) - begin));
      t_first = mul_add(begin + half, step, first_enter);
      rest = max(zero, neg_mul_add(count, step, all));
      t_last = neg_mul_add(half, rest, last_leave);
      rest = only(hit & ((t_last >= enter) & (t_last < leave)), rest);
    }
    // Places and steps in the lattice, as floats.
    for (int a = 0; a < 3; ++a) {
      store_narrow(d, mul_add(along[a], t_first, start[a]), r.first[a] + n);
      store_narrow(d, along[a] * step, r.by[a] + n);
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
  return meets;
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
