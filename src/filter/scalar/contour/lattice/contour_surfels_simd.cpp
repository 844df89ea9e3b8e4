// SPDX-License-Identifier: Apache-2.0
// Surfels of axis-parallel uniform grids, one cell per lane. No fused multiply-add: every target gives the same bits.
#include "filter/scalar/contour/lattice/contour_surfels.h"

#include <algorithm>
#include <cmath>

#include "base/bits.h"
#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/scalar/contour/lattice/contour_surfels_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/simd/vector-inl.h"

#include "filter/scalar/contour/lattice/contour_list-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::contouring::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

using DD = hn::ScalableTag<double>;
using DH = hn::Rebind<float, DD>;  // half as many as DF where there is more than one
using DHI = hn::Rebind<int32_t, DD>;
using DF = hn::ScalableTag<float>;
using DI = hn::ScalableTag<int32_t>;
using F = hn::Vec<DF>;
using I = hn::Vec<DI>;

template <class T>
HWY_INLINE F samples_at(const T* HWY_RESTRICT base, I offset, double value) {
  const DF d;
  if constexpr (std::is_same_v<T, float>) {
    return hn::GatherIndex(d, base, offset) - float(value);
  } else {
    HWY_ALIGN int32_t at[hn::MaxLanes(DI())];
    HWY_ALIGN float got[hn::MaxLanes(DF())];
    hn::Store(offset, DI(), at);
    for (size_t l = 0; l < hn::Lanes(d); ++l) got[l] = float(double(base[at[l]]) - value);
    return hn::Load(d, got);
  }
}

// The samples at the offsets and those behind them along x.
struct Two {
  F a, b;
};
template <class T>
HWY_INLINE Two pairs_at(const T* HWY_RESTRICT base, I offset, double value) {
#if HWY_TARGET <= HWY_AVX2 && HWY_ARCH_X86
  if constexpr (std::is_same_v<T, float>) {  // one load brings both
    const DF d;
    const hn::ScalableTag<int64_t> d64;
    const hn::Half<DI> half;
    const auto* wide = reinterpret_cast<const int64_t*>(base);
    const auto lo = bit_cast(d, hn::GatherOffset(d64, wide, shift_left<2>(hn::PromoteTo(d64, hn::LowerHalf(half, offset)))));
    const auto hi = bit_cast(d, hn::GatherOffset(d64, wide, shift_left<2>(hn::PromoteTo(d64, hn::UpperHalf(half, offset)))));
    const F v = set(d, float(value));
    return {hn::ConcatEven(d, hi, lo) - v, hn::ConcatOdd(d, hi, lo) - v};
  }
#endif
  return {samples_at(base, offset, value), samples_at(base + 1, offset, value)};
}

struct Corners {
  F f[8];
};
struct At {
  F value, x, y, z;  // and slopes
};

HWY_INLINE F mix(F a, F b, F t) { return a + (b - a) * t; }
HWY_INLINE At trilinear(const Corners& c, F u, F v, F w) {
  const F a = mix(c.f[0], c.f[1], u), b = mix(c.f[2], c.f[3], u), e = mix(c.f[4], c.f[5], u), g = mix(c.f[6], c.f[7], u);
  const F low = mix(a, b, v), high = mix(e, g, v);
  const F d0 = c.f[1] - c.f[0], d1 = c.f[3] - c.f[2], d2 = c.f[5] - c.f[4], d3 = c.f[7] - c.f[6];
  return {mix(low, high, w), mix(mix(d0, d1, v), mix(d2, d3, v), w), mix(b - a, g - e, w), high - low};
}
HWY_INLINE F within_cell(F u) {
  const F held = min(max(u, 0), 1.0f);
  return select(is_nan(u), 0.5f, held);
}

template <class T>
class Surfels {
 public:
  Surfels(const SurfelRows& rows, size_t begin) : r_(rows), f_(rows.samples.view<T>().data + begin * rows.nx), first_row_(begin) {}

  void add_row(size_t row) {
    const uint64_t* a = r_.inside + row * r_.words;
    const uint64_t *b = a + r_.words, *c = a + r_.words * r_.ny, *d = c + r_.words;
    const size_t words = r_.words;
    if (count_ == 0) next_ = r_.place[row];
    for (size_t w = 0; w < words; ++w) {
      const auto behind = [&](const uint64_t* q) { return q[w] >> 1 | (w + 1 < words ? q[w + 1] << 63 : 0); };
      const uint64_t as = behind(a), bs = behind(b), cs = behind(c), ds = behind(d);
      const uint64_t active =
          ((a[w] | as | b[w] | bs | c[w] | cs | d[w] | ds) & ~(a[w] & as & b[w] & bs & c[w] & cs & d[w] & ds)) & cell_bits(w, r_.nx);
      if (!active) continue;
      const size_t before = count_;
      count_ = list_bits(active, uint32_t((row - first_row_) * r_.nx + 64 * w), reinterpret_cast<uint32_t*>(from_), count_);
      for (size_t n = before; n < count_; ++n) {
        const T* p = f_ + from_[n] + r_.nx * r_.ny * 2;  // that plane is what is not in the cache yet
        __builtin_prefetch(p), __builtin_prefetch(p + r_.nx);
      }
      if (count_ >= room) flush();
    }
  }

  void flush() {
    const DF d;
    const size_t lanes = hn::Lanes(d), count = count_;
    for (size_t n = count; n < count + lanes; ++n) from_[n] = count ? from_[count - 1] : 0;
    size_t n = 0;
    for (; n + lanes <= count; n += lanes) make(n, r_.xyz + 3 * (next_ + n), r_.normals + 3 * (next_ + n));
    if (n < count) {
      float xyz[3 * hn::MaxLanes(DF())], normals[3 * hn::MaxLanes(DF())];
      make(n, xyz, normals);
      std::copy_n(xyz, 3 * (count - n), r_.xyz + 3 * (next_ + n));
      std::copy_n(normals, 3 * (count - n), r_.normals + 3 * (next_ + n));
    }
    if (r_.cells)
      for (size_t m = 0; m < count; ++m) {
        const size_t p = first_row_ * r_.nx + size_t(from_[m]), row = p / r_.nx;
        r_.cells[next_ + m] = int64_t(p % r_.nx + (r_.nx - 1) * (row % r_.ny + (r_.ny - 1) * (row / r_.ny)));
      }
    next_ += count;
    count_ = 0;
  }

 private:
  static constexpr size_t room = 1024;

  HWY_INLINE void make(size_t n, float* HWY_RESTRICT xyz, float* HWY_RESTRICT normals) {
    const DF d;
    const I from = hn::LoadU(DI(), from_ + n);
    Corners c;
    for (size_t k = 0; k < 4; ++k) {
      const Two two = pairs_at(f_ + (k & 1) * r_.nx + (k >> 1) * r_.nx * r_.ny, from, r_.value);
      c.f[2 * k] = two.a, c.f[2 * k + 1] = two.b;
    }
    // Two steps of Newton's method from the middle of the cell, along the gradient.
    const F half = set(d, 0.5f), one = set(d, 1.0f);
    F u = half, v = half, w = half;
    for (int step = 0; step < 2; ++step) {
      const At at = trilinear(c, u, v, w);
      const F square = at.x * at.x + at.y * at.y + at.z * at.z;
      const F move = only(square > 0, -(at.value / square));
      u = within_cell(u + at.x * move);
      v = within_cell(v + at.y * move);
      w = within_cell(w + at.z * move);
    }
    // Gradient there.
    HWY_ALIGN int32_t index[3][hn::MaxLanes(DI())];
    find_cells(n, index);
    const At at = smooth(c, from, index, u, v, w);
    // Against the gradient in space. Scaled by the largest part, so that no square is lost.
    F gx = at.x * float(-1 / r_.step.x), gy = at.y * float(-1 / r_.step.y), gz = at.z * float(-1 / r_.step.z);
    const F most = max(max(abs(gx), abs(gy)), abs(gz));
    const auto known = (most > 0) & (most < HUGE_VALF);
    const F scale = one / most;
    gx = gx * scale, gy = gy * scale, gz = gz * scale;
    const F size = one / sqrt(gx * gx + gy * gy + gz * gz);
    hn::StoreInterleaved3(only(known, gx * size), only(known, gy * size), select(known, gz * size, one), d, normals);
    // Places in space, in double precision.
    HWY_ALIGN float local[3][hn::MaxLanes(DF())];
    hn::Store(u, d, local[0]), hn::Store(v, d, local[1]), hn::Store(w, d, local[2]);
    for (size_t l = 0; l < hn::Lanes(d); l += hn::Lanes(DD())) {
      const DD dd;
      const DH dh;
      auto place = [&](double first, double step, int axis) {
        const auto cell = hn::PromoteTo(dd, hn::LoadU(DHI(), index[axis] + l));
        const auto at_cell = cell + hn::PromoteTo(dd, hn::LoadU(dh, local[axis] + l));
        return hn::DemoteTo(dh, first + step * at_cell);
      };
      hn::StoreInterleaved3(place(r_.first.x, r_.step.x, 0), place(r_.first.y, r_.step.y, 1), place(r_.first.z, r_.step.z, 2), dh,
                            xyz + 3 * l);
    }
  }

  // Columns, rows and slices of the cells n and so on: exact, since the quotients are half a sample away from whole numbers.
  HWY_INLINE void find_cells(size_t n, int32_t (*HWY_RESTRICT index)[hn::MaxLanes(DI())]) {
    const DD dd;
    const DHI di;
    const auto half = set(dd, 0.5), nx = set(dd, double(r_.nx)), ny = set(dd, double(r_.ny));
    for (size_t l = 0; l < hn::Lanes(DF()); l += hn::Lanes(dd)) {
      const auto p = hn::PromoteTo(dd, hn::LoadU(di, from_ + n + l));
      const auto row = floor((p + half) / nx), r = row + double(first_row_);
      const auto k = floor((r + half) / ny);
      hn::StoreU(hn::DemoteTo(di, p - row * nx), di, index[0] + l);
      hn::StoreU(hn::DemoteTo(di, r - k * ny), di, index[1] + l);
      hn::StoreU(hn::DemoteTo(di, k), di, index[2] + l);
    }
  }

  // Slopes from central differences at the corners, as contours have them, trilinear between those; cells at the border keep their own.
  HWY_INLINE At smooth(const Corners& c, I from, const int32_t (*HWY_RESTRICT index)[hn::MaxLanes(DI())], F u, F v, F w) {
    const DF d;
    const DI di;
    const At own = trilinear(c, u, v, w);
    const size_t nx = r_.nx, nxy = r_.nx * r_.ny;
    const F half = set(d, 0.5f);
    // The change over two cells of a line of samples: a, low, high, b.
    auto change = [](F a, F low, F high, F b, F t) { return mix(high, b, t) - mix(a, low, t); };
    auto choose = [&](size_t axis, size_t count, auto&& slope, F otherwise) {
      const I here = hn::Load(di, index[axis]);
      const auto inner = (here > 0) & (int32_t(count) - 2 > here);
      const I one = only(inner, set(di, int32_t(axis == 0 ? 1 : axis == 1 ? nx : nxy)));
      const F central = slope(from - one, from + one) * half;
      return select(hn::MaskFromVec(bit_cast(d, hn::VecFromMask(di, inner))), central, otherwise);
    };
    const F x = choose(
        0, r_.nx,
        [&](I before, I behind) {
          auto line = [&](size_t at, size_t k) {
            return change(samples_at(f_ + at, before, r_.value), c.f[k], c.f[k + 1], samples_at(f_ + at + 1, behind, r_.value), u);
          };
          return mix(mix(line(0, 0), line(nx, 2), v), mix(line(nxy, 4), line(nx + nxy, 6), v), w);
        },
        own.x);
    const F y = choose(
        1, r_.ny,
        [&](I before, I behind) {
          auto lines = [&](size_t at, size_t k) {
            const Two a = pairs_at(f_ + at, before, r_.value), b = pairs_at(f_ + at + nx, behind, r_.value);
            return mix(change(a.a, c.f[k], c.f[k + 2], b.a, v), change(a.b, c.f[k + 1], c.f[k + 3], b.b, v), u);
          };
          return mix(lines(0, 0), lines(nxy, 4), w);
        },
        own.y);
    const F z = choose(
        2, r_.nz,
        [&](I before, I behind) {
          auto lines = [&](size_t at, size_t k) {
            const Two a = pairs_at(f_ + at, before, r_.value), b = pairs_at(f_ + at + nxy, behind, r_.value);
            return mix(change(a.a, c.f[k], c.f[k + 4], b.a, w), change(a.b, c.f[k + 1], c.f[k + 5], b.b, w), u);
          };
          return mix(lines(0, 0), lines(nx, 2), v);
        },
        own.z);
    return {own.value, x, y, z};
  }

  const SurfelRows& r_;
  const T* f_;
  size_t first_row_, next_ = 0, count_ = 0;
  HWY_ALIGN int32_t from_[room + 160] = {};
};

template <class T>
void surfels_of(const SurfelRows& rows, size_t begin, size_t end) {
  Surfels<T> s(rows, begin);
  for (size_t r = begin; r < end; ++r)
    if (rows.place[r + 1] > rows.place[r]) s.add_row(r);
  s.flush();
}

void surfel_rows(const SurfelRows& rows, size_t begin, size_t end) {
  switch (rows.samples.type()) {
    case ElementType::u8: return surfels_of<uint8_t>(rows, begin, end);
    case ElementType::i8: return surfels_of<int8_t>(rows, begin, end);
    case ElementType::u16: return surfels_of<uint16_t>(rows, begin, end);
    case ElementType::i16: return surfels_of<int16_t>(rows, begin, end);
    case ElementType::f32: return surfels_of<float>(rows, begin, end);
    default: return surfels_of<double>(rows, begin, end);
  }
}

size_t cut_cells(const uint64_t* row, size_t words, size_t nx, size_t ny) {
  const uint64_t *a = row, *b = a + words, *c = a + words * ny, *d = c + words;
  size_t n = 0;
  for (size_t w = 0; w < words; ++w) {
    const auto behind = [&](const uint64_t* q) { return q[w] >> 1 | (w + 1 < words ? q[w + 1] << 63 : 0); };
    const uint64_t as = behind(a), bs = behind(b), cs = behind(c), ds = behind(d);
    n += size_t(hwy::PopCount(((a[w] | as | b[w] | bs | c[w] | cs | d[w] | ds) & ~(a[w] & as & b[w] & bs & c[w] & cs & d[w] & ds)) &
                              cell_bits(w, nx)));
  }
  return n;
}

}  // namespace sg::contouring::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::contouring {
HWY_EXPORT(surfel_rows);
HWY_EXPORT(cut_cells);
void make_surfels(const SurfelRows& rows, size_t begin, size_t end) { HWY_DYNAMIC_DISPATCH(surfel_rows)(rows, begin, end); }
size_t count_cut_cells(const uint64_t* row, size_t words, size_t nx, size_t ny) {
  return HWY_DYNAMIC_DISPATCH(cut_cells)(row, words, nx, ny);
}
}  // namespace sg::contouring
#endif
