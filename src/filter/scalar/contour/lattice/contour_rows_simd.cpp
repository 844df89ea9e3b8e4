// SPDX-License-Identifier: Apache-2.0
// Rows of bits to triangles. Counting uses only bits: a cell that is cut in one piece has two triangles less than cut edges.
// Writing takes a vector for the numbers of a cell's edges and shuffles it into all of its triangles at once.
#include "filter/scalar/contour/lattice/contour_rows.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>

#include "base/bits.h"
#include "base/vector_targets.h"
#include "filter/scalar/contour/cells/cell_cases.h"
#include "filter/scalar/contour/cells/trilinear_cell.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/scalar/contour/lattice/contour_rows_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/simd/vector-inl.h"

#include "filter/scalar/contour/lattice/contour_list-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::contouring::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

// One word of a row of bits, and the same shifted so that bit i is that of point i+1.
struct Twice {
  uint64_t m, s;
};
HWY_INLINE Twice twice(const uint64_t* row, size_t w, size_t words) {
  return {row[w], row[w] >> 1 | (w + 1 < words ? row[w + 1] << 63 : 0)};
}
HWY_INLINE uint32_t ones(uint64_t v) { return uint32_t(hwy::PopCount(v)); }

size_t triangle_count(const RowBits& rows, uint64_t* HWY_RESTRICT odd, bool& any_odd) {
  size_t total = 0;
  uint64_t all_odd = 0;
  for (size_t w = 0; w < rows.words; ++w) {
    const Twice a = twice(rows.row[0], w, rows.words), b = twice(rows.row[1], w, rows.words), c = twice(rows.row[2], w, rows.words),
                d = twice(rows.row[3], w, rows.words);
    const uint64_t active =
        ((a.m | a.s | b.m | b.s | c.m | c.s | d.m | d.s) & ~(a.m & a.s & b.m & b.s & c.m & c.s & d.m & d.s)) & cell_bits(w, rows.points);
    odd[w] = 0;
    if (!active) continue;
    const uint64_t x0 = a.m ^ a.s, x2 = b.m ^ b.s, x4 = c.m ^ c.s, x6 = d.m ^ d.s;  // named by the edge's first corner
    const uint64_t y0 = a.m ^ b.m, y1 = a.s ^ b.s, y4 = c.m ^ d.m, y5 = c.s ^ d.s;
    const uint64_t z0 = a.m ^ c.m, z1 = a.s ^ c.s, z2 = b.m ^ d.m, z3 = b.s ^ d.s;
    // On an ambiguous face all edges are cut. Isolated corners at the ends of a diagonal: their three edges are all cut.
    const uint64_t faces = (x0 & x2 & y0) | (x4 & x6 & y4) | (x0 & x4 & z0) | (x2 & x6 & z2) | (y0 & y4 & z0) | (y1 & y5 & z1);
    const uint64_t ends =
        (x0 & y0 & z0 & x6 & y5 & z3) | (x0 & y1 & z1 & x6 & y4 & z2) | (x2 & y0 & z2 & x4 & y5 & z1) | (x2 & y1 & z3 & x4 & y4 & z0);
    const uint64_t other = (faces | ends) & active, plain = active & ~other;
    odd[w] = other;
    all_odd |= other;
    total += ones(x0 & plain) + ones(x2 & plain) + ones(x4 & plain) + ones(x6 & plain) + ones(y0 & plain) + ones(y1 & plain) +
             ones(y4 & plain) + ones(y5 & plain) + ones(z0 & plain) + ones(z1 & plain) + ones(z2 & plain) + ones(z3 & plain) -
             2 * ones(plain);
  }
  any_odd = all_odd != 0;
  return total;
}

void edge_count(const uint64_t* HWY_RESTRICT row, const uint64_t* HWY_RESTRICT up, const uint64_t* HWY_RESTRICT back, size_t words,
                size_t points, uint32_t* HWY_RESTRICT cut) {
  uint32_t n[3] = {0, 0, 0};
  for (size_t w = 0; w < words; ++w) {
    const Twice a = twice(row, w, words);
    n[0] += ones((a.m ^ a.s) & cell_bits(w, points));
    if (up) n[1] += ones(a.m ^ up[w]);
    if (back) n[2] += ones(a.m ^ back[w]);
  }
  cut[0] = n[0], cut[1] = n[1], cut[2] = n[2];
}

// The numbers of a cell's edges, as many as two lower ones per counter: an edge's number is the number of cut edges before it, and every
// cut edge of these rows belongs to a crossed cell that is visited. Along x each counter is an edge; along y and z it is that on the
// left side of the cell, and the one on the right comes behind it where the left one is cut.
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
using DU = hn::CappedTag<uint32_t, 16>;
class Numbers {
 public:
  Numbers(const RowStart* near, const RowStart* back, uint32_t first_point) {
    // From registers: a vector read from numbers just written waits for them.
    uint32_t n[8];
    first_edges(near, back, first_point, n);
    const auto set = [](uint32_t a, uint32_t b, uint32_t c, uint32_t d) { return _mm_set_epi32(int(d), int(c), int(b), int(a)); };
    const auto all = _mm512_castsi256_si512(_mm256_set_m128i(set(n[4], n[5], n[6], n[7]), set(n[0], n[1], n[2], n[3])));
    const auto order = _mm512_set_epi32(0, 0, 0, 0, 7, 7, 6, 6, 5, 5, 4, 4, 3, 2, 1, 0);
    at_ = hn::Vec<DU>{_mm512_permutexvar_epi32(order, all)};
  }
  // The edges of the cell; then the counters pass it.
  HWY_INLINE hn::Vec<DU> pass(uint32_t passed) {
    const auto moved = _mm512_mask_add_epi32(at_.raw, __mmask16(passed), at_.raw, _mm512_set1_epi32(1));
    const auto edges = _mm512_mask_blend_epi32(0x0AA0, at_.raw, moved);
    at_ = hn::Vec<DU>{moved};
    return hn::Vec<DU>{edges};
  }

 private:
  hn::Vec<DU> at_;
};

HWY_INLINE void store_first(hn::Vec<DU> v, size_t n, int32_t* to) { _mm512_mask_storeu_epi32(to, __mmask16((1u << n) - 1), v.raw); }

HWY_INLINE void write_cell(hn::Vec<DU> edges, const uint8_t* names, size_t triangles, int32_t* out) {
  const auto order = _mm512_cvtepu8_epi32(_mm_load_si128(reinterpret_cast<const __m128i*>(names)));
  store_first(hn::Vec<DU>{_mm512_permutexvar_epi32(order, edges.raw)}, 3 * triangles, out);
}
HWY_INLINE void write_numbers(uint32_t number, size_t triangles, uint32_t* out) {
  store_first(set(DU(), number), triangles, reinterpret_cast<int32_t*>(out));
}
HWY_INLINE void edge_list(hn::Vec<DU> edges, uint32_t* to) { hn::Store(edges, DU(), to); }
#else
struct EdgeNumbers {
  uint32_t at[12];
};
class Numbers {
 public:
  Numbers(const RowStart* near, const RowStart* back, uint32_t first_point) { first_edges(near, back, first_point, at_); }
  HWY_INLINE EdgeNumbers pass(uint32_t passed) {
    EdgeNumbers e;
    for (uint32_t s = 0; s < 4; ++s) e.at[s] = at_[s], at_[s] += passed >> s & 1;
    for (uint32_t s = 4; s < 8; ++s) {
      e.at[2 * s - 4] = at_[s];
      e.at[2 * s - 3] = at_[s] += passed >> (2 * s - 4) & 1;
    }
    return e;
  }

 private:
  uint32_t at_[8];
};
HWY_INLINE void write_cell(const EdgeNumbers& edges, const uint8_t* names, size_t triangles, int32_t* out) {
  for (size_t n = 0; n < 3 * triangles; ++n) out[n] = int32_t(edges.at[names[n]]);
}
HWY_INLINE void write_numbers(uint32_t number, size_t triangles, uint32_t* out) {
  for (size_t n = 0; n < triangles; ++n) out[n] = number;
}
HWY_INLINE void edge_list(const EdgeNumbers& edges, uint32_t* to) { std::copy_n(edges.at, 12, to); }
#endif

// Bits i and i+1 of a row.
HWY_INLINE uint32_t two_bits(const uint64_t* row, size_t i) {
  static_assert(std::endian::native == std::endian::little);
  uint64_t bits;
  std::memcpy(&bits, reinterpret_cast<const uint8_t*>(row) + i / 32 * 4, 8);
  return uint32_t(bits >> (i % 32)) & 3;
}

void triangle_row(const TriangleRow& row) {
  constexpr size_t room = 512;
  const CellTables& tables = row.tables;
  const RowBits& bits = row.bits;
  Numbers numbers(row.near, row.back, row.first_point);
  int32_t* out = row.out;
  uint32_t* cells = row.cells;
  uint32_t crossed[room + 80];
  for (size_t w = 0; w < bits.words;) {
    // Crossed cells are listed first, so that the work on them has no branch that depends on the surface.
    size_t count = 0;
    for (; w < bits.words && count < room; ++w) {
      uint64_t any = 0, every = ~uint64_t(0);
      for (int s = 0; s < 4; ++s) {
        const Twice q = twice(bits.row[s], w, bits.words);
        any |= q.m | q.s;
        every &= q.m & q.s;
      }
      const uint64_t active = any & ~every & cell_bits(w, bits.points);
      count = list_bits(active, uint32_t(64 * w), crossed, count);
    }
    for (size_t c = 0; c < count; ++c) {
      const size_t i = crossed[c];
      const uint32_t pattern =
          two_bits(bits.row[0], i) | two_bits(bits.row[1], i) << 2 | two_bits(bits.row[2], i) << 4 | two_bits(bits.row[3], i) << 6;
      const auto edges = numbers.pass(tables.passed[pattern]);
      const size_t n = tables.triangles[pattern];
      if (HWY_UNLIKELY(n == CellTables::slow)) {
        HWY_ALIGN uint32_t list[16];
        edge_list(edges, list);
        int32_t* to = out;  // copies, so that these two stay in registers
        uint32_t* to_cells = cells;
        row.slow(row.slow_job, i, list, to, to_cells);
        out = to, cells = to_cells;
        continue;
      }
      write_cell(edges, tables.edges[pattern], n, out);
      out += 3 * n;
      if (cells) {
        write_numbers(row.first_cell + uint32_t(i), n, cells);
        cells += n;
      }
    }
  }
}

}  // namespace sg::contouring::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::contouring {
HWY_EXPORT(triangle_count);
HWY_EXPORT(edge_count);
HWY_EXPORT(triangle_row);

size_t count_triangles(const RowBits& rows, uint64_t* odd, bool& any_odd) {
  return HWY_DYNAMIC_DISPATCH(triangle_count)(rows, odd, any_odd);
}
void count_edges(const uint64_t* row, const uint64_t* up, const uint64_t* back, size_t words, size_t points, uint32_t cut[3]) {
  HWY_DYNAMIC_DISPATCH(edge_count)(row, up, back, words, points, cut);
}
void write_triangles(const TriangleRow& row) { HWY_DYNAMIC_DISPATCH(triangle_row)(row); }

const CellTables& CellTables::of(bool trilinear, bool flip) {
  static const auto all = [] {
    auto made = std::make_unique<CellTables[]>(4);
    const CaseTable& cases = lattice_cases();
    for (uint32_t way = 0; way < 4; ++way)
      for (uint32_t p = 0; p < 256; ++p) {
        CellTables& t = made[way];
        const auto range = cases.plain(p);
        t.triangles[p] = (way & 1) && needs_trilinear(p) ? slow : uint8_t((range[1] - range[0]) / 3);
        std::fill_n(t.edges[p], 16, 0);
        for (uint32_t e = range[0]; e < range[1] && e - range[0] < 15; ++e) {
          const uint32_t n = e - range[0], corner = n % 3;
          t.edges[p][n - corner + ((way & 2) && corner ? 3 - corner : corner)] = cases.triangle_edges()[e];
        }
        uint32_t passed = 0;
        for (uint32_t e = 0; e < 12; ++e) {
          const auto ends = cases.shape().edges[e < 4 ? e : e & ~1u];  // the right edges along y and z follow the left ones
          passed |= ((p >> ends[0] ^ p >> ends[1]) & 1) << e;
        }
        t.passed[p] = uint16_t(passed);
      }
    return made;
  }();
  return all[(trilinear ? 1 : 0) + (flip ? 2 : 0)];
}
}  // namespace sg::contouring
#endif
