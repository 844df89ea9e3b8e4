// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/parallel_tetra.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "filter/flow/eigen_general.h"

namespace sg::parallel {

namespace {

using std::numbers::pi;

Mat3 columns(Vec3 a, Vec3 b, Vec3 c) {
  Mat3 m;
  for (int i = 0; i < 3; ++i) m.m[i][0] = a[i], m.m[i][1] = b[i], m.m[i][2] = c[i];
  return m;
}

double largest(const Mat3& m) {
  double most = 0;
  for (const auto& row : m.m)
    for (const double e : row) most = std::max(most, std::abs(e));
  return most;
}

// Places t in (0, 1) of an edge where the fields are parallel. Each component of their cross product is a quadratic polynomial, whose
// roots are tried; one may have a double root where another has a simple one, which is exact. Points next to a corner that is one itself do
// not count.
int solve_edge(const Corner& p, const Corner& q, double nothing, double out[2]) {
  const Vec3 c00 = cross(p.a, p.b), c0 = cross(p.a, q.b) + cross(q.a, p.b), c11 = cross(q.a, q.b);
  const double most_a = std::max(p.most_a, q.most_a), most_b = std::max(p.most_b, q.most_b), near = 1e3 * nothing;
  std::pair<double, double> tried[6];  // what is left of the cross product, place
  int count = 0;
  for (int k = 0; k < 3; ++k) {  // c00 (1-t)^2 + c0 t (1-t) + c11 t^2 = e t^2 + f t + g
    const double e = c00[k] - c0[k] + c11[k], f = c0[k] - 2 * c00[k], g = c00[k], most = std::max({std::abs(e), std::abs(f), std::abs(g)});
    const double d = f * f - 4 * e * g;
    if (!(most > 0) || d < -1e-12 * most * most) continue;
    const double h = -0.5 * (f + (f < 0 ? -1 : 1) * std::sqrt(std::max(d, 0.0)));
    for (const double t : {e != 0 ? h / e : -1, h != 0 ? g / h : -1}) {
      if (!(t >= (p.parallel ? near : 0) && t <= (q.parallel ? 1 - near : 1))) continue;
      const Vec3 a = p.a * (1 - t) + q.a * t, b = p.b * (1 - t) + q.b * t;
      if (are_parallel(a, b, most_a, most_b, nothing)) tried[count++] = {length(cross(a, b)), t};
    }
  }
  std::sort(tried, tried + count);
  int n = 0;
  for (int k = 0; k < count && n < 2; ++k)
    if (n == 0 || std::abs(tried[k].second - out[0]) > std::max(near, 1e-6)) out[n++] = tried[k].second;
  return n;
}

// All s >= 0 with sum 1 and A s parallel to B s. The ratio is infinite where B s = 0.
int solve_triangle(const Corner* c[3], Found out[3]) {
  const Mat3 a = columns(c[0]->a, c[1]->a, c[2]->a), b = columns(c[0]->b, c[1]->b, c[2]->b);
  const double la = largest(a), lb = largest(b);
  if (!(la > 0 && lb > 0)) return 0;
  const double da = std::abs(determinant(a)) / (la * la * la), db = std::abs(determinant(b)) / (lb * lb * lb);
  if (!(da >= 1e-12 || db >= 1e-12)) return 0;
  const bool by_b = db >= da;
  const Mat3 m = by_b ? inverse(b) * a : inverse(a) * b;
  const GeneralEigenvalues e = general_eigenvalues(m);
  int n = 0;
  for (int k = 0; k < (e.complex_pair ? 1 : 3); ++k) {
    if (!std::isfinite(e.real[k])) continue;
    if (k > 0 && e.real[k] == e.real[k - 1]) continue;
    Vec3 s = eigenvector_of(m, e.real[k]);
    const double sum = s.x + s.y + s.z;
    if (sum == 0) continue;
    s = s / sum;
    if (!(s.x >= 0 && s.y >= 0 && s.z >= 0)) continue;
    Found& f = out[n++];
    f.s[0] = s.x, f.s[1] = s.y, f.s[2] = s.z;
    f.at = c[0]->at * s.x + c[1]->at * s.y + c[2]->at * s.z;
    f.ratio = by_b ? e.real[k] : 1 / e.real[k];
  }
  return n;
}

// Whether the fields have this angle somewhere in the tetrahedron: the null vector of a 3x4 matrix, by its minors.
bool inside_at(const Corner* c[4], double la, double lb, double angle) {
  Vec3 d[4];
  for (int k = 0; k < 4; ++k) d[k] = c[k]->a * (std::cos(angle) / la) - c[k]->b * (std::sin(angle) / lb);
  const double x[4] = {determinant(columns(d[1], d[2], d[3])), -determinant(columns(d[0], d[2], d[3])),
                       determinant(columns(d[0], d[1], d[3])), -determinant(columns(d[0], d[1], d[2]))};
  const bool plus = x[0] >= 0 && x[1] >= 0 && x[2] >= 0 && x[3] >= 0, minus = x[0] <= 0 && x[1] <= 0 && x[2] <= 0 && x[3] <= 0;
  return plus != minus;
}

constexpr int most_points = 28;  // corners, two on each edge, three on each face

// The points of the lines on the border of a tetrahedron, each once.
struct TetraPoints {
  const Corner (&c)[4];
  double nothing;
  Found here[most_points];
  int n = 0;
  Vec3 product[4][4];    // of the corners' fields, both ways
  bool line[4][4] = {};  // edges on which the fields are parallel all along

  TetraPoints(const Corner (&corners)[4], double least) : c(corners), nothing(least) {
    for (int i = 0; i < 4; ++i)
      for (int j = i; j < 4; ++j) product[i][j] = cross(c[i].a, c[j].b) + cross(c[j].a, c[i].b);
  }
  // See may_vanish(): between these corners, in bits.
  bool may_hold(unsigned corners) const {
    double la = 0, lb = 0;
    for (int i = 0; i < 4; ++i)
      if (corners >> i & 1) la = std::max(la, c[i].most_a), lb = std::max(lb, c[i].most_b);
    const double least = nothing * la * lb;
    bool plus[3] = {true, true, true}, minus[3] = {true, true, true};
    for (int i = 0; i < 4; ++i)
      for (int j = i; j < 4; ++j) {
        if (~corners & (1u << i | 1u << j)) continue;
        const Vec3 w = product[i][j];
        for (int k = 0; k < 3; ++k) plus[k] &= w[k] > least, minus[k] &= w[k] < -least;
      }
    return !(plus[0] | minus[0] | plus[1] | minus[1] | plus[2] | minus[2]);
  }

  void add(unsigned corners, const double* x, int place) {
    Found& f = here[n++];
    f.corners = corners;
    f.key = {{-1, -1, -1}, place};
    f.at = {};
    Vec3 a, b;
    int m = 0;
    for (int k = 0; k < 4; ++k) {
      f.x[k] = corners >> k & 1 ? x[k] : 0;
      if (!(corners >> k & 1)) continue;
      f.key.corners[size_t(m)] = c[k].id, f.s[m++] = x[k];
      f.at += c[k].at * x[k], a += c[k].a * x[k], b += c[k].b * x[k];
    }
    f.ratio = dot(a, b) / dot(b, b);
    if (!std::isfinite(f.ratio)) f.ratio = HUGE_VAL;
  }

  void solve() {
    for (int i = 0; i < 4; ++i) {
      double x[4] = {};
      x[i] = 1;
      if (c[i].parallel) add(1u << i, x, 0);
    }
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) solve_on_edge(i, j);
    for (int skip = 0; skip < 4; ++skip) solve_on_face(skip);
  }
  void solve_on_edge(int i, int j) {
    if (c[i].parallel && c[j].parallel) {
      line[i][j] = are_parallel(c[i].a + c[j].a, c[i].b + c[j].b, 2 * std::max(c[i].most_a, c[j].most_a),
                                2 * std::max(c[i].most_b, c[j].most_b), nothing);
      if (line[i][j]) return;
    }
    if (!may_hold(1u << i | 1u << j)) return;
    double t[2];
    const int places = solve_edge(c[i], c[j], nothing, t);
    for (int k = 0; k < places; ++k) {
      double x[4] = {};
      x[i] = 1 - t[k], x[j] = t[k];
      add(1u << i | 1u << j, x, k);
    }
  }
  // Inside of the face: not next to points on its edges, and not where a line lies in it, whose ends those are.
  void solve_on_face(int skip) {
    int t[3];
    for (int k = 0, m = 0; k < 4; ++k)
      if (k != skip) t[m++] = k;
    const unsigned face = 15u & ~(1u << skip);
    if (line[t[0]][t[1]] || line[t[0]][t[2]] || line[t[1]][t[2]] || !may_hold(face)) return;
    const int before = n;
    for (int i = 0; i < before; ++i)
      for (int j = i + 1; j < before; ++j)
        if (!((here[i].corners | here[j].corners) & ~face) && straight(i, j)) return;
    const Corner* corners[3] = {&c[t[0]], &c[t[1]], &c[t[2]]};
    Found solved[3];
    const int more = solve_triangle(corners, solved);
    for (int k = 0; k < more; ++k) {
      double x[4] = {};
      for (int m = 0; m < 3; ++m) x[t[m]] = solved[k].s[m];
      bool beside = false;
      for (int i = 0; i < before && !beside; ++i) {
        double off = here[i].corners & ~face ? 1 : 0;
        for (int m = 0; m < 4; ++m) off = std::max(off, std::abs(here[i].x[m] - x[m]));
        beside = off <= 1e3 * nothing;
      }
      if (beside) continue;
      add(face, x, k);
      here[n - 1].ratio = solved[k].ratio, here[n - 1].at = solved[k].at;
    }
  }

  // Whether the fields are parallel half way between two points, with no third point there.
  bool straight(int i, int j) const {
    Vec3 a, b;
    double most_a = 0, most_b = 0, along = 0;
    for (int k = 0; k < 4; ++k) {
      const double x = 0.5 * (here[i].x[k] + here[j].x[k]);
      a += c[k].a * x, b += c[k].b * x;
      along += (here[j].x[k] - here[i].x[k]) * (here[j].x[k] - here[i].x[k]);
      if (((here[i].corners | here[j].corners) >> k) & 1) most_a = std::max(most_a, c[k].most_a), most_b = std::max(most_b, c[k].most_b);
    }
    if (!are_parallel(a, b, most_a, most_b, nothing)) return false;
    for (int m = 0; m < n; ++m) {
      if (m == i || m == j) continue;
      double t = 0, off = 0;
      for (int k = 0; k < 4; ++k) t += (here[m].x[k] - here[i].x[k]) * (here[j].x[k] - here[i].x[k]) / along;
      for (int k = 0; k < 4; ++k) off = std::max(off, std::abs(here[i].x[k] + t * (here[j].x[k] - here[i].x[k]) - here[m].x[k]));
      if (t > 0 && t < 1 && off <= 1e3 * nothing) return false;
    }
    return true;
  }
  // Both on the border of one face: a line between them may as well belong to the tetrahedron on its other side.
  bool on_one_face(int i, int j) const {
    const unsigned both = here[i].corners | here[j].corners;
    return both != 15u && here[i].corners != here[j].corners;
  }
  // False where one field vanishes and the other too: their angle is any.
  bool has_angle(int i) const {
    Vec3 a, b;
    double most_a = 0, most_b = 0;
    for (int k = 0; k < 4; ++k) {
      a += c[k].a * here[i].x[k], b += c[k].b * here[i].x[k];
      most_a = std::max(most_a, c[k].most_a), most_b = std::max(most_b, c[k].most_b);
    }
    return length(a) > nothing * most_a || length(b) > nothing * most_b;
  }
};

}  // namespace

void TetraLines::tetra(const Corner& p, const Corner& q, const Corner& r, const Corner& s, int64_t cell) {
  const Corner* c[4] = {&p, &q, &r, &s};
  std::sort(c, c + 4, [](const Corner* l, const Corner* m) { return l->id < m->id; });
  const Corner all[4] = {*c[0], *c[1], *c[2], *c[3]};
  for (const Corner& k : all)
    if (!std::isfinite(dot(k.a, k.b))) return;
  TetraPoints t(all, nothing);
  if (!t.may_hold(15)) return;
  t.solve();
  if (t.n < 2) return;
  double la = 0, lb = 0;
  for (const Corner& k : all) la = std::max(la, length(k.a)), lb = std::max(lb, length(k.b));
  for (int k = 0; k < t.n; ++k) t.here[k].angle = std::atan(t.here[k].ratio * lb / la), t.here[k].cell = cell;
  Found* const here = t.here;
  const int n = t.n;
  std::sort(here, here + n, [](const Found& l, const Found& m) { return l.angle != m.angle ? l.angle < m.angle : l.key < m.key; });
  bool used[most_points] = {}, joined[most_points][most_points] = {};
  const auto join = [&](int i, int j) {
    if (joined[i][j]) return;
    joined[i][j] = joined[j][i] = true;
    const bool turn = here[j].key < here[i].key;
    segments.push_back({here[turn ? j : i].key, here[turn ? i : j].key, cell});
    used[i] = used[j] = true;
  };
  const auto between = [&](int i, int j, double angle) { return t.has_angle(i) && t.has_angle(j) && inside_at(c, la, lb, angle); };
  if (n == 2 && !t.on_one_face(0, 1)) {
    join(0, 1);  // in and out; the angle may well be the same all along
  } else {
    for (int i = 0; i < n; ++i)
      for (int j = i + 1; j < n; ++j)
        if (t.straight(i, j)) join(i, j);
    for (int i = 0; i + 1 < n; ++i)
      if (between(i, i + 1, (here[i].angle + here[i + 1].angle) / 2)) join(i, i + 1);
    if (n > 2 && between(n - 1, 0, (here[n - 1].angle + here[0].angle + pi) / 2)) join(n - 1, 0);
  }
  for (int i = 0; i < n; ++i)
    if (used[i]) found.push_back(here[i]);
}

}  // namespace sg::parallel
