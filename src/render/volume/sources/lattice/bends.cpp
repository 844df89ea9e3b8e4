// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/lattice/bends.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "render/volume/sources/lattice/samples.h"
#include "render/volume/sources/lattice/space/empty_space.h"

namespace sg::volume {

namespace {

/// Largest absolute second differences of a brick: xx, yy, zz, xy, xz, yz.
struct Found {
  float most[6] = {0, 0, 0, 0, 0, 0};

  float bend() const { return std::max({most[0] + most[3] + most[4], most[1] + most[3] + most[5], most[2] + most[4] + most[5]}); }
};

/// The rows of samples around row (j, k), as floats; beyond the border the nearest again.
template <class T>
class Rows {
 public:
  Rows(const T* data, std::array<size_t, 3> dims) : data_(data), dims_(dims), floats_(9 * dims[0]) {}
  void at(size_t j, size_t k) {
    for (size_t c = 0; c < 3; ++c)
      for (size_t b = 0; b < 3; ++b) {
        const size_t y = std::min(j + b - (j + b > 0), dims_[1] - 1), z = std::min(k + c - (k + c > 0), dims_[2] - 1);
        const T* from = data_ + dims_[0] * (y + dims_[1] * z);
        if constexpr (std::is_same_v<T, float>) {
          row[c][b] = from;
        } else {
          float* to = &floats_[(3 * c + b) * dims_[0]];
          for (size_t i = 0; i < dims_[0]; ++i) to[i] = float(from[i]);
          row[c][b] = to;
        }
      }
  }
  const float* row[3][3];  ///< [z][y]

 private:
  const T* data_;
  std::array<size_t, 3> dims_;
  std::vector<float> floats_;
};

/// NaN counts as unbounded.
float larger(float a, float b) { return b <= a ? a : b == b ? b : HUGE_VALF; }

struct Looked {
  float xx, yy, zz, xy, xz, yz;
};

}  // namespace

// Row by row: the differences of each sample first (straight loops), then the largest per brick.
template <class T>
static void look(std::array<size_t, 3> dims, bool framed, size_t j, size_t k, Rows<T>& rows, std::vector<Looked>& out) {
  rows.at(j, k);
  const size_t n = dims[0];
  const float* const(*r)[3] = rows.row;
  const bool in_y = framed || (j > 0 && j + 1 < dims[1]), in_z = framed || (k > 0 && k + 1 < dims[2]);
  const auto one = [&](size_t i, size_t before, size_t after, bool in_x) {
    const float* m = r[1][1];
    const float twice = 2 * m[i];
    Looked l;
    l.xx = in_x ? std::abs(m[before] - twice + m[after]) : 0;
    l.yy = in_y ? std::abs(r[1][0][i] - twice + r[1][2][i]) : 0;
    l.zz = in_z ? std::abs(r[0][1][i] - twice + r[2][1][i]) : 0;
    // The faces of the cell whose lowest corner this sample is.
    l.xy = std::abs((r[1][2][after] - r[1][2][i]) - (m[after] - m[i]));
    l.xz = std::abs((r[2][1][after] - r[2][1][i]) - (m[after] - m[i]));
    l.yz = std::abs((r[2][2][i] - r[2][1][i]) - (r[1][2][i] - m[i]));
    out[i] = l;
  };
  one(0, 0, std::min<size_t>(1, n - 1), framed);
  for (size_t i = 1; i + 1 < n; ++i) one(i, i - 1, i + 1, true);
  if (n > 1) one(n - 1, n - 2, n - 1, framed);
}

template <class T>
static void find_row(const T* data, std::array<size_t, 3> dims, bool framed, size_t by, size_t bz, Found* to, size_t bricks) {
  constexpr size_t edge = FineBricks::edge;
  Rows<T> rows(data, dims);
  std::vector<Looked> looked(dims[0]);
  for (size_t k = bz * edge; k <= std::min((bz + 1) * edge, dims[2] - 1); ++k)
    for (size_t j = by * edge; j <= std::min((by + 1) * edge, dims[1] - 1); ++j) {
      look(dims, framed, j, k, rows, looked);
      for (size_t b = 0; b < bricks; ++b) {
        Found f = to[b];
        for (size_t i = b * edge; i <= std::min((b + 1) * edge, dims[0] - 1); ++i) {
          const Looked& l = looked[i];
          f.most[0] = larger(f.most[0], l.xx), f.most[1] = larger(f.most[1], l.yy), f.most[2] = larger(f.most[2], l.zz);
          f.most[3] = larger(f.most[3], l.xy), f.most[4] = larger(f.most[4], l.xz), f.most[5] = larger(f.most[5], l.yz);
        }
        to[b] = f;
      }
    }
}

Bends find_bends(const Array& values, std::array<size_t, 3> dims, float range, bool framed) {
  std::array<size_t, 3> n;
  for (size_t a = 0; a < 3; ++a) n[a] = (std::max<size_t>(dims[a], 2) - 2) / FineBricks::edge + 1;
  Bends r;
  r.range = range > 0 && range < 1e30f ? range : 1;
  const size_t bricks = n[0] * n[1] * n[2];
  std::vector<uint8_t> own(bricks);
  with_samples(values, [&](const auto* data) {
    parallel_for(n[1] * n[2], 8, [&](size_t begin, size_t end) {
      std::vector<Found> found(n[0]);
      for (size_t row = begin; row < end; ++row) {
        std::fill(found.begin(), found.end(), Found());
        find_row(data, dims, framed, row % n[1], row / n[1], found.data(), n[0]);
        for (size_t i = 0; i < n[0]; ++i) own[row * n[0] + i] = Bends::coded(found[i].bend() / r.range);
      }
    });
  });
  // The largest of the bricks around, one axis after the other.
  r.codes.resize(bricks + 3, Bends::unbounded);
  const size_t step[3] = {1, n[0], n[0] * n[1]};
  uint8_t* from = own.data();
  uint8_t* to = r.codes.data();
  for (size_t a = 0; a < 3; ++a, std::swap(from, to))
    parallel_for(bricks, 16384, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const size_t at = i / step[a] % n[a];
        uint8_t most = from[i];
        if (at > 0) most = std::max(most, from[i - step[a]]);
        if (at + 1 < n[a]) most = std::max(most, from[i + step[a]]);
        to[i] = most;
      }
    });
  return r;
}

}  // namespace sg::volume
