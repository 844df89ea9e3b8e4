// SPDX-License-Identifier: Apache-2.0
// Brute force for volumes: the midpoint rule at a hundredth of a cell with the curves themselves, in double.
#pragma once
#include "color/cie.h"
#include "volume_support.h"

namespace sg::test {

/// Samples of a grid for brute force: trilinear, clamped.
struct Lattice {
  std::array<size_t, 3> n;
  std::vector<double> x[3];  // per axis, ascending
  Vec3 origin{0, 0, 0};
  Mat3 turn;  // world = origin + turn * (x, y, z)
  std::vector<double> v;

  double at(const Vec3& p) const {
    size_t c[3];
    double f[3];
    for (int a = 0; a < 3; ++a) {
      const auto& g = x[a];
      const double q = std::clamp(p[a], g.front(), g.back());
      c[a] = std::min(size_t(std::upper_bound(g.begin(), g.end(), q) - g.begin()), g.size() - 1) - 1;
      f[a] = (q - g[c[a]]) / (g[c[a] + 1] - g[c[a]]);
    }
    double sum = 0;
    for (int k = 0; k < 8; ++k) {
      const size_t at[3] = {c[0] + (k & 1), c[1] + (k >> 1 & 1), c[2] + (k >> 2)};
      sum += (k & 1 ? f[0] : 1 - f[0]) * (k & 2 ? f[1] : 1 - f[1]) * (k & 4 ? f[2] : 1 - f[2]) * v[at[0] + n[0] * (at[1] + n[1] * at[2])];
    }
    return sum;
  }
  /// Of Lagrange's parabola through each sample and its neighbours (at the border: the two next to it), linear between the samples.
  Vec3 gradient(const Vec3& p) const {
    Vec3 g;
    for (int a = 0; a < 3; ++a) g[a] = between_samples(a, p);
    return turn * g;
  }

 private:
  double between_samples(int axis, Vec3 p) const {
    const auto& g = x[axis];
    const double q = std::clamp(p[axis], g.front(), g.back());
    const size_t c = std::min(size_t(std::upper_bound(g.begin(), g.end(), q) - g.begin()), g.size() - 1) - 1;
    const auto value = [&](size_t i) {
      p[axis] = g[i];
      return at(p);
    };
    const auto derivative = [&](size_t i) {
      if (g.size() == 2) return (value(1) - value(0)) / (g[1] - g[0]);
      const size_t m = std::clamp<size_t>(i, 1, g.size() - 2);
      double sum = 0;
      for (size_t k = m - 1; k <= m + 1; ++k) {
        const double one = g[m - 1 + (k + 2 - m) % 3], two = g[m - 1 + (k + 3 - m) % 3];  // the places of the other two
        sum += value(k) * (2 * g[i] - one - two) / ((g[k] - one) * (g[k] - two));
      }
      return sum;
    };
    const double f = (q - g[c]) / (g[c + 1] - g[c]);
    return (1 - f) * derivative(c) + f * derivative(c + 1);
  }
};

struct Case {
  std::string name;
  Lattice lattice;
  DatasetPtr data;
  ColorScale color;
  OpacityCurve opacity;
  double unit = 0.1;
  bool shaded = false;
  int per_cell = 100;                                            // steps of the reference; more where the medium is thinner than those
  OpacityCurve factor{{}};                                       // over the length of the gradient; no points: none
  std::function<double(double value, double gradient)> plane{};  // opacity over both; none: what the curves say
};

inline Lattice lattice_of(size_t n, const std::function<double(Vec3)>& f, bool uneven = false) {
  Lattice l;
  l.n = {n, n, n};
  for (int a = 0; a < 3; ++a)
    for (size_t i = 0; i < n; ++i) {
      double t = double(i) / double(n - 1);
      if (uneven) t = a == 0 ? t * t * 0.7 + 0.3 * t : a == 1 ? t + 0.1 * std::sin(6 * t) * (1 - t) : t;
      l.x[a].push_back(2 * t - 1);
    }
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i) l.v.push_back(double(float(f({l.x[0][i], l.x[1][j], l.x[2][k]}))));
  return l;
}

inline DatasetPtr dataset_of(const Lattice& l, bool uneven, ElementType type = ElementType::f32) {
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(l.v).converted(type), "", Role::scalars});
  if (uneven) {
    RectilinearGrid g;
    g.x = Array::from_vector(l.x[0]), g.y = Array::from_vector(l.x[1]), g.z = Array::from_vector(l.x[2]);
    return make_dataset(g, fields);
  }
  UniformGrid g;
  g.dims = l.n;
  const double h = 2.0 / double(l.n[0] - 1);
  g.spacing = {h, h, h};
  g.origin = l.origin + l.turn * Vec3{-1, -1, -1};
  g.direction = l.turn;
  return make_dataset(g, fields);
}

inline double bumpy(Vec3 p) { return std::sin(3 * p.x + 1) * std::cos(2.5 * p.y) + 0.7 * std::sin(4 * p.z + p.x * p.y); }

inline ColorScale colored(double lo, double hi, const char* map = "sight") {
  ColorScale s;
  s.map = find_colormap(map);
  s.lo = lo, s.hi = hi;
  return s;
}
inline OpacityCurve curve(std::vector<Vec2> points) {
  OpacityCurve c;
  c.points = std::move(points);
  return c;
}

inline Vec4 brute_force(const Case& c, const Projection& view, int px, int py, const Scene& scene) {
  const Projection::Ray ray = view.ray(px + 0.5, py + 0.5);
  const Mat3 back = transpose(c.lattice.turn);
  const Vec3 o = back * (ray.origin - c.lattice.origin), d = back * ray.direction;
  double from = view.near_plane * ray.per_depth, to = 1e9;
  for (int a = 0; a < 3; ++a) {
    const double t0 = (c.lattice.x[a].front() - o[a]) / d[a], t1 = (c.lattice.x[a].back() - o[a]) / d[a];
    from = std::max(from, std::min(t0, t1)), to = std::min(to, std::max(t0, t1));
  }
  if (!(from < to)) return {0, 0, 0, 1};
  const auto [lo, hi] = std::minmax_element(c.lattice.v.begin(), c.lattice.v.end());
  const double h0 = 2 / double(c.lattice.n[0] - 1) / c.per_cell, edge = 2 / double(c.lattice.n[0] - 1);
  const int n = int((to - from) / h0) + 1;
  const double h = (to - from) / n;
  Vec4 out{0, 0, 0, 1};
  const std::vector<Light> lights = lights_of(scene);
  const VolumeLight& terms = std::get<VolumeItem>(scene.items[0]).light;
  for (int i = 0; i < n && out.w > 1e-7; ++i) {
    const Vec3 p = o + d * (from + (i + 0.5) * h);
    const double value = c.lattice.at(p);
    double opacity = c.plane ? c.plane(value, length(c.lattice.gradient(p))) : c.opacity.at(value) * double(c.color.color(value).w);
    if (opacity > 0 && !c.factor.points.empty()) opacity *= c.factor.at(length(c.lattice.gradient(p)));
    if (opacity <= 0) continue;
    const double alpha = 1 - std::pow(1 - std::min(opacity, 1 - 1e-12), h / c.unit);
    const Vec4f s = c.color.color(value);
    Vec3 color{srgb_to_linear(double(s.x)), srgb_to_linear(double(s.y)), srgb_to_linear(double(s.z))};
    if (c.shaded) {
      const Vec3 g = c.lattice.gradient(p);
      const double size = length(g), surface = std::min(1.0, size * edge / (0.002 * (*hi - *lo)));
      if (size > 0) {
        const Vec3 normal = g * ((dot(g, ray.direction) > 0 ? -1 : 1) / size);
        double diffuse = 0, specular = 0;
        for (const Light& l : lights) {
          const Vec3 towards = normalize(
              l.follows_camera ? view.right * l.direction.x + view.up * l.direction.y - view.forward * l.direction.z : l.direction);
          const double e = dot(normal, towards);
          if (e <= 0) continue;
          diffuse += double(l.intensity) * e;
          specular += double(l.intensity) * std::pow(std::max(0.0, dot(normal, normalize(towards - ray.direction))), terms.power);
        }
        color = color * (1 + surface * (terms.ambient + terms.diffuse * diffuse - 1));
        const double flash = surface * terms.specular * specular;
        color += Vec3{flash, flash, flash};
      }
    }
    for (int k = 0; k < 3; ++k) out[k] += out.w * alpha * color[k];
    out.w *= 1 - alpha;
  }
  return out;
}

}  // namespace sg::test
