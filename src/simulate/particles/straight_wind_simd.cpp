// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "base/vector_targets.h"
#include "simulate/particles/straight_wind.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulate/particles/straight_wind_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/simd/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::swarm::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

constexpr size_t together = 64;  // places whose memory is asked for before it is read

// Where they read: the number of the first of a cell's values, negative outside, and the shares of its upper sides.
struct Cells {
  HWY_ALIGN double first[together];
  HWY_ALIGN double share[3][together];
};

template <class D>
HWY_INLINE void find_cells(D d, const StraightGrid& g, const Vec3* x, size_t at, Cells& cells) {
  Float<D> p[3];
  hn::LoadInterleaved3(d, &x[at].x, p[0], p[1], p[2]);
  Mask<D> inside = p[0] == p[0];
  Float<D> first = set(d, 0.0);
  double stride = 3;
  for (int a = 0; a < 3; ++a) {
    const double last = double(g.dims[size_t(a)] - 1);
    const Float<D> q = (p[a] - g.origin[a]) * g.scale[a];
    const Mask<D> here = (q >= set(d, 0.0)) & (q <= set(d, last));
    inside = inside & here;
    // The last point belongs to the last cell. Beyond, any cell serves.
    const Float<D> held = select(here, q, set(d, 0.0)), cell = min(floor(held), last - 1);
    hn::Store(held - cell, d, cells.share[a] + at);
    first = first + cell * stride, stride *= last + 1;
  }
  hn::Store(select(inside, first, set(d, -1.0)), d, cells.first + at);
}

template <class V>
HWY_INLINE V mixed(V a, V b, float share) {
  return a + (b - a) * share;
}

// In a cell whose first values are at p; the fourth lane of a load reads one number beyond a pair of points.
HWY_INLINE void interpolate(const float* p, size_t row, size_t slice, float r, float s, float t, double* to, bool room) {
#if HWY_TARGET == HWY_SCALAR
  for (size_t c = 0; c < 3; ++c) {
    const auto mix = [](float a, float b, float share) { return a + share * (b - a); };
    const auto along = [c, r, mix](const float* a) { return mix(a[c], a[c + 3], r); };
    to[c] = double(mix(mix(along(p), along(p + row), s), mix(along(p + slice), along(p + slice + row), s), t));
  }
  (void)room;
#else
  const hn::FixedTag<float, 4> d4;
#if HWY_MAX_BYTES >= 32
  const hn::FixedTag<float, 8> d8;  // of the cell's lower and upper side
  const auto both = [&](const float* a) HWY_ATTR { return hn::Combine(d8, hn::LoadU(d4, a + slice), hn::LoadU(d4, a)); };
  const auto along = [&](const float* a) HWY_ATTR { return mixed(both(a), both(a + 3), r); };
  const auto sides = mixed(along(p), along(p + row), s);
  const auto sum = mixed(hn::LowerHalf(d4, sides), hn::UpperHalf(d4, sides), t);
  const auto wide = hn::PromoteTo(hn::FixedTag<double, 4>(), sum);
  if (room) return hn::StoreU(wide, hn::FixedTag<double, 4>(), to);
  HWY_ALIGN double out[4];
  hn::Store(wide, hn::FixedTag<double, 4>(), out);
#else
  const auto along = [&](const float* a) HWY_ATTR { return mixed(hn::LoadU(d4, a), hn::LoadU(d4, a + 3), r); };
  const auto side = [&](const float* a) HWY_ATTR { return mixed(along(a), along(a + row), s); };
  const auto sum = mixed(side(p), side(p + slice), t);
  HWY_ALIGN float out[4];
  hn::Store(sum, d4, out);
  (void)room;
#endif
  to[0] = double(out[0]), to[1] = double(out[1]), to[2] = double(out[2]);
#endif
}

void sample_all(const StraightGrid& g, const float* values, std::span<const Vec3> x, std::span<Vec3> u) {
  const hn::CappedTag<double, 8> d;
  const hn::CappedTag<double, 1> one;
  const size_t lanes = hn::Lanes(d), row = 3 * g.dims[0], slice = row * g.dims[1], all = slice * g.dims[2];
  Cells cells;
  for (size_t begin = 0; begin < x.size(); begin += together) {
    const size_t count = std::min(together, x.size() - begin);
    size_t k = 0;
    for (; k + lanes <= count; k += lanes) find_cells(d, g, x.data() + begin, k, cells);
    for (; k < count; ++k) find_cells(one, g, x.data() + begin, k, cells);
    for (k = 0; k < count; ++k) {
      const float* const p = values + std::max(int64_t(cells.first[k]), int64_t(0));
      __builtin_prefetch(p), __builtin_prefetch(p + row), __builtin_prefetch(p + slice), __builtin_prefetch(p + slice + row);
    }
    for (k = 0; k < count; ++k) {
      Vec3& to = u[begin + k];
      const int64_t first = int64_t(cells.first[k]);
      if (first < 0) {
        to = {};
        continue;
      }
      const float r = float(cells.share[0][k]), s = float(cells.share[1][k]), t = float(cells.share[2][k]);
      const size_t last = size_t(first) + slice + row;  // of its pairs of points
      if (last + 7 <= all) {
        interpolate(values + first, row, slice, r, s, t, &to.x, begin + k + 1 < x.size());
        continue;
      }
      // The values' last pair: what lies behind it is not read.
      float pairs[4][7] = {};
      for (size_t e = 0; e < 4; ++e) std::memcpy(pairs[e], values + first + (e & 1 ? row : 0) + (e & 2 ? slice : 0), 6 * sizeof(float));
      interpolate(pairs[0], 7, 14, r, s, t, &to.x, begin + k + 1 < x.size());
    }
  }
}

}  // namespace sg::swarm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::swarm {
HWY_EXPORT(sample_all);

void sample_straight(const StraightGrid& grid, const float* values, std::span<const Vec3> x, std::span<Vec3> u) {
  HWY_DYNAMIC_DISPATCH(sample_all)(grid, values, x, u);
}

}  // namespace sg::swarm
#endif
