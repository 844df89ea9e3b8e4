// SPDX-License-Identifier: Apache-2.0
// The kernels with gathers, for volumes whose offsets fit 32 bits; the same bits as kernels.cpp (no fused multiply-add).
#include "render/volume/sources/lattice/kernels.h"

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/volume/sources/lattice/kernels_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/simd/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

// Gathers pay where the machine has them and vectors are not wider than a run.
#undef SG_GATHERS
#if HWY_TARGET <= HWY_AVX2 && HWY_ARCH_X86
#define SG_GATHERS 1
#else
#define SG_GATHERS 0
#endif

#if SG_GATHERS
using D = hn::ScalableTag<float>;
using DI = hn::ScalableTag<int32_t>;
using F = Float<D>;
using I = hn::Vec<DI>;

HWY_ATTR inline F mixed(F a, F b, F f) { return a + f * (b - a); }

/// The samples at offset and offset + 1.
struct Pair {
  F a, b;
};

HWY_ATTR inline Pair pair_f32(const float* data, I offset) {
  // One 64-bit load brings both; then even and odd places are distinguished.
  const D d;
  const hn::ScalableTag<int64_t> d64;
  const hn::Half<DI> half;
  const auto* wide = reinterpret_cast<const int64_t*>(data);
  const auto lo = hn::GatherOffset(d64, wide, shift_left<2>(hn::PromoteTo(d64, hn::LowerHalf(half, offset))));
  const auto hi = hn::GatherOffset(d64, wide, shift_left<2>(hn::PromoteTo(d64, hn::UpperHalf(half, offset))));
  return {hn::ConcatEven(d, bit_cast(d, hi), bit_cast(d, lo)), hn::ConcatOdd(d, bit_cast(d, hi), bit_cast(d, lo))};
}

// Small integers: one 32-bit load brings both; near the end of the array it starts earlier and is shifted.
template <class T>
HWY_ATTR inline Pair pair_small(const T* data, I offset, I last_load) {
  const D d;
  const DI di;
  constexpr int bits = 8 * sizeof(T);
  const I byte = sizeof(T) == 2 ? shift_left<1>(offset) : offset;
  const I from = min(byte, last_load);
  const I skipped = shift_left<3>(byte - from);
  const hn::RebindToUnsigned<DI> du;
  const I word =
      bit_cast(di, hn::Shr(bit_cast(du, hn::GatherOffset(di, reinterpret_cast<const int32_t*>(data), from)), bit_cast(du, skipped)));
  if constexpr (std::is_signed_v<T>) {
    const I a = hn::ShiftRight<32 - bits>(hn::ShiftLeft<32 - bits>(word)),
            b = hn::ShiftRight<32 - bits>(hn::ShiftLeft<32 - 2 * bits>(word));
    return {convert(d, a), convert(d, b)};
  } else {
    const I mask = set(di, (1 << bits) - 1);
    const I shifted = bit_cast(di, shift_right<bits>(bit_cast(du, word)));
    return {convert(d, word & mask), convert(d, shifted & mask)};
  }
}

/// A place along one axis: the cell and the fraction of its edge.
struct Place {
  I cell;
  F fraction;
};
HWY_ATTR inline Place place(F u, float top) {
  const D d;
  const DI di;
  const F x = max(0, min(u, top));
  const I cell = min(convert(di, x), int(top) - 1);
  return {cell, x - convert(d, cell)};
}

/// The lattice, ready for gathers.
template <class T>
struct Source {
  const T* data;
  I row, layer, last_load;
  float top[3];

  HWY_ATTR explicit Source(const Voxels& voxels) : data(reinterpret_cast<const T*>(voxels.array.raw())) {
    const DI di;
    row = set(di, int(voxels.dims[0])), layer = set(di, int(voxels.dims[0] * voxels.dims[1]));
    last_load = set(di, int(voxels.array.bytes()) - 4);
    for (size_t a = 0; a < 3; ++a) top[a] = float(voxels.dims[a] - 1);
  }
  HWY_ATTR Pair pair(I offset) const {
    if constexpr (std::is_same_v<T, float>) return pair_f32(data, offset);
    else return pair_small(data, offset, last_load);
  }
  HWY_ATTR F value(const Place& x, const Place& y, const Place& z) const {
    const I at = x.cell + (y.cell * row + z.cell * layer);
    const Pair p00 = pair(at), p01 = pair(at + row), p10 = pair(at + layer), p11 = pair(at + (row + layer));
    const F v0 = mixed(mixed(p00.a, p00.b, x.fraction), mixed(p01.a, p01.b, x.fraction), y.fraction);
    const F v1 = mixed(mixed(p10.a, p10.b, x.fraction), mixed(p11.a, p11.b, x.fraction), y.fraction);
    return mixed(v0, v1, z.fraction);
  }
};

template <class T>
HWY_ATTR void sample(const Voxels& voxels, const float* ux, const float* uy, const float* uz, float* values) {
  const D d;
  const Source<T> source(voxels);
  for (size_t n = 0; n < size_t(run_length); n += hn::Lanes(d))
    hn::Store(source.value(place(hn::Load(d, ux + n), source.top[0]), place(hn::Load(d, uy + n), source.top[1]),
                           place(hn::Load(d, uz + n), source.top[2])),
              d, values + n);
}

/// The derivative along an axis in its outermost cells; anything elsewhere.
template <class T>
HWY_ATTR HWY_NOINLINE F slope_at_border(const Source<T>& source, const Place here[3], int axis, F at) {
  const D d;
  const F zero = set(d, 0), top = set(d, source.top[axis]), half = set(d, 0.5f);
  const auto first = at < 1.0f;
  F value[3];  // in the three outermost layers, inwards
  for (int i = 0; i < 3; ++i) {
    const F n = set(d, float(i)), layer = max(zero, select(first, min(n, top), top - n));
    const Place p = place(layer, source.top[axis]);
    value[i] = source.value(axis == 0 ? p : here[0], axis == 1 ? p : here[1], axis == 2 ? p : here[2]);
  }
  const F over = select(first, value[1] - value[0], value[0] - value[1]);
  F inner = half * select(first, value[2] - value[0], value[0] - value[2]);
  inner = select((inner == inner) & (top >= 2.0f), inner, over);
  const F border = over + over - inner;
  return mixed(border, inner, select(first, at, top - at));
}

template <class T>
HWY_ATTR void gradients(const Voxels& voxels, const float* const u[3], const float* centre, Gradients& out) {
  const D d;
  const Source<T> source(voxels);
  float* result[3] = {out.x, out.y, out.z};
  const F one = set(d, 1.0f), half = set(d, 0.5f);
  for (size_t n = 0; n < size_t(run_length); n += hn::Lanes(d)) {
    const F middle = hn::Load(d, centre + n);
    const Place here[3] = {place(hn::Load(d, u[0] + n), source.top[0]), place(hn::Load(d, u[1] + n), source.top[1]),
                           place(hn::Load(d, u[2] + n), source.top[2])};
    F square = set(d, 0);
    for (int a = 0; a < 3; ++a) {
      const F top = set(d, source.top[a]), at = max(0, min(hn::Load(d, u[a] + n), top));
      const F below = max(at - one, 0), above = min(at + one, top);
      const Place p = place(below, source.top[a]), q = place(above, source.top[a]);
      // Central difference, one-sided at the border and beside holes.
      F lo = source.value(a == 0 ? p : here[0], a == 1 ? p : here[1], a == 2 ? p : here[2]);
      F hi = source.value(a == 0 ? q : here[0], a == 1 ? q : here[1], a == 2 ? q : here[2]);
      F length = above - below;
      const auto lo_good = lo == lo, hi_good = hi == hi;
      length = select(lo_good, length, length * half);
      length = select(hi_good, length, length * half);
      lo = select(lo_good, lo, middle), hi = select(hi_good, hi, middle);
      F slope = (hi - lo) / length;
      // In the outermost cells the slope goes on as inside.
      const auto outermost = (at < one) | (at > top - one);
      if (any(outermost)) {
        const F mended = slope_at_border(source, here, a, at);
        slope = select(outermost & (mended == mended), mended, slope);
      }
      hn::Store(slope, d, result[a] + n);
      square = square + slope * slope;
    }
    hn::Store(sqrt(square), d, out.per_cell + n);
  }
}

template <class T>
Kernels kernels_for() {
  return {sample<T>, gradients<T>};
}
#endif

Kernels kernels(const Voxels& voxels) {
#if SG_GATHERS
  if (hn::Lanes(D()) <= size_t(run_length)) switch (voxels.array.type()) {
      case ElementType::u8: return kernels_for<uint8_t>();
      case ElementType::i8: return kernels_for<int8_t>();
      case ElementType::u16: return kernels_for<uint16_t>();
      case ElementType::i16: return kernels_for<int16_t>();
      case ElementType::f32: return kernels_for<float>();
      default: break;
    }
#endif
  return scalar_kernels(voxels);
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {

HWY_EXPORT(kernels);

Kernels best_kernels(const Voxels& voxels) {
  if (voxels.array.bytes() >= (size_t(1) << 31) || voxels.array.bytes() < 4 || voxels.array.count() >= (size_t(1) << 29))
    return scalar_kernels(voxels);
  return HWY_DYNAMIC_DISPATCH(kernels)(voxels);
}

}  // namespace sg::volume
#endif
