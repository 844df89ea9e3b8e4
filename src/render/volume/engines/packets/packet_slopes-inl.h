// SPDX-License-Identifier: Apache-2.0
// How fast the field changes at one place of each lane, and its value there: differences over two cells at the corners of a cell, trilinear
// between them, which is the central difference of the trilinear field itself.
#if defined(SG_PACKET_SLOPES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_SLOPES_INL_H
#undef SG_PACKET_SLOPES_INL_H
#else
#define SG_PACKET_SLOPES_INL_H
#endif

#include "render/volume/engines/packets/packet_around-inl.h"
#include "render/volume/engines/packets/ray_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// Derivatives in u.
template <class D>
struct Slope {
  Float<D> x, y, z;
  Float<D> per_cell;  ///< change of the value over the length of a cell
  Float<D> value;     ///< of the field, as Source::value() has it
};

template <class D, class T>
class SlopeFinder {
  using F = Float<D>;
  using I = Int<D>;

 public:
  HWY_INLINE SlopeFinder(const Source<D, T>& source, F x, F y, F z)
      : source_(source), at_{source.place(0, x), source.place(1, y), source.place(2, z)} {}
  HWY_INLINE SlopeFinder(const Source<D, T>& source, const Place<D> at[3]) : source_(source), at_{at[0], at[1], at[2]} {}

  HWY_INLINE Slope<D> find() const {
    const D d;
    const I cell[3] = {at_[0].cell, at_[1].cell, at_[2].cell};
    const Around<D, T> around(source_, cell);
    F change[3], value;
    find(around, change, value);
    if constexpr (std::is_same_v<T, float>) {
      const auto holes = is_nan(change[0] + (change[1] + change[2]));
      if (any(holes)) find_beside_holes(around, holes, change);
    }
    F slope[3], square = set(d, 0);
    for (int a = 0; a < 3; ++a) slope[a] = 0.5f * change[a], square = mul_add(slope[a], slope[a], square);
    return {slope[0], slope[1], slope[2], sqrt(square), value};
  }

 private:
  /// Along y and z first: what is left is four values in a row, and two differences of either.
  HWY_INLINE void find(const Around<D, T>& around, F change[3], F& value) const {
    const D d;
    const F fx = at_[0].fraction, fy = at_[1].fraction, fz = at_[2].fraction;
    F row[4], y[2], z[2];
    if (!rows_by_rays(around, row, y, z)) {
      Quad<D> own[4];
      Pair<D> beyond_y[4], beyond_z[4];
      around.rows(own), around.template beyond<1>(beyond_y), around.template beyond<2>(beyond_z);
      const Edge<D> edge_y = around.edge(1), edge_z = around.edge(2);
      row[0] = mixed(d, mixed(d, own[0].low.a, own[1].low.a, fy), mixed(d, own[2].low.a, own[3].low.a, fy), fz);
      row[3] = mixed(d, mixed(d, own[0].high.b, own[1].high.b, fy), mixed(d, own[2].high.b, own[3].high.b, fy), fz);
      for (int i = 0; i < 2; ++i) {
        F samples[12];
        for (int r = 0; r < 4; ++r) {
          samples[r] = i == 0 ? own[r].low.b : own[r].high.a;
          samples[4 + r] = i == 0 ? beyond_y[r].a : beyond_y[r].b;
          samples[8 + r] = i == 0 ? beyond_z[r].a : beyond_z[r].b;
        }
        const RowSums<D> sums(samples, fy, fz, edge_y, edge_z);
        row[1 + i] = sums.value, y[i] = sums.along_y, z[i] = sums.along_z;
      }
    }
    value = mixed(d, row[1], row[2], fx);
    change[0] = around.edge(0).change(row[0], row[1], row[2], row[3], fx);
    change[1] = mixed(d, y[0], y[1], fx), change[2] = mixed(d, z[0], z[1], fx);
  }

  /// The same with the rows of four rays in a vector, where numbers are loaded ray by ray anyway and no cell lies at the border.
  HWY_INLINE bool rows_by_rays([[maybe_unused]] const Around<D, T>& around, [[maybe_unused]] F value[4], [[maybe_unused]] F y[2],
                               [[maybe_unused]] F z[2]) const {
#if SG_HARDWARE_GATHERS
    if constexpr (std::is_same_v<T, float> && lanes_of<D> >= 8) {
      if (source_.loads && around.inner) {
        sums_of_rays(source_, around.corner(), at_[1].fraction, at_[2].fraction, value, y, z);
        return true;
      }
    }
#endif
    return false;
  }

  /// The slopes of those lanes by what Around's corners have without what is no number.
  HWY_NOINLINE void find_beside_holes(const Around<D, T>& around, Mask<D> which, F change[3]) const {
    const F f[3] = {at_[0].fraction, at_[1].fraction, at_[2].fraction};
    CornerChanges<D, T> changes;
    changes.find_beside_holes(around);
    for (int a = 0; a < 3; ++a) change[a] = select(which, changes.at(a, f), change[a]);
  }

  const Source<D, T>& source_;
  const Place<D> at_[3];
};

/// The slopes and values at the places of the lanes that want them; the others' are anything. Out of line: it is long.
template <class D, class T>
HWY_NOINLINE void slopes_of_most(const Source<D, T>& source, const Place<D> at[3], Mask<D> wanted, Slope<D>& out) {
  // Lanes that want none look at the middle, which is no border that would have to be looked after.
  const auto kept = rebind(IntTag<D>(), wanted);
  Place<D> p[3];
  for (int a = 0; a < 3; ++a) p[a] = {select(kept, at[a].cell, shift_right<1>(source.last_cell[a])), at[a].fraction};
  out = SlopeFinder<D, T>(source, p).find();
}

/// The same, found by vectors half as wide when those lanes are few.
template <class D, class T>
HWY_INLINE Slope<D> slopes_at(const Source<D, T>& source, [[maybe_unused]] const Voxels& voxels, const Float<D> u[3], Mask<D> wanted) {
  using F = Float<D>;
  F v[3];
  for (int a = 0; a < 3; ++a) v[a] = 0.5f * source.top[a];
#if SG_HARDWARE_GATHERS && HWY_TARGET <= HWY_AVX3
  if constexpr (lanes_of<D> == 16) {
    using H = hn::Half<D>;
    if (hn::CountTrue(D(), wanted) <= lanes_of<H>) {
      hn::Vec<H> few[3];
      for (int a = 0; a < 3; ++a) few[a].raw = _mm512_castps512_ps256(_mm512_mask_compress_ps(v[a].raw, wanted.raw, u[a].raw));
      const Slope<H> found = SlopeFinder<H, T>(Source<H, T>(voxels, source.within), few[0], few[1], few[2]).find();
      const auto back = [&](hn::Vec<H> x) HWY_ATTR { return F{_mm512_maskz_expand_ps(wanted.raw, _mm512_castps256_ps512(x.raw))}; };
      return {back(found.x), back(found.y), back(found.z), back(found.per_cell), back(found.value)};
    }
  }
#endif
  for (int a = 0; a < 3; ++a) v[a] = select(wanted, u[a], v[a]);
  return SlopeFinder<D, T>(source, v[0], v[1], v[2]).find();
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
