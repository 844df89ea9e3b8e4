// SPDX-License-Identifier: Apache-2.0
// What the rows of samples around a cell come to across them, for a vector of rays, or for the rows of some rays side by side in one: then
// four samples of a row are one load, and only the sums have to be told apart by place instead of by ray.
#if defined(SG_RAY_ROWS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_RAY_ROWS_INL_H
#undef SG_RAY_ROWS_INL_H
#else
#define SG_RAY_ROWS_INL_H
#endif

#include <cstdint>

#include "render/volume/engines/packets/packet_around-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// The value between the rows, and its differences over two cells along y and z.
template <class D>
struct RowSums {
  using F = Float<D>;
  F value, along_y, along_z;

  /// Of one place along x in the cell's own rows (as Source::corners has them), those beyond along y, and along z (Around::beyond).
  HWY_INLINE RowSums(const F s[12], F fy, F fz, const Edge<D>& edge_y, const Edge<D>& edge_z) {
    const D d;
    const F near = mixed(d, s[0], s[1], fy), far = mixed(d, s[2], s[3], fy);
    value = mixed(d, near, far, fz);
    along_y = mixed(d, edge_y.change(s[4], s[0], s[1], s[6], fy), edge_y.change(s[5], s[2], s[3], s[7], fy), fz);
    along_z = edge_z.change(mixed(d, s[8], s[9], fy), near, far, mixed(d, s[10], s[11], fy), fz);
  }
};

#if SG_HARDWARE_GATHERS
/// Four numbers each of rays n, 4 + n, ...
template <class D>
HWY_INLINE Float<D> blocks_of(D, const float* data, const int32_t* at) {
  const __m256 two = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(data + at[0])), _mm_loadu_ps(data + at[4]), 1);
#if HWY_TARGET <= HWY_AVX3
  if constexpr (lanes_of<D> == 16) {
    const __m512 three = _mm512_insertf32x4(_mm512_castps256_ps512(two), _mm_loadu_ps(data + at[8]), 2);
    return Float<D>{_mm512_insertf32x4(three, _mm_loadu_ps(data + at[12]), 3)};
  }
#endif
  if constexpr (lanes_of<D> == 8) return Float<D>{two};
}

/// RowSums around inner cells: the values at all four places along x, and the differences at the cell's own two.
template <class D>
HWY_INLINE void sums_of_rays(const Source<D, float>& source, Int<D> corner, Float<D> fy, Float<D> fz, Float<D> value[4], Float<D> y[2],
                             Float<D> z[2]) {
  using F = Float<D>;
  const D d;
  const ptrdiff_t row = source.to_row, layer = source.to_layer;
  // As RowSums has them.
  const ptrdiff_t on[12] = {0,      row,         layer,     layer + row,    -row, layer - row, 2 * row, 2 * row + layer,
                            -layer, row - layer, 2 * layer, 2 * layer + row};
  alignas(64) int32_t at[lanes_of<D>];
  hn::Store(corner, IntTag<D>(), at);
  F v[4], dy[4], dz[4];
  const Edge<D> inner{hn::MaskFromVec(set(d, 0)), hn::MaskFromVec(set(d, 0)), true};
  const auto group = [&]<int n>() HWY_ATTR {
    F s[12];
    for (int r = 0; r < 12; ++r) s[r] = blocks_of(d, source.data - 1 + on[r], at + n);
    const RowSums<D> sums(s, hn::Broadcast<n>(fy), hn::Broadcast<n>(fz), inner, inner);
    v[n] = sums.value, dy[n] = sums.along_y, dz[n] = sums.along_z;
  };
  group.template operator()<0>(), group.template operator()<1>(), group.template operator()<2>(), group.template operator()<3>();
  const auto a = shuffled<0x44>(v[0].raw, v[1].raw), b = shuffled<0x44>(v[2].raw, v[3].raw);
  const auto c = shuffled<0xEE>(v[0].raw, v[1].raw), e = shuffled<0xEE>(v[2].raw, v[3].raw);
  value[0] = F{shuffled<0x88>(a, b)}, value[1] = F{shuffled<0xDD>(a, b)};
  value[2] = F{shuffled<0x88>(c, e)}, value[3] = F{shuffled<0xDD>(c, e)};
  const auto middle = [](const F from[4], F to[2]) HWY_ATTR {
    const auto one = shuffled<0x99>(from[0].raw, from[1].raw), two = shuffled<0x99>(from[2].raw, from[3].raw);
    to[0] = F{shuffled<0x88>(one, two)}, to[1] = F{shuffled<0xDD>(one, two)};
  };
  middle(dy, y), middle(dz, z);
}
#endif

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
