// SPDX-License-Identifier: Apache-2.0
// Topology of contours on grids against a count in closed form (see trilinear_oracle.h).
#include "filter/scalar/contour/cells/trilinear_cell.h"
#include <atomic>

#include "base/parallel.h"
#include "base/random.h"
#include "filter/scalar/contour/contour_support.h"
#include "filter/scalar/contour/trilinear_oracle.h"

using namespace sg;
using namespace sg::test;

namespace {

using Values = std::array<double, 8>;

double trilinear(const Values& f, double u, double v, double w) {
  double r = 0;
  for (size_t c = 0; c < 8; ++c) r += f[c] * (c & 1 ? u : 1 - u) * (c >> 1 & 1 ? v : 1 - v) * (c >> 2 ? w : 1 - w);
  return r;
}

// Euler number and components of the surface by brute force: n^3 samples, each small cube in six tetrahedra, in which a linear function
// has one triangle or quadrangle. Counts cut edges, faces and tetrahedra; components by joining edges over faces.
std::pair<int, int> by_subdivision(const Values& f, int n) {
  auto id = [&](int i, int j, int k) { return i + n * (j + n * k); };
  std::vector<char> in(size_t(n) * size_t(n) * size_t(n));
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        in[size_t(id(i, j, k))] = trilinear(f, double(i) / (n - 1), double(j) / (n - 1), double(k) / (n - 1)) >= 0;
  std::set<std::array<int, 2>> edges;
  std::set<std::array<int, 3>> faces;
  int solids = 0;
  for (int k = 0; k + 1 < n; ++k)
    for (int j = 0; j + 1 < n; ++j)
      for (int i = 0; i + 1 < n; ++i) {
        int axes[3] = {0, 1, 2};
        do {  // the corners on a monotone path
          int at[3] = {i, j, k}, p[4] = {id(i, j, k), 0, 0, 0};
          for (int s = 0; s < 3; ++s) ++at[axes[s]], p[s + 1] = id(at[0], at[1], at[2]);
          int count = 0;
          for (int c : p) count += in[size_t(c)];
          if (count == 0 || count == 4) continue;
          ++solids;
          for (int a = 0; a < 4; ++a)
            for (int b = a + 1; b < 4; ++b) {
              if (in[size_t(p[a])] != in[size_t(p[b])]) edges.insert({p[a], p[b]});
              for (int c = b + 1; c < 4; ++c)
                if (in[size_t(p[a])] != in[size_t(p[b])] || in[size_t(p[b])] != in[size_t(p[c])]) faces.insert({p[a], p[b], p[c]});
            }
        } while (std::next_permutation(axes, axes + 3));
      }
  std::map<std::array<int, 2>, int> number;
  for (const auto& e : edges) number.emplace(e, int(number.size()));
  UnionFind joined(number.size());
  for (const auto& t : faces) {
    int first = -1;
    for (const std::array<int, 2> e : {std::array{t[0], t[1]}, std::array{t[1], t[2]}, std::array{t[0], t[2]}})
      if (const auto it = number.find(e); it != number.end()) {
        if (first >= 0) joined.join(first, it->second);
        first = it->second;
      }
  }
  int components = 0;
  for (size_t i = 0; i < number.size(); ++i) components += joined.root(int(i)) == int(i);
  return {int(edges.size()) - int(faces.size()) + solids, components};
}

// Which faces of the cell (bits 2 axis + side) an edge of the cell lies on.
int faces_of(int e) {
  const auto [a, b] = lattice_cases().shape().edges[size_t(e)];
  int mask = 0;
  for (int axis = 0; axis < 3; ++axis)
    if (((a ^ b) >> axis & 1) == 0) mask |= 1 << (2 * axis + (a >> axis & 1));
  return mask;
}

// Compares cut_trilinear with the oracle; what is wrong, or null.
const char* fault(const Values& f, const CellTopology& right, TrilinearCell& cell) {
  cut_trilinear(f.data(), cell);
  bool used[20] = {}, has[20][20] = {};
  int next_on_border[20], edges = 0, points = 0, border = 0, components = 0;
  std::fill(next_on_border, next_on_border + 20, -1);
  UnionFind parts(20);
  for (int t = 0; t < cell.triangle_count; ++t)
    for (size_t k = 0; k < 3; ++k) {
      const int a = cell.triangles[size_t(t)][k], b = cell.triangles[size_t(t)][(k + 1) % 3];
      if (a == b || has[a][b]) return "an edge is used twice in one direction";
      has[a][b] = used[a] = true;
      parts.join(a, b);
    }
  for (int e = 0; e < 20; ++e) {
    points += used[e];
    components += used[e] && parts.root(e) == e;
    if (e < 12 && used[e] != (right.part[size_t(e)] >= 0)) return "points are not the cut edges";
    if (e >= 12 && used[e] != (e < 12 + cell.inner_count)) return "an inner point is not used";
  }
  for (int a = 0; a < 20; ++a)
    for (int b = 0; b < 20; ++b) {
      if (!has[a][b]) continue;
      const bool on_face = a < 12 && b < 12 && (faces_of(a) & faces_of(b));
      if (has[b][a]) {
        edges += a < b;
        if (on_face) return "an inner edge lies in a face";
      } else {
        ++edges, ++border;
        if (!on_face) return "a border edge does not lie in a face";
        if (next_on_border[a] >= 0) return "two borders meet at a point";
        next_on_border[a] = b;
      }
    }
  for (int e = 0; e < 12; ++e)
    if (used[e] && next_on_border[e] < 0) return "a cut edge is not on the border";
  if (points - edges + cell.triangle_count != right.euler) return "Euler number";
  if (components != right.components) return "components";
  for (int a = 0; a < 12; ++a)
    for (int b = 0; b < 12; ++b)
      if (used[a] && used[b] && (parts.root(a) == parts.root(b)) != (right.part[size_t(a)] == right.part[size_t(b)])) return "parts";
  return nullptr;
}

Values random_cell(uint64_t seed, uint64_t i, bool whole, bool alternating) {
  Values f;
  for (uint64_t c = 0; c < 8; ++c) {
    const double r = random_unit(seed, 8 * i + c);
    f[c] = whole ? std::floor(7 * r) - 3 : 2 * r - 1;
    if (alternating) f[c] = (std::popcount(c) % 2 ? -1 : 1) * std::abs(f[c]);
  }
  return f;
}

struct Known {
  const char* name;
  Values f;
  int euler, components;
};
// Corner values; the numbers of the cases are those of Chernyaev's marching cubes 33.
const Known known[] = {
    {"case 1", {1, -1, -1, -1, -1, -1, -1, -1}, 1, 1},          {"case 3.1, apart", {1, -3, -3, 1, -1, -1, -1, -1}, 2, 2},
    {"case 3.2, joined", {3, -1, -1, 3, -1, -1, -1, -1}, 1, 1}, {"case 4.1", {1, -1, -1, -1, -1, -1, -1, 1}, 2, 2},
    {"case 4.2, tunnel", {9, -1, -1, -1, -1, -1, -1, 9}, 0, 1}, {"case 4.2 with the signs turned", {-9, 1, 1, 1, 1, 1, 1, -9}, 0, 1},
    {"case 7.1", {-3, 1, 1, -3, 1, -3, -3, -9}, 3, 3},          {"case 10.1.1", {-3, -3, 2, 2, 2, 2, -3, -3}, 2, 2},
    {"case 13.1", {9, -1, -1, 9, -1, 9, 9, -1}, 4, 4},          {"case 8", {1, 1, 1, 1, -1, -1, -1, -1}, 1, 1},
};

}  // namespace

TEST_CASE("trilinear oracle: known cells, and a fine subdivision counts the same") {
  for (const Known& k : known) {
    CAPTURE(k.name);
    const CellTopology t = cell_topology(k.f);
    CHECK(t.euler == k.euler);
    CHECK(t.components == k.components);
  }
  // Cells whose critical values lie away from zero, so that the subdivision sees what is there.
  int compared = 0, tunnels = 0;
  for (uint64_t i = 0; compared < 24 || tunnels < 4; ++i) {
    const Values f = random_cell(3, i, false, i % 4 != 0);
    const CellTopology t = cell_topology(f);
    if (t.components != 1 && compared >= 24) continue;
    if (compared >= 24 && t.euler != 0) continue;
    bool stable = true;
    for (double shift : {-0.06, 0.06}) {
      Values g = f;
      for (double& v : g) v += shift;
      stable = stable && cell_topology(g) == t;
    }
    if (!stable) continue;
    const auto [euler, components] = by_subdivision(f, 14);
    CHECK(euler == t.euler);
    CHECK(components == t.components);
    tunnels += t.euler == 0;
    ++compared;
  }
}

TEST_CASE("trilinear cell: 0 of 10000 random cells are wrong, nor of 10000 with all signs alternating") {
  for (const bool alternating : {false, true}) {
    int wrong = 0, tunnels = 0;
    TrilinearCell cell;
    for (uint64_t i = 0; i < 10000; ++i) {
      const Values f = random_cell(11, i, false, alternating);
      const char* bad = fault(f, cell_topology(f), cell);
      if (bad && ++wrong < 4) MESSAGE(bad);
      tunnels += cell.tube;
    }
    CHECK(wrong == 0);
    CHECK(tunnels > 20);
  }
}

TEST_CASE("trilinear cell: 0 of all cells of -1, 0 and 1 and of 10000 of -3 to 3 are wrong, ties and all") {
  int wrong = 0, tunnels = 0;
  TrilinearCell cell;
  auto check = [&](const Values& f) {
    const char* bad = fault(f, cell_topology(f, true), cell);
    if (bad && ++wrong < 4) MESSAGE(bad);
    tunnels += cell.tube;
  };
  for (int i = 0; i < 6561; ++i) {
    Values f;
    for (int c = 0, q = i; c < 8; ++c, q /= 3) f[size_t(c)] = q % 3 - 1;
    check(f);
  }
  for (uint64_t i = 0; i < 10000; ++i) check(random_cell(12, i, true, i % 2));
  CHECK(wrong == 0);
  CHECK(tunnels > 100);
}

TEST_CASE("trilinear cell: triangles of a cell never cross, and the counts without places are the same") {
  auto side = [](Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    const double v = dot(cross(b - a, c - a), d - a);
    return v > 1e-9 ? 1 : v < -1e-9 ? -1 : 0;
  };
  auto pierces = [&](Vec3 p, Vec3 q, Vec3 a, Vec3 b, Vec3 c) {
    if (side(a, b, c, p) * side(a, b, c, q) >= 0) return false;
    const int s = side(p, q, a, b);
    return s != 0 && s == side(p, q, b, c) && s == side(p, q, c, a);
  };
  CHECK(pierces({.2, .2, -1}, {.2, .2, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  int crossing = 0, tubes = 0;
  TrilinearCell cell, counts;
  for (uint64_t i = 0; i < 3000; ++i) {
    const Values f = random_cell(15, i, false, i % 3 != 0);
    cut_trilinear(f.data(), cell);
    cut_trilinear(f.data(), counts, false);
    CHECK(counts.triangle_count == cell.triangle_count);
    CHECK(counts.inner_count == cell.inner_count);
    tubes += cell.tube;
    Vec3 at[20];
    for (size_t e = 0; e < 12; ++e) {
      const auto [a, b] = lattice_cases().shape().edges[e];
      at[e] = Vec3(a & 1, a >> 1 & 1, a >> 2);
      at[e][int(e) / 4] = f[a] / (f[a] - f[b]);
    }
    for (size_t k = 0; k < size_t(cell.inner_count); ++k) at[12 + k] = Vec3(cell.inner[k][0], cell.inner[k][1], cell.inner[k][2]);
    for (size_t t = 0; t < size_t(cell.triangle_count); ++t)
      for (size_t k = 0; k < 3; ++k)
        for (size_t o = 0; o < size_t(cell.triangle_count); ++o) {
          const auto &one = cell.triangles[t], &two = cell.triangles[o];
          const uint8_t p = one[k], q = one[(k + 1) % 3];
          if (std::any_of(two.begin(), two.end(), [&](uint8_t c) { return c == p || c == q; })) continue;
          crossing += pierces(at[p], at[q], at[two[0]], at[two[1]], at[two[2]]);
        }
  }
  CHECK(crossing == 0);
  CHECK(tubes > 10);
}

TEST_CASE("trilinear cell: inner points lie on the surface, and values that are not finite do no harm") {
  TrilinearCell cell;
  int inner = 0;
  double worst = 0;
  for (uint64_t i = 0; i < 4000; ++i) {
    const Values f = random_cell(13, i, false, true);
    cut_trilinear(f.data(), cell);
    for (int k = 0; k < cell.inner_count; ++k) {
      const auto& p = cell.inner[size_t(k)];
      for (double x : p) CHECK((x > 0 && x < 1));
      if (cell.tube) worst = std::max(worst, std::abs(trilinear(f, p[0], p[1], p[2])));
      ++inner;
    }
  }
  CHECK(inner > 1000);
  CHECK(worst < 1e-5);
  const double odd[] = {HUGE_VAL, -HUGE_VAL, 1e300, -1e300, 1e-320, -1e-320, 0, -0.0};
  for (uint64_t i = 0; i < 4000; ++i) {
    Values f;
    for (uint64_t c = 0; c < 8; ++c) f[c] = odd[size_t(8 * random_unit(14, 8 * i + c))];
    cut_trilinear(f.data(), cell);
    for (int k = 0; k < cell.inner_count; ++k)
      for (double x : cell.inner[size_t(k)]) CHECK((x > 0 && x < 1));
  }
}

TEST_CASE("contour: 0 of 10000 random closed grids have a wrong Euler number, component count or genus") {
  const size_t n = 7, rows = n * n * n;  // 5^3 random samples inside a border
  std::atomic<int> wrong = 0, rough = 0;
  auto check = [&](uint64_t seed) {
    const bool whole = seed % 2, positive = seed / 2 % 2;
    std::vector<double> v(rows);
    for (size_t p = 0; p < rows; ++p) {
      const size_t at[3] = {p % n, p / n % n, p / n / n};
      const bool border = std::any_of(at, at + 3, [&](size_t i) { return i == 0 || i == n - 1; });
      const double r = random_unit(21, seed * rows + p);
      v[p] = border ? (positive ? 1 : -1) * (whole ? 1 + std::floor(3 * r) : 0.1 + r) : whole ? std::floor(7 * r) - 3 : 2 * r - 1;
    }
    // The sum over cells, minus the arcs on faces that two cells share, plus the cut edges; components joined at cut edges.
    auto positive_at = [&](size_t p) { return v[p] >= 0; };
    int euler = 0;
    UnionFind joined(3 * rows + 1);
    std::vector<char> cut(3 * rows);
    const size_t step[3] = {1, n, n * n};
    auto corners = [&](size_t p) {
      Values f;
      for (size_t c = 0; c < 8; ++c) f[c] = v[p + (c & 1) * step[0] + (c >> 1 & 1) * step[1] + (c >> 2) * step[2]];
      return f;
    };
    for (size_t p = 0; p < rows; ++p) {
      const size_t at[3] = {p % n, p / n % n, p / n / n};
      for (size_t a = 0; a < 3; ++a) {
        const size_t s = (a + 1) % 3, t = (a + 2) % 3;
        if (at[a] + 1 < n) cut[3 * p + a] = positive_at(p) != positive_at(p + step[a]), euler += cut[3 * p + a];
        if (at[s] + 1 == n || at[t] + 1 == n) continue;
        const bool q[4] = {positive_at(p), positive_at(p + step[s]), positive_at(p + step[s] + step[t]), positive_at(p + step[t])};
        euler -= ((q[0] != q[1]) + (q[1] != q[2]) + (q[2] != q[3]) + (q[3] != q[0])) / 2;
      }
      if (at[0] + 1 == n || at[1] + 1 == n || at[2] + 1 == n) continue;
      const Values f = corners(p);
      if (std::all_of(f.begin(), f.end(), [](double x) { return x >= 0; }) ||
          std::all_of(f.begin(), f.end(), [](double x) { return x < 0; }))
        continue;
      CellTopology cell;
      if (whole) cell = cell_topology(f, true);
      else cell = sweep(f, int(seed % 3));
      euler += cell.euler;
      auto edge = [&](int e) {
        const auto low = lattice_cases().shape().edges[size_t(e)][0];
        return int(3 * (p + (low & 1) * step[0] + (low >> 1 & 1) * step[1] + (low >> 2) * step[2]) + size_t(e) / 4);
      };
      for (int e = 0; e < 12; ++e)
        if (cell.part[size_t(e)] >= 0) joined.join(edge(e), edge(cell.part[size_t(e)]));
    }
    int components = 0;
    for (size_t e = 0; e < 3 * rows; ++e) components += cut[e] && joined.root(int(e)) == int(e);

    const auto d = contour_at(grid_of<double>({n, n, n}, std::move(v)), 0);
    // Two triangles on every edge, so the Euler number follows from the counts; `faults` for some, as it is slow.
    const auto& m = *d->as<SurfaceMesh>();
    const auto ids = m.polygons.connectivity.view<int32_t>();
    UnionFind found(d->point_count());
    for (size_t t = 0; t < ids.count; t += 3) found.join(ids[t], ids[t + 1]), found.join(ids[t], ids[t + 2]);
    int pieces = 0;
    for (size_t p = 0; p < d->point_count(); ++p) pieces += found.root(int(p)) == int(p);
    std::vector<std::pair<int, int>> edges;
    for (size_t t = 0; t < ids.count; ++t) edges.emplace_back(ids[t], ids[t % 3 == 2 ? t - 2 : t + 1]);
    std::sort(edges.begin(), edges.end());
    bool closed = std::adjacent_find(edges.begin(), edges.end()) == edges.end();
    for (auto [a, b] : edges) closed = closed && std::binary_search(edges.begin(), edges.end(), std::pair{b, a});
    const int chi = int(d->point_count()) - int(ids.count) / 6;
    // Genus: components - chi / 2, so it is right when both are.
    if (chi != euler || pieces != components || !closed) ++wrong;
    rough += chi != 2 * pieces;
  };
  parallel_for(10000, 500, [&](size_t begin, size_t end) {
    for (size_t seed = begin; seed < end; ++seed) check(seed);
  });
  CHECK(wrong == 0);
  CHECK(rough > 1000);
}
