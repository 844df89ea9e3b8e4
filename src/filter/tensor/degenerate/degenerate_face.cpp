// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/degenerate/degenerate_face.h"

#include <algorithm>
#include <cstddef>
#include <tuple>

namespace sg {

namespace {

struct Corners {
  SymTensor a, b, c;
  double s[3], t[3];  // their places in the whole triangle
};

// Whether none of the forms can be ruled out by the sign of its Bernstein coefficients. With the polar form F of a cubic form f, F(a,a,b)
// and F(a,b,c) are the coefficients on the sides and in the middle.
bool may_vanish(const Corners& k) {
  const SymTensor* v[3] = {&k.a, &k.b, &k.c};
  double lo[7], hi[7], corner[3][7], pair[3][7], f[7];
  auto take = [&](int i, double x) { lo[i] = std::min(lo[i], x), hi[i] = std::max(hi[i], x); };
  for (int c = 0; c < 3; ++c) degeneracy_forms(*v[c], corner[c]);
  for (int i = 0; i < 7; ++i) {
    lo[i] = std::min({corner[0][i], corner[1][i], corner[2][i]});
    hi[i] = std::max({corner[0][i], corner[1][i], corner[2][i]});
  }
  for (int p = 0; p < 3; ++p) {
    const int q = (p + 1) % 3;
    degeneracy_forms(*v[p] + *v[q], pair[p]);
    degeneracy_forms(*v[p] * 2 + *v[q], f);
    for (int i = 0; i < 7; ++i) take(i, (f[i] - 6 * corner[p][i] - 2 * pair[p][i] + corner[q][i]) / 6);
    degeneracy_forms(*v[p] + *v[q] * 2, f);
    for (int i = 0; i < 7; ++i) take(i, (f[i] - 6 * corner[q][i] - 2 * pair[p][i] + corner[p][i]) / 6);
  }
  degeneracy_forms(k.a + k.b + k.c, f);
  for (int i = 0; i < 7; ++i) {
    take(i, (f[i] - pair[0][i] - pair[1][i] - pair[2][i] + corner[0][i] + corner[1][i] + corner[2][i]) / 6);
    if (lo[i] > 1e-13 || hi[i] < -1e-13) return false;
  }
  return true;
}

// Newton from (s, t); true when it arrives at a double eigenvalue.
bool converge(const SymTensor& a, const SymTensor& b, const SymTensor& c, DegeneratePlace& x) {
  const SymTensor ds = b - a, dt = c - a;
  for (int round = 0; round < 20; ++round) {
    const SymTensor d = a + ds * x.s + dt * x.t;
    const Eigen3 e = eigen_of(d);
    x.planar = e.value[0] - e.value[1] < e.value[1] - e.value[2];
    const Vec3 p = e.vector[x.planar ? 0 : 1], q = e.vector[x.planar ? 1 : 2];
    const double gap = d.along(p) - d.along(q), mixed = dot(p, d * q);
    if (std::abs(gap) + std::abs(mixed) < 1e-13 * d.norm() && round > 0) {
      x.twice = (d.along(p) + d.along(q)) / 2, x.once = e.value[x.planar ? 2 : 0], x.axis = e.vector[x.planar ? 2 : 0];
      return true;
    }
    const double m[2][2] = {{ds.along(p) - ds.along(q), dt.along(p) - dt.along(q)}, {dot(p, ds * q), dot(p, dt * q)}};
    const double det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    if (!(std::abs(det) > 1e-15)) return false;
    const double step_s = (-gap * m[1][1] + mixed * m[0][1]) / det, step_t = (gap * m[1][0] - mixed * m[0][0]) / det;
    x.s += step_s, x.t += step_t;
    if (!(std::abs(x.s) < 3 && std::abs(x.t) < 3)) return false;
    if (std::abs(step_s) + std::abs(step_t) < 1e-15) {  // as near as doubles come
      const SymTensor last = a + ds * x.s + dt * x.t;
      const Eigen3 l = eigen_of(last);
      const double left = x.planar ? l.value[0] - l.value[1] : l.value[1] - l.value[2];
      if (left > 1e-10 * last.norm()) return false;
      x.twice = (x.planar ? l.value[0] + l.value[1] : l.value[1] + l.value[2]) / 2;
      x.once = l.value[x.planar ? 2 : 0], x.axis = l.vector[x.planar ? 2 : 0];
      return true;
    }
  }
  return false;
}

// Divides the triangle until its parts have no places left, or one each.
class Search {
 public:
  Search(const Corners& whole, std::vector<DegeneratePlace>& out) : whole_(whole), out_(out), first_(out.size()) {}

  void run(const Corners& k, int depth = 0) {
    if (fruitless_ >= most_fruitless || !may_vanish(k)) return;
    if (depth >= 2) look_in(k);
    if (depth >= 5 || out_.size() - first_ >= 12) return;
    // Four triangles of half the size; the tensor stays linear on each.
    const SymTensor ab = (k.a + k.b) * 0.5, bc = (k.b + k.c) * 0.5, ca = (k.c + k.a) * 0.5;
    const double s[3] = {(k.s[0] + k.s[1]) / 2, (k.s[1] + k.s[2]) / 2, (k.s[2] + k.s[0]) / 2};
    const double t[3] = {(k.t[0] + k.t[1]) / 2, (k.t[1] + k.t[2]) / 2, (k.t[2] + k.t[0]) / 2};
    run({k.a, ab, ca, {k.s[0], s[0], s[2]}, {k.t[0], t[0], t[2]}}, depth + 1);
    run({ab, k.b, bc, {s[0], k.s[1], s[1]}, {t[0], k.t[1], t[1]}}, depth + 1);
    run({ca, bc, k.c, {s[2], s[1], k.s[2]}, {t[2], t[1], k.t[2]}}, depth + 1);
    run({ab, bc, ca, {s[0], s[1], s[2]}, {t[0], t[1], t[2]}}, depth + 1);
  }

 private:
  // A face that is degenerate all over, but for rounding, has parts without end in which nothing is found; others a few around each place.
  static constexpr int most_fruitless = 100;

  void look_in(const Corners& k) {
    DegeneratePlace x;
    x.s = (k.s[0] + k.s[1] + k.s[2]) / 3, x.t = (k.t[0] + k.t[1] + k.t[2]) / 3;
    constexpr double slack = 1e-10;
    if (!(converge(whole_.a, whole_.b, whole_.c, x) && x.s >= -slack && x.t >= -slack && x.s + x.t <= 1 + slack)) {
      ++fruitless_;
      return;
    }
    const bool known = std::any_of(out_.begin() + ptrdiff_t(first_), out_.end(),
                                   [&](const DegeneratePlace& o) { return std::abs(o.s - x.s) + std::abs(o.t - x.t) < 1e-7; });
    if (!known) out_.push_back(x);
  }

  const Corners& whole_;
  std::vector<DegeneratePlace>& out_;
  const size_t first_;
  int fruitless_ = 0;
};

}  // namespace

void degeneracy_forms(const SymTensor& d, double (&f)[7]) {
  const double xx = d.xx, yy = d.yy, zz = d.zz, xy = d.xy, yz = d.yz, xz = d.xz;
  f[0] = xx * (yy * yy - zz * zz) + xx * (xy * xy - xz * xz) + yy * (zz * zz - xx * xx) + yy * (yz * yz - xy * xy) +
         zz * (xx * xx - yy * yy) + zz * (xz * xz - yz * yz);
  f[1] = yz * (2 * (yz * yz - xx * xx) - (xz * xz + xy * xy) + 2 * (yy * xx + zz * xx - yy * zz)) + xy * xz * (2 * xx - zz - yy);
  f[2] = xz * (2 * (xz * xz - yy * yy) - (xy * xy + yz * yz) + 2 * (zz * yy + xx * yy - zz * xx)) + yz * xy * (2 * yy - xx - zz);
  f[3] = xy * (2 * (xy * xy - zz * zz) - (yz * yz + xz * xz) + 2 * (xx * zz + yy * zz - xx * yy)) + xz * yz * (2 * zz - yy - xx);
  f[4] = yz * (xz * xz - xy * xy) + xy * xz * (yy - zz);
  f[5] = xz * (xy * xy - yz * yz) + yz * xy * (zz - xx);
  f[6] = xy * (yz * yz - xz * xz) + xz * yz * (xx - yy);
}

void degenerate_places(const SymTensor& a, const SymTensor& b, const SymTensor& c, std::vector<DegeneratePlace>& out) {
  // The trace does not matter; sizes of 1 give tolerances a meaning.
  const double size = std::max({a.deviator().max_abs(), b.deviator().max_abs(), c.deviator().max_abs()});
  if (!(size > 0)) return;
  const Corners whole{a.deviator() * (1 / size), b.deviator() * (1 / size), c.deviator() * (1 / size), {0, 1, 0}, {0, 0, 1}};
  const size_t first = out.size();
  Search(whole, out).run(whole);
  for (size_t i = first; i < out.size(); ++i) {
    DegeneratePlace& x = out[i];
    const double mean = (a.trace() * (1 - x.s - x.t) + b.trace() * x.s + c.trace() * x.t) / 3;
    x.twice = x.twice * size + mean, x.once = x.once * size + mean;
  }
  std::sort(out.begin() + ptrdiff_t(first), out.end(),
            [](const DegeneratePlace& p, const DegeneratePlace& q) { return std::tie(p.s, p.t) < std::tie(q.s, q.t); });
}

}  // namespace sg
