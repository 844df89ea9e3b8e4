// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/label_nets.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/bits.h"
#include "base/error.h"
#include "base/parallel.h"

namespace sg {

int32_t LabelNet::code_at(int64_t i, int64_t j, int64_t k) const {
  if (i < 0 || j < 0 || k < 0 || i >= int64_t(dims_[0]) || j >= int64_t(dims_[1]) || k >= int64_t(dims_[2])) return 0;
  return code_[size_t(i) + dims_[0] * (size_t(j) + dims_[1] * size_t(k))];
}

LabelNet::LabelNet(const int32_t* code, std::array<size_t, 3> dims, bool walls, const Context& context)
    : code_(code), dims_(dims), corners_{dims[0] + 1, dims[1] + 1, dims[2] + 1}, walls_(walls), context_(context) {
  if (std::max({dims[0], dims[1], dims[2]}) >= size_t(INT32_MAX)) fail_usage("the grid is too large", "label_surface");
  words_ = (corners_[0] + 63) / 64;
  const size_t rows = corners_[1] * corners_[2];
  used_.assign(rows * words_, 0), rank_.assign(rows * words_, 0);
  first_vertex_.assign(rows + 1, 0), first_face_.assign(rows + 1, 0);
  const std::vector<int32_t> nothing(dims[0], 0);
  parallel_for(
      rows, 16,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) {
          // The four rows of samples around this row of corners.
          const int64_t j = int64_t(row % corners_[1]), k = int64_t(row / corners_[1]);
          const int32_t* s[4];
          for (int n = 0; n < 4; ++n) {
            const int64_t y = j - (n & 1), z = k - (n >> 1);
            const bool inside = y >= 0 && z >= 0 && y < int64_t(dims_[1]) && z < int64_t(dims_[2]);
            s[n] = inside ? code_ + dims_[0] * (size_t(y) + dims_[1] * size_t(z)) : nothing.data();
          }
          uint64_t* bits = used_.data() + row * words_;
          int32_t last = 0;  // code of the column before when it is all one, outside the image nothing
          bool last_even = true;
          for (size_t i = 0; i <= dims_[0]; ++i) {
            int32_t here = 0;
            bool even = true;
            if (i < dims_[0]) here = s[0][i], even = !(differ(here, s[1][i]) | differ(here, s[2][i]) | differ(here, s[3][i]));
            if (!(even & last_even) || differ(here, last)) bits[i / 64] |= uint64_t(1) << (i % 64);
            last = here, last_even = even;
          }
          uint32_t count = 0;
          for (size_t w = 0; w < words_; ++w) rank_[row * words_ + w] = count, count += count_bits(bits[w]);
          first_vertex_[row] = count;
          size_t faces = 0;
          if (count) for_faces_of_row(row, [&](size_t, int, int32_t, int32_t) { ++faces; });
          first_face_[row] = faces;
        }
      },
      &context_);
  vertices_ = exclusive_scan(first_vertex_), faces_ = exclusive_scan(first_face_);
  if (vertices_ >= size_t(INT32_MAX))
    fail_usage("the surface has more than two billion points", "label_surface", "use fewer labels, or crop first");
}

int32_t LabelNet::vertex(size_t i, size_t row) const {
  const size_t w = row * words_ + i / 64;
  const uint64_t below = used_[w] & ((uint64_t(1) << (i % 64)) - 1);
  return int32_t(first_vertex_[row] + rank_[w] + count_bits(below));
}

// f(i, axis, code below, code above) for the faces that have corner (i, row) as their lowest, in the order of i, then axis.
template <class F>
void LabelNet::for_faces_of_row(size_t row, F&& f) const {
  const int64_t j = int64_t(row % corners_[1]), k = int64_t(row / corners_[1]);
  const bool in_y = j < int64_t(dims_[1]), in_z = k < int64_t(dims_[2]);
  for (size_t w = 0; w < words_; ++w)
    for (uint64_t bits = used_[row * words_ + w]; bits; bits &= bits - 1) {
      const size_t i = w * 64 + size_t(std::countr_zero(bits));
      const int64_t x = int64_t(i);
      const bool in_x = i < dims_[0];
      const int32_t here = code_at(x, j, k);
      if (in_y && in_z)
        if (const int32_t before = code_at(x - 1, j, k); differ(before, here)) f(i, 0, before, here);
      if (in_x && in_z)
        if (const int32_t before = code_at(x, j - 1, k); differ(before, here)) f(i, 1, before, here);
      if (in_x && in_y)
        if (const int32_t before = code_at(x, j, k - 1); differ(before, here)) f(i, 2, before, here);
    }
}

void LabelNet::fill_faces(int32_t* connectivity, int64_t* samples) const {
  parallel_for(
      corners_[1] * corners_[2], 16,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) {
          size_t face = first_face_[row];
          const size_t j = row % corners_[1], k = row / corners_[1];
          for_faces_of_row(row, [&](size_t i, int axis, int32_t before, int32_t here) {
            const std::array<size_t, 3> low{i, j, k};
            const size_t u = size_t(axis + 1) % 3, v = size_t(axis + 2) % 3;
            // The first side is the lower label that is not nothing; the face looks away from it.
            const bool forward = before != 0 && (here == 0 || before < here);
            for (int c = 0; c < 4; ++c) {
              const int step = forward ? c : 3 - c;
              auto p = low;
              p[u] += step == 1 || step == 2, p[v] += step >= 2;
              connectivity[face * 4 + size_t(c)] = vertex(p[0], p[1] + corners_[1] * p[2]);
            }
            auto below = low;
            --below[size_t(axis)];
            const auto id = [&](const std::array<size_t, 3>& s) {
              return s[0] < dims_[0] && s[1] < dims_[1] && s[2] < dims_[2] ? int64_t(s[0] + dims_[0] * (s[1] + dims_[1] * s[2]))
                                                                           : int64_t(-1);
            };
            samples[face * 2] = forward ? id(below) : id(low);
            samples[face * 2 + 1] = forward ? id(low) : id(below);
            ++face;
          });
        }
      },
      &context_);
}

void LabelNet::fill_corners(uint32_t* corners) const {
  parallel_for(corners_[1] * corners_[2], 64, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      uint32_t* out = corners + 3 * first_vertex_[row];
      for (size_t w = 0; w < words_; ++w)
        for (uint64_t bits = used_[row * words_ + w]; bits; bits &= bits - 1, out += 3)
          out[0] = uint32_t(w * 64 + size_t(std::countr_zero(bits))), out[1] = uint32_t(row % corners_[1]),
          out[2] = uint32_t(row / corners_[1]);
    }
  });
}

// For each vertex of the row the vertices it is joined to along -x +x -y +y -z +z, -1 where it is not. Around a line between corners lie
// four samples; as many faces meet there as neighbours among them differ.
void LabelNet::neighbors_of_row(size_t row, int32_t* out) const {
  const int64_t j = int64_t(row % corners_[1]), k = int64_t(row / corners_[1]);
  for (size_t w = 0; w < words_; ++w)
    for (uint64_t bits = used_[row * words_ + w]; bits; bits &= bits - 1, out += 6) {
      const int64_t i = int64_t(w * 64 + size_t(std::countr_zero(bits)));
      int32_t s[2][2][2];
      for (int z = 0; z < 2; ++z)
        for (int y = 0; y < 2; ++y)
          for (int x = 0; x < 2; ++x) s[z][y][x] = code_at(i - 1 + x, j - 1 + y, k - 1 + z);
      int meet[6], lines = 0;
      const auto around = [&](int32_t a, int32_t b, int32_t c, int32_t d) {
        return int(differ(a, b)) + int(differ(b, c)) + int(differ(c, d)) + int(differ(d, a));
      };
      for (int side = 0; side < 2; ++side) {
        meet[side] = around(s[0][0][side], s[0][1][side], s[1][1][side], s[1][0][side]);
        meet[2 + side] = around(s[0][side][0], s[0][side][1], s[1][side][1], s[1][side][0]);
        meet[4 + side] = around(s[side][0][0], s[side][0][1], s[side][1][1], s[side][1][0]);
      }
      for (const int m : meet) lines += m > 2;
      for (int n = 0; n < 6; ++n) {
        if (meet[n] <= (lines >= 2 ? 2 : 0)) {
          out[n] = -1;
          continue;
        }
        const int64_t step = n & 1 ? 1 : -1;
        const size_t x = size_t(i + (n < 2 ? step : 0)), y = size_t(j + (n >> 1 == 1 ? step : 0)), z = size_t(k + (n >> 1 == 2 ? step : 0));
        out[n] = vertex(x, y + corners_[1] * z);
      }
    }
}

std::vector<float> LabelNet::relaxed(int iterations) const {
  std::vector<float> at(vertices_ * 3, 0.0f), next(vertices_ * 3);
  if (iterations == 0) return at;
  std::vector<int32_t> neighbors(vertices_ * 6);
  parallel_for(corners_[1] * corners_[2], 16, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row)
      if (first_vertex_[row + 1] > first_vertex_[row]) neighbors_of_row(row, neighbors.data() + 6 * first_vertex_[row]);
  });
  // Inward and outward steps by turns: a low-pass filter that keeps volumes. The pass band ends at 1/forward + 1/backward.
  constexpr float forward = 0.6f, backward = -0.64f;
  for (int round = 0; round < iterations; ++round) {
    const float rate = round & 1 ? backward : forward;
    parallel_for(
        vertices_, 1 << 14,
        [&](size_t begin, size_t end) {
          for (size_t v = begin; v < end; ++v) {
            float sum[3] = {0, 0, 0}, count = 0;
            for (size_t n = 0; n < 6; ++n) {
              const int32_t o = neighbors[v * 6 + n];
              if (o < 0) continue;
              for (size_t a = 0; a < 3; ++a) sum[a] += at[size_t(o) * 3 + a];
              sum[n / 2] += n & 1 ? 1.0f : -1.0f;
              ++count;
            }
            for (size_t a = 0; a < 3; ++a) {
              const float here = at[v * 3 + a];
              next[v * 3 + a] = count > 0 ? std::clamp(here + rate * (sum[a] / count - here), -0.5f, 0.5f) : here;
            }
          }
        },
        &context_);
    std::swap(at, next);
  }
  return at;
}

}  // namespace sg
