// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/zeros/simplex_zeros.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace sg {

namespace {

constexpr int deepest = 12;             // halvings; what is left then is decided only by Newton's method
constexpr int64_t most_pieces = 40000;  // of one cell: more have only lines of zeros
constexpr double bend = 0.03;           // of the quadratic, in its own size, below which its gradient stays invertible

constexpr std::array<std::array<int, 2>, 6> edges{{{0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}, {2, 3}}};

// The inverse of the matrix of columns c (d of them) as rows; false when it is singular.
bool inverse_rows(const Vec3* c, int d, Vec3* row) {
  if (d == 2) {
    const double det = c[0].x * c[1].y - c[0].y * c[1].x;
    if (!(std::abs(det) > 1e-12 * length(c[0]) * length(c[1]))) return false;
    row[0] = Vec3(c[1].y, -c[1].x, 0) / det, row[1] = Vec3(-c[0].y, c[0].x, 0) / det;
    return true;
  }
  const double det = dot(c[0], cross(c[1], c[2]));
  if (!(std::abs(det) > 1e-12 * length(c[0]) * length(c[1]) * length(c[2]))) return false;
  for (int k = 0; k < 3; ++k) row[k] = cross(c[(k + 1) % 3], c[(k + 2) % 3]) / det;
  return true;
}

double diameter(const Vec3* at, int corners) {
  double most = 0;
  for (int i = 0; i < corners; ++i)
    for (int j = 0; j < i; ++j) most = std::max(most, length(at[i] - at[j]));
  return most;
}

}  // namespace

// Newton's method from `start`; what it finds counts inside the piece, or up to `slack` of its size outside.
void SimplexZeros::keep(const Piece& p, Vec3 start, double slack, std::vector<Vec3>& zeros) {
  Vec3 found;
  if (!polish_(start, found)) return;
  Vec3 column[3], row[3];
  for (int k = 0; k < dimension_; ++k) column[k] = p.at[k + 1] - p.at[0];
  if (!inverse_rows(column, dimension_, row)) return;
  double rest = 1, out = -HUGE_VAL;
  for (int k = 0; k < dimension_; ++k) {
    const double l = dot(row[k], found - p.at[0]);
    rest -= l, out = std::max(out, -l);
  }
  if (std::max(out, -rest) > slack) return;
  for (size_t i = first_; i < zeros.size(); ++i)
    if (length(zeros[i] - found) < 1e-8 * size_) return;
  zeros.push_back(found);
}

// True when the piece is done with; `split` otherwise.
bool SimplexZeros::examine(const Piece& p, const Vec3* middle, std::vector<Vec3>& zeros, bool& split) {
  const int d = dimension_, count = d == 3 ? 6 : 3;
  split = false;
  Vec3 control[10], off[6];
  for (int k = 0; k <= d; ++k) control[k] = p.v[k];
  for (int e = 0; e < count; ++e) {
    const Vec3 mean = 0.5 * (p.v[edges[size_t(e)][0]] + p.v[edges[size_t(e)][1]]);
    off[e] = middle[e] - mean;
    control[d + 1 + e] = mean + 2 * off[e];
  }
  const int n = d + 1 + count;
  // What the quadratic does not know is taken to be at most what the linear function does not.
  const double doubt = p.depth == 0 ? 2 : 0.5;
  auto one_sign = [&](Vec3 direction) {
    double lo = HUGE_VAL, hi = -HUGE_VAL, margin = 0, largest = 0;
    for (int k = 0; k < n; ++k) {
      const double x = dot(direction, control[k]);
      lo = std::min(lo, x), hi = std::max(hi, x), largest = std::max(largest, std::abs(x));
    }
    for (int e = 0; e < count; ++e) margin = std::max(margin, std::abs(dot(direction, off[e])));
    margin = doubt * margin + 1e-10 * largest;
    return lo > margin || hi < -margin;
  };
  for (int c = 0; c < d; ++c) {
    Vec3 axis;
    axis[c] = 1;
    if (one_sign(axis)) return true;
  }
  Vec3 column[3], row[3];
  for (int k = 0; k < d; ++k) column[k] = p.v[k + 1] - p.v[0];
  if (!inverse_rows(column, d, row)) {
    split = true;
    return false;
  }
  double bent = 0;
  Vec3 sum;
  for (int k = 0; k < d; ++k) {
    if (one_sign(row[k])) return true;
    for (int e = 0; e < count; ++e) bent = std::max(bent, std::abs(dot(row[k], off[e])));
    sum += row[k];
  }
  if (bent > bend / (p.depth == 0 ? 4 : 1)) {
    split = true;
    return false;
  }
  // Zero of the linear function, in the piece.
  Vec3 start = p.at[0];
  double l[3], total = 0;
  for (int k = 0; k < d; ++k) l[k] = std::clamp(-dot(row[k], p.v[0]), 0.0, 1.0), total += l[k];
  for (int k = 0; k < d; ++k) start += l[k] / std::max(total, 1.0) * (p.at[k + 1] - p.at[0]);
  keep(p, start, 1e-6, zeros);
  return true;
}

bool SimplexZeros::solve(std::span<const Vec3> simplices, std::span<const Vec3> corners, std::vector<Vec3>& zeros) {
  const int d = dimension_, n = d + 1, count = d == 3 ? 6 : 3;
  first_ = zeros.size();
  int64_t left = most_pieces;
  for (size_t s = 0; s + size_t(n) <= simplices.size(); s += size_t(n)) {
    Piece whole;
    whole.depth = 0;
    bool good = true;
    for (int k = 0; k < n; ++k) whole.at[k] = simplices[s + size_t(k)], good = good && f_(whole.at[k], whole.v[k]);
    if (!good) continue;
    const double size = diameter(whole.at, n);
    size_ = std::max(size_, size);
    stack_.assign(1, whole);
    while (!stack_.empty()) {
      const Piece p = stack_.back();
      stack_.pop_back();
      if (--left < 0) return false;
      Vec3 at[6], v[6];
      good = true;
      for (int e = 0; e < count && good; ++e) {
        at[e] = 0.5 * (p.at[edges[size_t(e)][0]] + p.at[edges[size_t(e)][1]]);
        good = f_(at[e], v[e]);
      }
      bool split = false;
      if (!good || examine(p, v, zeros, split)) continue;
      const double reach = diameter(p.at, n);
      if (reach < size / 200 && std::any_of(corners.begin(), corners.end(), [&](Vec3 c) {
            return std::any_of(p.at, p.at + n, [&](Vec3 x) { return length(x - c) < 1e-3 * reach; });
          }))
        continue;
      if (p.depth >= deepest) {
        Vec3 mean;
        for (int k = 0; k < n; ++k) mean += p.at[k] / double(n);
        keep(p, mean, 2, zeros);
        continue;
      }
      auto child = [&](std::array<int, 4> c) {  // 0-3: corners; from 4 on: middles
        Piece q;
        q.depth = p.depth + 1;
        for (int k = 0; k < n; ++k) {
          const int i = c[size_t(k)];
          q.at[k] = i < 4 ? p.at[i] : at[i - 4], q.v[k] = i < 4 ? p.v[i] : v[i - 4];
        }
        stack_.push_back(q);
      };
      // Middles: 4 of 01, 5 of 02, 6 of 12, 7 of 03, 8 of 13, 9 of 23.
      if (d == 2) {
        for (const auto& c : {std::array{0, 4, 5, 0}, {4, 1, 6, 0}, {5, 6, 2, 0}, {4, 6, 5, 0}}) child(c);
      } else {
        for (const auto& c : {std::array{0, 4, 5, 7}, {4, 1, 6, 8}, {5, 6, 2, 9}, {7, 8, 9, 3}}) child(c);
        for (const auto& c : {std::array{4, 9, 5, 6}, {4, 9, 6, 8}, {4, 9, 8, 7}, {4, 9, 7, 5}}) child(c);
      }
    }
  }
  return true;
}

}  // namespace sg
