// SPDX-License-Identifier: Apache-2.0
// Gauss-Legendre quadrature of the reference elements; simplices and pyramids are boxes with collapsed sides (Duffy 1982).
#include <algorithm>
#include <map>
#include <mutex>

#include "data/cells/shape/cell_shape.h"

namespace sg {

namespace {

// Zeros of the Legendre polynomial P_n by Newton from Chebyshev's guess, on [0,1]; weights 1 / ((1-x^2) P_n'^2) there.
void gauss_legendre(int n, std::vector<double>& at, std::vector<double>& weight) {
  at.resize(size_t(n)), weight.resize(size_t(n));
  for (int i = 0; i < n; ++i) {
    double x = std::cos(M_PI * (n - i - 0.25) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 100; ++step) {
      double p = 1, before = 0;
      for (int k = 0; k < n; ++k) {
        const double next = ((2 * k + 1) * x * p - k * before) / (k + 1);
        before = p, p = next;
      }
      slope = n * (x * p - before) / (x * x - 1);
      const double dx = p / slope;
      x -= dx;
      if (std::abs(dx) < 1e-16) break;
    }
    at[size_t(i)] = (1 + x) / 2;
    weight[size_t(i)] = 1 / ((1 - x * x) * slope * slope);
  }
}

CellShape::Quadrature make(CellType base, int dimension, int degree) {
  // Collapsing multiplies by (1-x)^1 or ^2: that many degrees more.
  const bool simplex = base == CellType::triangle || base == CellType::tetra || base == CellType::wedge || base == CellType::pyramid;
  const int extra = !simplex ? 0 : base == CellType::triangle || base == CellType::wedge ? 1 : 2;
  std::vector<double> x, w;
  gauss_legendre((degree + extra) / 2 + 1, x, w);
  CellShape::Quadrature q;
  const size_t n = x.size();
  if (dimension == 0) return {{{0, 0, 0}}, {1}};
  for (size_t k = 0; k < (dimension > 2 ? n : 1); ++k)
    for (size_t j = 0; j < (dimension > 1 ? n : 1); ++j)
      for (size_t i = 0; i < n; ++i) {
        Vec3 p{x[i], dimension > 1 ? x[j] : 0, dimension > 2 ? x[k] : 0};
        double weight = w[i] * (dimension > 1 ? w[j] : 1) * (dimension > 2 ? w[k] : 1);
        if (base == CellType::triangle || base == CellType::wedge) {
          weight *= 1 - p.x;
          p.y *= 1 - p.x;
        } else if (base == CellType::tetra) {
          weight *= (1 - p.x) * (1 - p.x) * (1 - p.y);
          p = {p.x, p.y * (1 - p.x), p.z * (1 - p.x) * (1 - p.y)};
        } else if (base == CellType::pyramid) {
          weight *= (1 - p.z) * (1 - p.z);
          p.x = 0.5 + (p.x - 0.5) * (1 - p.z), p.y = 0.5 + (p.y - 0.5) * (1 - p.z);
        }
        q.at.push_back(p), q.weight.push_back(weight);
      }
  return q;
}

}  // namespace

const CellShape::Quadrature& CellShape::quadrature(int degree) const {
  static std::mutex mutex;
  static std::map<std::pair<CellType, int>, Quadrature> known;
  std::lock_guard lock(mutex);
  const auto key = std::make_pair(base_, std::max(degree, 0));
  auto it = known.find(key);
  if (it == known.end()) it = known.emplace(key, make(base_, dimension_, key.second)).first;
  return it->second;
}

}  // namespace sg
