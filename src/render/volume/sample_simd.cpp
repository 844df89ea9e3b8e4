// SPDX-License-Identifier: Apache-2.0
// Trilinear sampling with gathers, for volumes whose offsets fit 32 bits; the same bits as sample.cpp (no fused multiply-add).
#include "render/volume/volume_internal.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/volume/sample_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

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
using F = hn::Vec<D>;
using I = hn::Vec<DI>;

HWY_ATTR inline F mixed(F a, F b, F f) { return hn::Add(a, hn::Mul(f, hn::Sub(b, a))); }

/// The samples at offset and offset + 1.
struct Pair {
  F a, b;
};

HWY_ATTR inline Pair pair_f32(const float* data, I offset) {
  // One 64-bit load brings both; then even and odd places are told apart.
  const D d;
  const hn::ScalableTag<int64_t> d64;
  const hn::Half<DI> half;
  const auto* wide = reinterpret_cast<const int64_t*>(data);
  const auto lo = hn::GatherOffset(d64, wide, hn::ShiftLeft<2>(hn::PromoteTo(d64, hn::LowerHalf(half, offset))));
  const auto hi = hn::GatherOffset(d64, wide, hn::ShiftLeft<2>(hn::PromoteTo(d64, hn::UpperHalf(half, offset))));
  return {hn::ConcatEven(d, hn::BitCast(d, hi), hn::BitCast(d, lo)), hn::ConcatOdd(d, hn::BitCast(d, hi), hn::BitCast(d, lo))};
}

// Small integers: one 32-bit load brings both; near the end of the array it starts earlier and is shifted.
template <class T>
HWY_ATTR inline Pair pair_small(const T* data, I offset, I last_load) {
  const D d;
  const DI di;
  constexpr int bits = 8 * sizeof(T);
  const I byte = sizeof(T) == 2 ? hn::ShiftLeft<1>(offset) : offset;
  const I from = hn::Min(byte, last_load);
  const I skipped = hn::ShiftLeft<3>(hn::Sub(byte, from));
  const hn::RebindToUnsigned<DI> du;
  const I word = hn::BitCast(di, hn::Shr(hn::BitCast(du, hn::GatherOffset(di, reinterpret_cast<const int32_t*>(data), from)), hn::BitCast(du, skipped)));
  if constexpr (std::is_signed_v<T>) {
    const I a = hn::ShiftRight<32 - bits>(hn::ShiftLeft<32 - bits>(word)), b = hn::ShiftRight<32 - bits>(hn::ShiftLeft<32 - 2 * bits>(word));
    return {hn::ConvertTo(d, a), hn::ConvertTo(d, b)};
  } else {
    const I mask = hn::Set(di, (1 << bits) - 1);
    const I shifted = hn::BitCast(di, hn::ShiftRight<bits>(hn::BitCast(du, word)));
    return {hn::ConvertTo(d, hn::And(word, mask)), hn::ConvertTo(d, hn::And(shifted, mask))};
  }
}

template <class T>
HWY_ATTR void sample(const Voxels& voxels, const float* ux, const float* uy, const float* uz, float* values) {
  const D d;
  const DI di;
  const T* data = reinterpret_cast<const T*>(voxels.array.raw());
  const int nx = int(voxels.dims[0]), ny = int(voxels.dims[1]), nz = int(voxels.dims[2]);
  const I row = hn::Set(di, nx), layer = hn::Set(di, nx * ny), last_load = hn::Set(di, int(voxels.array.bytes()) - 4);
  const I last_x = hn::Set(di, nx - 2), last_y = hn::Set(di, ny - 2), last_z = hn::Set(di, nz - 2);
  const F zero = hn::Zero(d), top_x = hn::Set(d, float(nx - 1)), top_y = hn::Set(d, float(ny - 1)), top_z = hn::Set(d, float(nz - 1));
  const auto pair = [&](I offset) HWY_ATTR {
    if constexpr (std::is_same_v<T, float>) return pair_f32(data, offset);
    else return pair_small(data, offset, last_load);
  };
  for (size_t n = 0; n < size_t(run_length); n += hn::Lanes(d)) {
    const F x = hn::Max(zero, hn::Min(hn::Load(d, ux + n), top_x)), y = hn::Max(zero, hn::Min(hn::Load(d, uy + n), top_y)), z = hn::Max(zero, hn::Min(hn::Load(d, uz + n), top_z));
    const I i = hn::Min(hn::ConvertTo(di, x), last_x), j = hn::Min(hn::ConvertTo(di, y), last_y), k = hn::Min(hn::ConvertTo(di, z), last_z);
    const F fx = hn::Sub(x, hn::ConvertTo(d, i)), fy = hn::Sub(y, hn::ConvertTo(d, j)), fz = hn::Sub(z, hn::ConvertTo(d, k));
    const I at = hn::Add(i, hn::Add(hn::Mul(j, row), hn::Mul(k, layer)));
    const Pair p00 = pair(at), p01 = pair(hn::Add(at, row)), p10 = pair(hn::Add(at, layer)), p11 = pair(hn::Add(at, hn::Add(row, layer)));
    const F v0 = mixed(mixed(p00.a, p00.b, fx), mixed(p01.a, p01.b, fx), fy), v1 = mixed(mixed(p10.a, p10.b, fx), mixed(p11.a, p11.b, fx), fy);
    hn::Store(mixed(v0, v1, fz), d, values + n);
  }
}
#endif

SampleRun sampler(const Voxels& voxels) {
#if SG_GATHERS
  if (hn::Lanes(D()) <= size_t(run_length)) switch (voxels.array.type()) {
      case ElementType::u8: return sample<uint8_t>;
      case ElementType::i8: return sample<int8_t>;
      case ElementType::u16: return sample<uint16_t>;
      case ElementType::i16: return sample<int16_t>;
      case ElementType::f32: return sample<float>;
      default: break;
    }
#endif
  return scalar_sampler(voxels);
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {

HWY_EXPORT(sampler);

SampleRun best_sampler(const Voxels& voxels) {
  if (voxels.array.bytes() >= (size_t(1) << 31) || voxels.array.bytes() < 4 || voxels.array.count() >= (size_t(1) << 29)) return scalar_sampler(voxels);
  return HWY_DYNAMIC_DISPATCH(sampler)(voxels);
}

}  // namespace sg::volume
#endif
