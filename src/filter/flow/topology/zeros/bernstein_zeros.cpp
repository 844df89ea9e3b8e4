// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/zeros/bernstein_zeros.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace sg {

namespace {

constexpr double same = 1e-8;          // zeros of one cell that are one
constexpr double smallest_box = 1e-7;  // nothing is decided in a box of that size: a multiple zero
constexpr double noise = 1e-14;        // rounding of coefficients, of the largest of them
constexpr int highest_degree = 16;

// Bernstein polynomials of degree n at x.
void bernstein(int n, double x, double* b) {
  b[0] = 1;
  for (int k = 1; k <= n; ++k) {
    double carried = 0;
    for (int i = 0; i < k; ++i) {
      const double old = b[i];
      b[i] = carried + (1 - x) * old;
      carried = x * old;
    }
    b[k] = carried;
  }
}

bool inverse_of(const double* j, int d, double* inv) {
  if (d == 2) {
    const double det = j[0] * j[3] - j[1] * j[2];
    const double scale = std::max({std::abs(j[0]), std::abs(j[1]), std::abs(j[2]), std::abs(j[3])});
    if (!(std::abs(det) > 1e-13 * scale * scale)) return false;
    inv[0] = j[3] / det, inv[1] = -j[1] / det, inv[2] = -j[2] / det, inv[3] = j[0] / det;
    return true;
  }
  const Vec3 a(j[0], j[1], j[2]), b(j[3], j[4], j[5]), c(j[6], j[7], j[8]);
  const Vec3 bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  const double det = dot(a, bc);
  if (!(std::abs(det) > 1e-13 * length(a) * length(b) * length(c))) return false;
  for (int k = 0; k < 3; ++k) inv[3 * k] = bc[k] / det, inv[3 * k + 1] = ca[k] / det, inv[3 * k + 2] = ab[k] / det;
  return true;
}

double outside_of(ZeroDomain domain, int d, Vec3 u) {
  double out = -1;
  for (int a = 0; a < d; ++a) out = std::max({out, -u[a], u[a] - 1});
  if (domain == ZeroDomain::simplex) out = std::max(out, u.x + u.y + (d == 3 ? u.z : 0) - 1);
  if (domain == ZeroDomain::prism) out = std::max(out, u.x + u.y - 1);
  return out;
}

double distance_to(const std::array<Vec3, 2>& s, Vec3 x) {
  const Vec3 d = s[1] - s[0];
  const double t = dot(d, d) > 0 ? std::clamp(dot(x - s[0], d) / dot(d, d), 0.0, 1.0) : 0;
  return length(x - s[0] - t * d);
}

}  // namespace

BernsteinZeros::BernsteinZeros(int dimension, int degree) : dimension_(dimension), degree_(std::min(degree, highest_degree)) {
  size_ = size_t(degree_ + 1) * size_t(degree_ + 1) * size_t(dimension == 3 ? degree_ + 1 : 1);
  c_.resize(size_ * size_t(dimension)), part_.resize(c_.size()), work_.resize(size_);
}

// The coefficients in a box into part_, by blossoms: b_i of [lo, hi] = sum_j c_j sum_k B^{n-i}_{j-k}(lo) B^i_k(hi).
void BernsteinZeros::restrict_to(const Box& box) {
  const int n = degree_, m = n + 1;
  double s[(highest_degree + 1) * (highest_degree + 1)], low[highest_degree + 1], high[highest_degree + 1];
  part_ = c_;
  size_t step = 1;
  for (int a = 0; a < dimension_; ++a, step *= size_t(m)) {
    for (int i = 0; i < m; ++i) {
      bernstein(n - i, box.lo[a], low), bernstein(i, box.hi[a], high);
      for (int j = 0; j < m; ++j) {
        double sum = 0;
        for (int k = std::max(0, j - (n - i)); k <= std::min(i, j); ++k) sum += low[j - k] * high[k];
        s[i * m + j] = sum;
      }
    }
    for (int c = 0; c < dimension_; ++c) {
      double* p = part_.data() + size_t(c) * size_;
      for (size_t first = 0; first < size_; ++first) {
        if (first / step % size_t(m)) continue;
        double line[highest_degree + 1];
        for (int i = 0; i < m; ++i) line[i] = p[first + size_t(i) * step];
        for (int i = 0; i < m; ++i) {
          double sum = 0;
          for (int j = 0; j < m; ++j) sum += s[i * m + j] * line[j];
          p[first + size_t(i) * step] = sum;
        }
      }
    }
  }
}

bool BernsteinZeros::one_sign() const {
  for (int c = 0; c < dimension_; ++c) {
    const double* p = part_.data() + size_t(c) * size_;
    const auto [lo, hi] = std::minmax_element(p, p + size_);
    const double zero = noise * largest_[size_t(c)];
    if (*lo > zero || *hi < -zero) return true;
  }
  return false;
}

int BernsteinZeros::examine(Box& box, Vec3& u) {
  const int d = dimension_, n = degree_;
  if (one_sign()) return 0;
  // Mean gradient in the box' own coordinates, and its inverse.
  double j[9] = {}, inv[9];
  size_t step = 1;
  for (int a = 0; a < d; ++a, step *= size_t(n + 1)) {
    for (int c = 0; c < d; ++c) {
      double sum = 0;
      const double* p = part_.data() + size_t(c) * size_;
      for (size_t i = 0; i < size_; ++i) {
        const size_t place = i / step % size_t(n + 1);
        sum += place == size_t(n) ? p[i] : place == 0 ? -p[i] : 0;
      }
      j[c * d + a] = sum / double(size_ / size_t(n + 1));
    }
  }
  if (!inverse_of(j, d, inv)) return 3;
  Vec3 middle, reach, slack;
  bool regular = true;
  for (int r = 0; r < d; ++r) {
    // Component r of inv * f.
    for (size_t i = 0; i < size_; ++i) {
      double sum = 0;
      for (int c = 0; c < d; ++c) sum += inv[r * d + c] * part_[size_t(c) * size_ + i];
      work_[i] = sum;
    }
    // Rounding of the coefficients, in sides of the box: what is on the border must not be lost to it.
    slack[r] = 1e-12;
    for (int c = 0; c < d; ++c) slack[r] += noise * std::abs(inv[r * d + c]) * largest_[size_t(c)];
    const auto [lo, hi] = std::minmax_element(work_.begin(), work_.end());
    if (*lo > slack[r] || *hi < -slack[r]) return 0;
    // Its value in the middle, and how far its derivatives are from those of the identity.
    double weight[highest_degree + 1], q = 0;
    bernstein(n, 0.5, weight);
    double value = 0;
    for (size_t i = 0; i < size_; ++i) {
      double w = 1;
      for (size_t a = 0, s = 1; a < size_t(d); ++a, s *= size_t(n + 1)) w *= weight[i / s % size_t(n + 1)];
      value += w * work_[i];
    }
    step = 1;
    for (int a = 0; a < d; ++a, step *= size_t(n + 1)) {
      double most = 0;
      for (size_t i = 0; i < size_; ++i)
        if (i / step % size_t(n + 1) != size_t(n)) most = std::max(most, std::abs(n * (work_[i + step] - work_[i]) - (a == r)));
      q += most;
    }
    middle[r] = 0.5 - value, reach[r] = 0.5 * q;
    regular = regular && q < 0.8;
  }
  if (!regular) return 3;
  Box k = box;
  bool inside = true;
  const Vec3 size = box.hi - box.lo;
  for (int a = 0; a < d; ++a) {
    const double from = middle[a] - reach[a] - slack[a], to = middle[a] + reach[a] + slack[a];
    if (to < 0 || from > 1) return 0;
    inside = inside && from > 0 && to < 1;
    k.lo[a] = box.lo[a] + size[a] * std::max(from, 0.0), k.hi[a] = box.lo[a] + size[a] * std::min(to, 1.0);
    u[a] = 0.5 * (k.lo[a] + k.hi[a]);
  }
  box = k;
  if (inside) return 2;
  for (int a = 0; a < d; ++a)
    if (box.hi[a] - box.lo[a] > 1e-11 + 100 * slack[a] * size[a]) return 1;
  return 2;
}

Vec3 BernsteinZeros::value(Vec3 u) const {
  Vec3 f;
  double b[3][highest_degree + 1];
  for (int a = 0; a < 3; ++a)
    if (a < dimension_) bernstein(degree_, u[a], b[a]);
    else b[a][0] = 1;
  size_t at = 0;
  const int last = dimension_ == 3 ? degree_ : 0;
  for (int k = 0; k <= last; ++k)
    for (int j = 0; j <= degree_; ++j)
      for (int i = 0; i <= degree_; ++i, ++at)
        for (int c = 0; c < dimension_; ++c) f[c] += b[0][i] * b[1][j] * b[2][k] * c_[size_t(c) * size_ + at];
  return f;
}

Mat3 BernsteinZeros::gradient(Vec3 u) const {
  Mat3 g;
  if (dimension_ == 3) g.m[2][2] = 0;
  double b[3][highest_degree + 1], d[3][highest_degree + 1];
  for (int a = 0; a < 3; ++a) {
    if (a >= dimension_) {
      b[a][0] = 1, d[a][0] = 0;
      continue;
    }
    bernstein(degree_, u[a], b[a]);
    double lower[highest_degree + 1];
    bernstein(degree_ - 1, u[a], lower);
    for (int i = 0; i <= degree_; ++i) d[a][i] = degree_ * ((i > 0 ? lower[i - 1] : 0) - (i < degree_ ? lower[i] : 0));
  }
  for (int r = 0; r < dimension_; ++r)
    for (int a = 0; a < dimension_; ++a) {
      double sum = 0;
      size_t at = size_t(r) * size_;
      const int last = dimension_ == 3 ? degree_ : 0;
      for (int k = 0; k <= last; ++k)
        for (int j = 0; j <= degree_; ++j)
          for (int i = 0; i <= degree_; ++i, ++at)
            sum += (a == 0 ? d[0][i] : b[0][i]) * (a == 1 ? d[1][j] : b[1][j]) * (a == 2 ? d[2][k] : b[2][k]) * c_[at];
      g.m[r][a] = sum;
    }
  return g;
}

// Newton's method; false when it does not converge near its start.
bool BernsteinZeros::polish(Vec3& u) const {
  const Vec3 start = u;
  for (int round = 0; round < 20; ++round) {
    const Mat3 g = gradient(u);
    double j[9], inv[9];
    const int d = dimension_;
    for (int r = 0; r < d; ++r)
      for (int a = 0; a < d; ++a) j[r * d + a] = g.m[r][a];
    if (!inverse_of(j, d, inv)) return false;
    const Vec3 f = value(u);
    Vec3 move;
    for (int a = 0; a < d; ++a)
      for (int c = 0; c < d; ++c) move[a] -= inv[a * d + c] * f[c];
    u += move;
    if (!(length(u - start) < 1)) return false;
    if (length(move) < 1e-14) return true;
  }
  return true;
}

void BernsteinZeros::add(Vec3 u, ZeroDomain domain, std::vector<Vec3>& zeros, size_t first) const {
  if (outside_of(domain, dimension_, u) > zero_margin) return;
  for (size_t i = first; i < zeros.size(); ++i)
    if (length(zeros[i] - u) < same) return;
  zeros.push_back(u);
}

bool BernsteinZeros::solve(ZeroDomain domain, std::vector<Vec3>& zeros, std::span<const std::array<Vec3, 2>> known) {
  const size_t first = zeros.size();
  for (int c = 0; c < dimension_; ++c) {
    largest_[size_t(c)] = 0;
    for (const double x : coefficients(c)) largest_[size_t(c)] = std::max(largest_[size_t(c)], std::abs(x));
  }
  // One equation that always holds leaves lines of zeros, or no zero at all.
  Box all;
  for (int a = 0; a < dimension_; ++a) all.lo[a] = -zero_margin, all.hi[a] = 1 + zero_margin;
  for (int c = 0; c < dimension_; ++c)
    if (!(largest_[size_t(c)] > 0)) {
      part_ = c_;
      return one_sign();
    }
  stack_.assign(1, all);
  int64_t left = 1500 * degree_ * (dimension_ == 3 ? 2 : 1);
  bool isolated = true;
  while (!stack_.empty()) {
    Box box = stack_.back();
    stack_.pop_back();
    if (domain != ZeroDomain::box &&
        box.lo.x + box.lo.y + (domain == ZeroDomain::simplex && dimension_ == 3 ? box.lo.z : 0) > 1 + zero_margin)
      continue;
    if (--left < 0) {
      isolated = false;
      break;
    }
    restrict_to(box);
    Vec3 u;
    const int found = examine(box, u);
    if (found == 0) continue;
    if (found == 2) {
      const Vec3 before = u;
      bool good = polish(u);
      double width = 0;
      for (int a = 0; a < dimension_; ++a) {
        good = good && u[a] > box.lo[a] - zero_margin && u[a] < box.hi[a] + zero_margin;
        width = std::max(width, box.hi[a] - box.lo[a]);
      }
      if (!good && width > 1e-10) stack_.push_back(box);  // Newton's method went elsewhere
      else add(good ? u : before, domain, zeros, first);
      continue;
    }
    const Vec3 size = box.hi - box.lo;
    int longest = 0;
    for (int a = 1; a < dimension_; ++a)
      if (size[a] > size[longest]) longest = a;
    if (size[longest] < 1.0 / 32) {
      const Vec3 middle = 0.5 * (box.lo + box.hi);
      if (std::any_of(known.begin(), known.end(), [&](const auto& s) { return distance_to(s, middle) < size[longest]; })) continue;
    }
    if (found == 1) {
      stack_.push_back(box);
      continue;
    }
    if (size[longest] < smallest_box) {
      const Vec3 middle = 0.5 * (box.lo + box.hi);
      bool near = false;
      for (size_t i = first; i < zeros.size(); ++i) near = near || length(zeros[i] - middle) < 1e-5;
      if (!near && outside_of(domain, dimension_, middle) <= zero_margin) zeros.push_back(middle);
      continue;
    }
    Box upper = box;
    box.hi[longest] = upper.lo[longest] = box.lo[longest] + 0.5 * size[longest];
    stack_.push_back(upper), stack_.push_back(box);
  }
  return isolated;
}

}  // namespace sg
