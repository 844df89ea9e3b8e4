// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/walls/cover.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace sg::fluid {

namespace {

constexpr size_t samples = 4;             // lines across a cell
constexpr double aside = 0.000123456789;  // of a cell: lines that run through no corner of surfaces that follow the grid

// Where lines along `along` cross a plane: `count` of them, the first at `first`, `step` apart, along two axes.
struct Comb {
  int axis[2];
  double first[2], step[2];
  size_t count[2];
};

struct Crossing {
  size_t line;
  double at;
  friend bool operator<(const Crossing& a, const Crossing& b) { return a.line != b.line ? a.line < b.line : a.at < b.at; }
};

// The lines that cross a triangle.
void cross(const Comb& comb, int along, const Vec3* corner, std::vector<Crossing>& out) {
  double p[3][2];
  for (int c = 0; c < 3; ++c)
    for (int a = 0; a < 2; ++a) p[c][a] = corner[c][comb.axis[a]];
  const auto side = [&](int from, int to, double u, double v) {
    return (p[to][0] - p[from][0]) * (v - p[from][1]) - (p[to][1] - p[from][1]) * (u - p[from][0]);
  };
  const double area = side(0, 1, p[2][0], p[2][1]);
  if (!(std::abs(area) > 0)) return;
  size_t lo[2], hi[2];
  for (int a = 0; a < 2; ++a) {
    const auto [least, most] = std::minmax({p[0][a], p[1][a], p[2][a]});
    const double n = double(comb.count[a]);
    lo[a] = size_t(std::clamp(std::ceil((least - comb.first[a]) / comb.step[a]), 0.0, n));
    hi[a] = size_t(std::clamp(std::floor((most - comb.first[a]) / comb.step[a]) + 1, 0.0, n));
  }
  for (size_t j = lo[1]; j < hi[1]; ++j)
    for (size_t i = lo[0]; i < hi[0]; ++i) {
      const double u = comb.first[0] + double(i) * comb.step[0], v = comb.first[1] + double(j) * comb.step[1];
      const double a = side(1, 2, u, v) / area, b = side(2, 0, u, v) / area, c = side(0, 1, u, v) / area;
      if (a >= 0 && b >= 0 && c >= 0)
        out.push_back({i + j * comb.count[0], a * corner[0][along] + b * corner[1][along] + c * corner[2][along]});
    }
}

}  // namespace

template <class T>
Lattice<T> shares_inside(const TriangleSoup& surface, const MacGrid& g, int axis, const Context& context) {
  Lattice<T> shares(axis < 0 ? g.cells : g.faces(axis));
  const int along = axis == 0 ? 1 : 0;
  const auto shift = MacGrid::shift(axis);
  Comb comb;
  size_t across[2];  // lines of a place along each axis
  for (int a = 0, next = 0; a < 3; ++a) {
    if (a == along) continue;
    const bool flat = a == 2 && g.flat(), on_face = a == axis;
    across[next] = flat || on_face ? 1 : samples;
    comb.axis[next] = a, comb.count[next] = shares.n[size_t(a)] * across[next], comb.step[next] = g.h / double(across[next]);
    const double begin = flat ? 0 : on_face ? shift[size_t(a)] : 0.5 / double(across[next]);
    comb.first[next] = g.origin[a] + (begin + (next + 1) * aside) * g.h;
    ++next;
  }
  std::vector<Crossing> crossings;
  for (size_t t = 0; t + 2 < surface.size(); t += 3) {
    if (t % 30000 == 0) context.check();
    cross(comb, along, &surface[t], crossings);
  }
  std::sort(crossings.begin(), crossings.end());
  const double weight = 1.0 / double(across[0] * across[1]), n = double(shares.n[size_t(along)]);
  const size_t strides[3] = {1, shares.n[0], shares.n[0] * shares.n[1]};
  for (size_t c = 0; c < crossings.size();) {
    const size_t line = crossings[c].line;
    const size_t i = line % comb.count[0] / across[0], j = line / comb.count[0] / across[1];
    T* const row = shares.values.data() + i * strides[comb.axis[0]] + j * strides[comb.axis[1]];
    for (; c < crossings.size() && crossings[c].line == line; c += 2) {
      const auto place = [&](size_t k) { return std::clamp((crossings[k].at - g.origin[along]) / g.h, 0.0, n); };
      const double from = place(c), to = c + 1 < crossings.size() && crossings[c + 1].line == line ? place(c + 1) : n;
      for (size_t k = size_t(from); double(k) < to; ++k)
        row[k * strides[along]] += T(weight * (std::min(to, double(k) + 1) - std::max(from, double(k))));
      if (c + 1 >= crossings.size() || crossings[c + 1].line != line) {
        ++c;
        break;
      }
    }
  }
  return shares;
}

template Lattice<float> shares_inside(const TriangleSoup&, const MacGrid&, int, const Context&);
template Lattice<double> shares_inside(const TriangleSoup&, const MacGrid&, int, const Context&);

}  // namespace sg::fluid
