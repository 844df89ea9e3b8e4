// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/cell_pattern.h"

#include <algorithm>
#include <numeric>

namespace sg::detail {

namespace {

// A linear part of a reference element: corners as lattice places, coordinates counted in 1/n.
struct Part {
  CellType type;
  std::vector<std::array<int, 3>> at;
};

std::array<int, 3> middle(const std::array<int, 3>& a, const std::array<int, 3>& b) {
  return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
}

// Halves all edges. Coordinates are even, so that middles are whole.
void halve(const Part& p, std::vector<Part>& out) {
  const auto& a = p.at;
  auto m = [&](int i, int j) { return middle(a[size_t(i)], a[size_t(j)]); };
  auto corners = [&](CellType t, std::vector<std::array<int, 3>> at) { out.push_back({t, std::move(at)}); };
  // Boxes by their corners in lattice order: part (x,y,z) spans from corner o with half the edges.
  auto boxes = [&](int axes) {
    const auto half = [&](int k) {
      return std::array<int, 3>{k == 0 ? (a[1][0] - a[0][0]) / 2 : 0, k == 1 ? (a[axes > 1 ? 3 : 0][1] - a[0][1]) / 2 : 0,
                                k == 2 ? (a[axes > 2 ? 4 : 0][2] - a[0][2]) / 2 : 0};
    };
    const int sx = half(0)[0], sy = half(1)[1], sz = half(2)[2];
    for (int z = 0; z < (axes > 2 ? 2 : 1); ++z)
      for (int y = 0; y < (axes > 1 ? 2 : 1); ++y)
        for (int x = 0; x < 2; ++x) {
          const int ox = a[0][0] + x * sx, oy = a[0][1] + y * sy, oz = a[0][2] + z * sz;
          std::vector<std::array<int, 3>> c = {{ox, oy, oz}, {ox + sx, oy, oz}};
          if (axes > 1) c.push_back({ox + sx, oy + sy, oz}), c.push_back({ox, oy + sy, oz});
          if (axes > 2)
            for (int k = 0; k < 4; ++k) c.push_back({c[size_t(k)][0], c[size_t(k)][1], oz + sz});
          corners(p.type, std::move(c));
        }
  };
  switch (p.type) {
    case CellType::line: boxes(1); return;
    case CellType::quad: boxes(2); return;
    case CellType::hexahedron: boxes(3); return;
    case CellType::triangle: {
      const auto ab = m(0, 1), bc = m(1, 2), ca = m(2, 0);
      corners(p.type, {a[0], ab, ca}), corners(p.type, {ab, a[1], bc}), corners(p.type, {ca, bc, a[2]}), corners(p.type, {ab, bc, ca});
      return;
    }
    case CellType::wedge: {
      for (int z = 0; z < 2; ++z) {
        const auto lower = [&](int k) { return z == 0 ? a[size_t(k)] : m(k, k + 3); };
        const auto upper = [&](int k) { return z == 0 ? m(k, k + 3) : a[size_t(k + 3)]; };
        const std::array<int, 3> l[6] = {
            lower(0), lower(1), lower(2), middle(lower(0), lower(1)), middle(lower(1), lower(2)), middle(lower(2), lower(0))};
        const std::array<int, 3> u[6] = {
            upper(0), upper(1), upper(2), middle(upper(0), upper(1)), middle(upper(1), upper(2)), middle(upper(2), upper(0))};
        for (const auto& t : {std::array{0, 3, 5}, std::array{3, 1, 4}, std::array{5, 4, 2}, std::array{3, 4, 5}})
          corners(p.type, {l[t[0]], l[t[1]], l[t[2]], u[t[0]], u[t[1]], u[t[2]]});
      }
      return;
    }
    case CellType::tetra: {  // Bey (1995): four corners, and the octahedron cut along one diagonal
      const auto b = m(0, 1), c = m(0, 2), d = m(0, 3), e = m(1, 2), f = m(1, 3), g = m(2, 3);
      corners(p.type, {a[0], b, c, d}), corners(p.type, {b, a[1], e, f}), corners(p.type, {c, e, a[2], g}),
          corners(p.type, {d, f, g, a[3]});
      corners(p.type, {b, c, d, f}), corners(p.type, {b, e, c, f}), corners(p.type, {c, f, g, d}), corners(p.type, {c, e, g, f});
      return;
    }
    default: {  // pyramid: four at the base, one at the apex, one upside down, four tetrahedra between
      const auto ab = m(0, 1), bc = m(1, 2), cd = m(2, 3), da = m(3, 0), center = middle(a[0], a[2]);
      const auto ta = m(0, 4), tb = m(1, 4), tc = m(2, 4), td = m(3, 4);
      corners(p.type, {a[0], ab, center, da, ta}), corners(p.type, {ab, a[1], bc, center, tb});
      corners(p.type, {center, bc, a[2], cd, tc}), corners(p.type, {da, center, cd, a[3], td});
      corners(p.type, {ta, tb, tc, td, a[4]}), corners(p.type, {td, tc, tb, ta, center});
      corners(CellType::tetra, {ab, ta, tb, center}), corners(CellType::tetra, {bc, tb, tc, center});
      corners(CellType::tetra, {cd, tc, td, center}), corners(CellType::tetra, {da, td, ta, center});
      return;
    }
  }
}

// Corners of the linear types in lattice coordinates (0 or 1); a pyramid's apex stands over its first corner here.
std::vector<std::array<int, 3>> reference_corners(CellType t) {
  switch (t) {
    case CellType::line: return {{0, 0, 0}, {1, 0, 0}};
    case CellType::triangle: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    case CellType::quad: return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    case CellType::tetra: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    case CellType::wedge: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    case CellType::pyramid: return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}};
    default: return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  }
}

// Reference coordinates of a lattice place: a pyramid leans over its first corner in the lattice, and stands upright in reference space.
Vec3 place(CellType t, const std::array<int, 3>& at, int n) {
  const double lean = t == CellType::pyramid ? 0.5 * at[2] : 0;
  return {(at[0] + lean) / n, (at[1] + lean) / n, double(at[2]) / n};
}

// Shares of the element's corners in a lattice place, without common factors: those of a face come out with one that depends on the cell.
std::vector<int64_t> shares_at(CellType t, const std::array<int, 3>& at, int n) {
  const int x = at[0], y = at[1], z = at[2], a = n - x, b = n - y, c = n - z;
  std::vector<int64_t> w;
  switch (t) {
    case CellType::line: w = {a, x}; break;
    case CellType::triangle: w = {n - x - y, x, y}; break;
    case CellType::quad: w = {int64_t(a) * b, int64_t(x) * b, int64_t(x) * y, int64_t(a) * y}; break;
    case CellType::tetra: w = {n - x - y - z, x, y, z}; break;
    case CellType::wedge: {
      const int64_t o = n - x - y;
      w = {o * c, int64_t(x) * c, int64_t(y) * c, o * z, int64_t(x) * z, int64_t(y) * z};
      break;
    }
    case CellType::pyramid: {  // the base's shares times what is left at this height, in 1/(n - z)
      const int64_t e = c - x, f = c - y, s = std::max(c, 1);
      w = {e * f, int64_t(x) * f, int64_t(x) * y, e * y, int64_t(z) * s};
      break;
    }
    default:
      w = {int64_t(a) * b * c, int64_t(x) * b * c, int64_t(x) * y * c, int64_t(a) * y * c,
           int64_t(a) * b * z, int64_t(x) * b * z, int64_t(x) * y * z, int64_t(a) * y * z};
  }
  int64_t divisor = 0;
  for (const int64_t v : w) divisor = std::gcd(divisor, v);
  for (int64_t& v : w) v /= std::max<int64_t>(divisor, 1);
  return w;
}

using Places = std::vector<std::array<int, 3>>;

Places each_once(Places p) {
  std::sort(p.begin(), p.end());
  p.erase(std::unique(p.begin(), p.end()), p.end());
  return p;
}

uint32_t place_in(const Places& p, const std::array<int, 3>& at) { return uint32_t(std::lower_bound(p.begin(), p.end(), at) - p.begin()); }

// The two places of every pair of corners of a part, each pair once, and their middles, counted in 1/(2n).
void add_spans(CellPattern& out, const Places& points, CellType t, int n) {
  std::vector<uint64_t> pairs;
  for (const CellPattern::Part& part : out.parts)
    for (uint32_t i = 0; i < part.count; ++i)
      for (uint32_t j = i + 1; j < part.count; ++j) {
        const uint32_t a = out.corners[part.begin + i], b = out.corners[part.begin + j];
        pairs.push_back(uint64_t(std::min(a, b)) << 32 | std::max(a, b));
      }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  const auto twice_middle = [&](uint64_t pair) {
    const auto &a = points[pair >> 32], &b = points[uint32_t(pair)];
    return std::array<int, 3>{a[0] + b[0], a[1] + b[1], a[2] + b[2]};
  };
  Places middles;
  for (const uint64_t pair : pairs) middles.push_back(twice_middle(pair));
  middles = each_once(std::move(middles));
  for (const uint64_t pair : pairs) out.spans.push_back({uint32_t(pair >> 32), uint32_t(pair), place_in(middles, twice_middle(pair))});
  for (const auto& m : middles) out.middles.push_back(place(t, m, 2 * n));
}

}  // namespace

CellPattern cell_pattern(CellType base, int level) {
  const int n = 1 << level;
  std::vector<Part> parts{{base, reference_corners(base)}};
  for (auto& c : parts[0].at)
    for (int& x : c) x *= n;
  for (int l = 0; l < level; ++l) {
    std::vector<Part> finer;
    for (const Part& part : parts) halve(part, finer);
    parts = std::move(finer);
  }
  Places points;
  for (const Part& part : parts) points.insert(points.end(), part.at.begin(), part.at.end());
  points = each_once(std::move(points));
  CellPattern out;
  for (const Part& part : parts) {
    out.parts.push_back({part.type, uint32_t(out.corners.size()), uint32_t(part.at.size())});
    for (const auto& at : part.at) out.corners.push_back(place_in(points, at));
  }
  out.shares_begin.push_back(0);
  for (const auto& at : points) {
    out.points.push_back(place(base, at, n));
    const std::vector<int64_t> w = shares_at(base, at, n);
    for (size_t k = 0; k < w.size(); ++k)
      if (w[k]) out.shares.push_back({uint8_t(k), w[k]});
    out.shares_begin.push_back(uint32_t(out.shares.size()));
  }
  add_spans(out, points, base, n);
  return out;
}

double part_count(CellType base, int level) {
  double same = 1, tetrahedra = 0;
  for (int l = 0; l < level; ++l) {
    if (base == CellType::pyramid) tetrahedra = 8 * tetrahedra + 4 * same, same *= 6;
    else same *= base == CellType::line ? 2 : base == CellType::triangle || base == CellType::quad ? 4 : 8;
  }
  return same + tetrahedra;
}

}  // namespace sg::detail
