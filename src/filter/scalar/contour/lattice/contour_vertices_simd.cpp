// SPDX-License-Identifier: Apache-2.0
// Points on the cut edges of axis-parallel uniform grids. The edges of some rows are listed first, in the order of the points; then
// each vector holds as many edges as it has lanes of double, wherever they lie. So no branch depends on the surface, and samples that
// are far from the cache are waited for together. No fused multiply-add: every target gives the same bits.
#include "filter/scalar/contour/lattice/contour_vertices.h"

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/scalar/contour/lattice/contour_vertices_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/simd/vector-inl.h"

#include "filter/scalar/contour/lattice/contour_list-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::contouring::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using DF = hn::Rebind<float, D>;
using DI = hn::Rebind<int32_t, D>;
using V = Float<D>;
using VF = hn::Vec<DF>;
using VI = hn::Vec<DI>;

// Samples at offsets from `base`, as double.
template <class T>
HWY_INLINE V samples_at(const T* HWY_RESTRICT base, VI offset) {
  const D d;
  if constexpr (std::is_same_v<T, float>) {
    return hn::PromoteTo(d, hn::GatherIndex(DF(), base, offset));
  } else {
    HWY_ALIGN int32_t at[hn::MaxLanes(D())];
    HWY_ALIGN double got[hn::MaxLanes(D())];
    hn::Store(offset, DI(), at);
    for (size_t l = 0; l < hn::Lanes(d); ++l) got[l] = double(base[at[l]]);
    return hn::Load(d, got);
  }
}

// Ends of edges, as offsets from the first point of the first row.
struct Edges {
  static constexpr size_t room = 1024;
  HWY_ALIGN int32_t from[room + 128] = {}, to[room + 128] = {};
  size_t count = 0;
};

template <class T>
class Rows {
 public:
  Rows(const PlainVertices& work, size_t begin)
      : work_(work), job_(work.job), f_(job_.samples.view<T>().data + begin * job_.frame.dims[0]), first_row_(begin) {}

  void add_row(size_t r) {
    const size_t nx = job_.frame.dims[0], ny = job_.frame.dims[1], j = r % ny, k = r / ny;
    const RowStart& row = job_.rows[r];
    const uint32_t all = row.cut[0] + row.cut[1] + row.cut[2];
    if (all == 0) return;
    const bool inner = !job_.normals || (j >= 1 && j + 2 < ny && k >= 1 && k + 2 < job_.frame.dims[2]);
    if (!inner) flush();
    if (!inner) return one_by_one(r);
    if (edges_.count == 0) next_ = row.vertex;
    const size_t words = job_.words;
    const auto first = uint32_t((r - first_row_) * nx);
    const uint64_t* a = job_.inside + r * words;
    for (int axis = 0; axis < 3; ++axis) {
      if (row.cut[axis] == 0) continue;
      const auto next = int32_t(job_.frame.stride[size_t(axis)]);
      if (job_.cut) {
        const uint64_t* cut = job_.cut[axis].data() + r * words;
        list(first, next, [=](size_t w) { return cut[w]; });
      } else if (axis == 0) {
        list(first, next, [=](size_t w) { return (a[w] ^ (a[w] >> 1 | (w + 1 < words ? a[w + 1] << 63 : 0))) & cell_bits(w, nx); });
      } else {
        const uint64_t* b = a + (axis == 1 ? words : words * ny);
        list(first, next, [=](size_t w) { return a[w] ^ b[w]; });
      }
    }
  }

  void flush() {
    const D d;
    const size_t lanes = hn::Lanes(d), count = edges_.count;
    size_t e = 0;
    for (; e + lanes <= count; e += lanes)
      make(e, lanes, job_.xyz + 3 * (next_ + e), job_.normals ? job_.normals + 3 * (next_ + e) : nullptr,
           job_.points ? job_.points + next_ + e : nullptr);
    if (e < count) {  // the rest, in a place of its own: points behind these may be another thread's
      constexpr size_t most = hn::MaxLanes(D());
      float xyz[3 * most], normals[3 * most];
      EdgePoint points[most];
      for (size_t l = count; l < e + lanes; ++l) edges_.from[l] = edges_.from[e], edges_.to[l] = edges_.to[e];
      make(e, count - e, xyz, job_.normals ? normals : nullptr, job_.points ? points : nullptr);
      const size_t v = next_ + e, n = count - e;
      std::copy_n(xyz, 3 * n, job_.xyz + 3 * v);
      if (job_.normals) std::copy_n(normals, 3 * n, job_.normals + 3 * v);
      if (job_.points) std::copy_n(points, n, job_.points + v);
    }
    for (const Odd& odd : odd_) work_.careful(work_.maker, next_ + odd.edge, odd.point, odd.axis);
    odd_.clear();
    next_ += count;
    edges_.count = 0;
  }

 private:
  struct Odd {
    size_t edge, point;
    int axis;
  };

  void one_by_one(size_t r) {
    const size_t nx = job_.frame.dims[0];
    size_t v = job_.rows[r].vertex;
    for (int axis = 0; axis < 3; ++axis) {
      if (job_.rows[r].cut[axis] == 0) continue;
      for (size_t w = 0; w < job_.words; ++w)
        for (uint64_t bits = cut_edges(job_, axis, r, w); bits; bits &= bits - 1)
          work_.careful(work_.maker, v++, r * nx + 64 * w + size_t(std::countr_zero(bits)), axis);
    }
  }

  // The set bits of a row.
  template <class Bits>
  HWY_INLINE void list(uint32_t first, int32_t next, Bits bits_of_word) {
    size_t count = edges_.count, begin = count;
    const auto name_ends = [&] {
      for (size_t e = begin; e < count; ++e) edges_.to[e] = edges_.from[e] + next;
    };
    for (size_t w = 0; w < job_.words; ++w) {
      count = list_bits(bits_of_word(w), first + uint32_t(64 * w), reinterpret_cast<uint32_t*>(edges_.from), count);
      if (HWY_LIKELY(count < Edges::room)) continue;
      name_ends();
      edges_.count = count;
      flush();
      count = begin = 0;
    }
    name_ends();
    edges_.count = count;
  }

  // Edges e to e + n, n <= lanes, where all lanes are written.
  HWY_INLINE void make(size_t e, size_t n, float* HWY_RESTRICT xyz, float* HWY_RESTRICT normals, EdgePoint* HWY_RESTRICT points) {
    const D d;
    const DF df;
    const DI di;
    const auto nx = double(job_.frame.dims[0]), ny = double(job_.frame.dims[1]);
    const V one = set(d, 1.0), half = set(d, 0.5);
    for (size_t l = 0; l < 8; ++l) __builtin_prefetch(f_ + edges_.from[e + 48 + l]), __builtin_prefetch(f_ + edges_.to[e + 48 + l]);
    const VI from = hn::LoadU(di, edges_.from + e), to = hn::LoadU(di, edges_.to + e);
    const V a = samples_at(f_, from), b = samples_at(f_, to);
    V t = (job_.value - a) / (b - a);
    t = select((t >= 0) & (t <= one), t, half);
    // Rows and columns from offsets: exact, since the quotients are half a sample away from whole numbers.
    const V p = hn::PromoteTo(d, from);
    const V row = floor((p + half) / nx), i = p - row * nx;
    const V r = row + double(first_row_);
    const V k = floor((r + half) / ny), j = r - k * ny;
    const V length = hn::PromoteTo(d, to - from);
    const auto along_x = length == one, along_y = length == nx;
    const auto along_z = !(along_x | along_y);
    auto place = [&](double first, double step, V index, auto along) { return hn::DemoteTo(df, first + step * (index + only(along, t))); };
    hn::StoreInterleaved3(place(work_.first.x, work_.step.x, i, along_x), place(work_.first.y, work_.step.y, j, along_y),
                          place(work_.first.z, work_.step.z, k, along_z), df, xyz);
    if (points) {
      const VI base = set(di, int32_t(uint32_t(first_row_ * job_.frame.dims[0])));
      hn::StoreInterleaved3(bit_cast(df, from + base), bit_cast(df, to + base), hn::DemoteTo(df, t), df, reinterpret_cast<float*>(points));
    }
    if (!normals) return;
    auto blend = [&](ptrdiff_t step, double scale) {
      const V at_a = samples_at(f_ + step, from) - samples_at(f_ - step, from);
      const V at_b = samples_at(f_ + step, to) - samples_at(f_ - step, to);
      return scale * (at_a + (at_b - at_a) * t);
    };
    const V gx = blend(1, work_.scale.x), gy = blend(job_.frame.stride[1], work_.scale.y), gz = blend(job_.frame.stride[2], work_.scale.z);
    const V square = gx * gx + gy * gy + gz * gz;
    const V size = -1.0 / sqrt(square);
    hn::StoreInterleaved3(hn::DemoteTo(df, gx * size), hn::DemoteTo(df, gy * size), hn::DemoteTo(df, gz * size), df, normals);
    // At the ends of rows differences are one-sided; a gradient of zero, or next to NaN, is also handled separately.
    const auto good = (square > 0) & (square < HUGE_VAL) & ((i >= one) & (i < nx - 2));
    if (HWY_LIKELY(all(good))) return;
    HWY_ALIGN uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, good, bytes);
    for (size_t l = 0; l < n; ++l) {
      if (bytes[l / 8] >> (l % 8) & 1) continue;
      const int32_t next = edges_.to[e + l] - edges_.from[e + l];
      const int axis = next == 1 ? 0 : next == int32_t(job_.frame.stride[1]) ? 1 : 2;
      odd_.push_back({e + l, size_t(edges_.from[e + l]) + first_row_ * job_.frame.dims[0], axis});
    }
  }

  const PlainVertices& work_;
  const VertexJob& job_;
  const T* f_;
  size_t first_row_, next_ = 0;
  Edges edges_;
  std::vector<Odd> odd_;
};

template <class T>
void rows(const PlainVertices& work, size_t begin, size_t end) {
  Rows<T> r(work, begin);
  for (size_t at = begin; at < end; ++at) r.add_row(at);
  r.flush();
}

void plain_vertices(const PlainVertices& work, size_t begin, size_t end) {
  switch (work.job.samples.type()) {
    case ElementType::u8: return rows<uint8_t>(work, begin, end);
    case ElementType::i8: return rows<int8_t>(work, begin, end);
    case ElementType::u16: return rows<uint16_t>(work, begin, end);
    case ElementType::i16: return rows<int16_t>(work, begin, end);
    case ElementType::f32: return rows<float>(work, begin, end);
    default: return rows<double>(work, begin, end);
  }
}

}  // namespace sg::contouring::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::contouring {
HWY_EXPORT(plain_vertices);
void make_plain_vertices(const PlainVertices& work, size_t begin, size_t end) { HWY_DYNAMIC_DISPATCH(plain_vertices)(work, begin, end); }
}  // namespace sg::contouring
#endif
