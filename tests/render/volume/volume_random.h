// SPDX-License-Identifier: Apache-2.0
// Random volumes for property tests: fields, transfer functions, views and meshes, each with what is true of it (volume_truth.h).
#pragma once
#include <fmt/core.h>

#include "color/transfer_text.h"
#include "data/cells/point_positions.h"
#include "index/locator_meshes.h"
#include "render/volume/sources/cells/volume_cells_support.h"
#include "support/property.h"
#include "volume_support.h"
#include "volume_truth.h"

namespace sg::test {

/// Kinds of scenes that a generator may draw.
struct Kinds {
  bool steps = true;        ///< opacity that jumps, ramps narrower than a five hundredth of the range, clamp=false
  bool color_steps = true;  ///< two colours at one place, stops anywhere
  bool any_scale = true;    ///< fields times 1e-30 to 1e30, meshes times 1e-20 to 1e20
  bool opaque = true;       ///< opacity of 1
  bool refined = true;      ///< AMR grids
  bool lattices = true;     ///< besides meshes of cells
};

/// Samples on a box in index space [0, n-1]^3: trilinear in between; derivatives of Lagrange's parabola through each sample and its
/// neighbours, trilinear in between.
struct TrueLattice {
  std::array<int, 3> n;
  std::array<std::vector<double>, 3> x;  ///< of each axis, ascending, before turning
  Mat3 turn;                             ///< world = origin + turn * x
  Vec3 origin{0, 0, 0};
  std::vector<double> v;
  mutable std::vector<Vec3> slopes;

  size_t id(int i, int j, int k) const { return size_t(i) + size_t(n[0]) * (size_t(j) + size_t(n[1]) * size_t(k)); }
  Vec3 local(const Vec3& world) const { return transpose(turn) * (world - origin); }
  bool locate(const Vec3& p, std::array<int, 3>& c, Vec3& f) const {
    for (int a = 0; a < 3; ++a) {
      const auto& g = x[size_t(a)];
      const double slack = 1e-9 * (g.back() - g.front());
      if (!(p[a] >= g.front() - slack && p[a] <= g.back() + slack)) return false;
      c[size_t(a)] = int(std::clamp<long>(std::upper_bound(g.begin(), g.end(), p[a]) - g.begin() - 1, 0, long(g.size()) - 2));
      const double lo = g[size_t(c[size_t(a)])];
      f[a] = (p[a] - lo) / (g[size_t(c[size_t(a)]) + 1] - lo);
    }
    return true;
  }
  template <class T, class At>
  T mixed(const std::array<int, 3>& c, const Vec3& f, At at, T sum) const {
    for (int k = 0; k < 8; ++k)
      sum = sum + at(id(c[0] + (k & 1), c[1] + (k >> 1 & 1), c[2] + (k >> 2))) *
                      ((k & 1 ? f.x : 1 - f.x) * (k & 2 ? f.y : 1 - f.y) * (k & 4 ? f.z : 1 - f.z));
    return sum;
  }
  double value(const Vec3& world) const {
    std::array<int, 3> c;
    Vec3 f;
    if (!locate(local(world), c, f)) return NAN;
    return mixed(
        c, f, [&](size_t i) { return v[i]; }, 0.0);
  }
  Vec3 gradient(const Vec3& world) const {
    if (slopes.empty()) make_slopes();
    std::array<int, 3> c;
    Vec3 f;
    if (!locate(local(world), c, f)) return {0, 0, 0};
    return turn * mixed(
                      c, f, [&](size_t i) { return slopes[i]; }, Vec3{0, 0, 0});
  }
  void make_slopes() const {
    slopes.assign(v.size(), Vec3{0, 0, 0});
    const size_t step[3] = {1, size_t(n[0]), size_t(n[0]) * size_t(n[1])};
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i)
          for (int a = 0; a < 3; ++a) {
            const auto& g = x[size_t(a)];
            const int at = a == 0 ? i : a == 1 ? j : k, last = n[size_t(a)] - 1;
            const size_t here = id(i, j, k), s = step[a];
            double& d = slopes[here][a];
            if (last == 1) {
              const size_t first = here - size_t(at) * s;
              d = (v[first + s] - v[first]) / (g[1] - g[0]);
              continue;
            }
            const int m = std::clamp(at, 1, last - 1);
            const size_t middle = here + size_t(m - at) * s;
            // Slopes of the two chords, and the parabola's at g[at].
            const double h0 = g[size_t(m)] - g[size_t(m) - 1], h1 = g[size_t(m) + 1] - g[size_t(m)];
            const double d0 = (v[middle] - v[middle - s]) / h0, d1 = (v[middle + s] - v[middle]) / h1, bend = (d1 - d0) / (h0 + h1);
            d = d0 + bend * (2 * g[size_t(at)] - g[size_t(m) - 1] - g[size_t(m)]);
          }
  }
  /// t at which a ray crosses planes of samples.
  std::vector<double> ends(const Vec3& o, const Vec3& d) const {
    std::vector<double> t;
    const Vec3 p = local(o), q = transpose(turn) * d;
    for (int a = 0; a < 3; ++a)
      if (std::abs(q[a]) > 1e-12)
        for (double g : x[size_t(a)]) t.push_back((g - p[a]) / q[a]);
    return t;
  }
};

/// A volume, what is true of it, and how to say it.
struct RandomVolume {
  VolumeItem item;
  TrueTransfer transfer;
  std::function<TrueVolume(const Vec3& origin, const Vec3& direction)> along;
  Box3 box;
  double lo = 0, hi = 1;  ///< of the values
  double edge = 1;        ///< that surfaces are told by: Volume::edge
  double cell = 1;        ///< size of a cell, for cameras and units
  bool opaque = false;    ///< may opacity be 1 itself?
  std::string words;      ///< what it is, for findings
};

inline std::function<double(Vec3)> random_function(Random& r, std::string& words) {
  switch (r.whole(0, 4)) {
    case 0: {
      words += "polynomial ";
      std::array<double, 10> c;
      for (double& x : c) x = r.in(-1, 1);
      return [c](Vec3 p) {
        return c[0] * p.x + c[1] * p.y + c[2] * p.z + c[3] * p.x * p.x + c[4] * p.y * p.y + c[5] * p.z * p.z + c[6] * p.x * p.y +
               c[7] * p.y * p.z + c[8] * p.z * p.x + c[9] * p.x * p.y * p.z;
      };
    }
    case 1:
    case 2: {
      words += "waves ";
      std::vector<std::pair<Vec3, double>> waves;
      const double shortest = r.magnitude(2, 12);
      for (int i = 0; i < 8; ++i) waves.emplace_back(Vec3{r.in(-1, 1), r.in(-1, 1), r.in(-1, 1)} * shortest, r.in(0, 6.28));
      return [waves](Vec3 p) {
        double s = 0;
        for (const auto& [k, phase] : waves) s += std::cos(dot(k, p) + phase);
        return s;
      };
    }
    case 3: {
      words += "ball ";
      const Vec3 c{r.in(-0.7, 0.7), r.in(-0.7, 0.7), r.in(-0.7, 0.7)};
      return [c](Vec3 p) { return length(p - c); };
    }
    default: {
      words += "noise ";
      const auto seed = uint64_t(r.whole(1, 1000000));
      return [seed, i = uint64_t(0)](Vec3) mutable { return random_unit(seed, i++); };
    }
  }
}

/// Fits the numbers to a type, at a random scale and offset; they are what the type holds.
inline ElementType random_type(Random& r, const Kinds& kinds, std::vector<double>& v, std::string& words) {
  const auto [lo, hi] = std::minmax_element(v.begin(), v.end());
  const double first = *lo, size = *hi > *lo ? *hi - *lo : 1;
  const ElementType type = r.one_of({ElementType::u8, ElementType::u16, ElementType::f32, ElementType::f32, ElementType::f64});
  words += fmt::format("{} ", element_name(type));
  if (type == ElementType::u8 || type == ElementType::u16) {
    const double top = type == ElementType::u8 ? r.in(3, 255) : r.magnitude(300, 65535);
    for (double& x : v) x = std::round((x - first) / size * std::floor(top));
    return type;
  }
  const double scale = kinds.any_scale && r.chance(0.3) ? r.magnitude(1e-30, 1e30) : r.magnitude(1e-6, 1e6);
  const double offset = r.chance(0.5) ? 0 : r.in(-3, 3);
  words += fmt::format("times {:.3g} plus {:.3g} ", scale, offset * scale);
  for (double& x : v) {
    x = scale * ((x - first) / size + offset);
    if (type == ElementType::f32) x = double(float(x));
  }
  return type;
}

/// Opacity over [lo, hi], and colours on a scale that may reach beyond or end within.
inline void random_transfer(Random& r, const Kinds& kinds, double lo, double hi, double cell, RandomVolume& out, bool modest = false) {
  TrueTransfer& t = out.transfer;
  const double size = hi - lo;
  const double most = kinds.opaque && r.chance(0.2) ? 1 : r.one_of({0.05, 0.3, 0.7, 0.95, 0.999});
  const double narrowest = kinds.steps ? 1e-4 : 2e-3;
  std::vector<Vec2> points{{0, r.chance(0.7) ? 0.0 : r.in(0, 0.2)}};
  const int features = modest ? 1 : r.whole(1, 3);
  for (int i = 0; i < features; ++i) {
    const double from = double(i) / features, wide = 1.0 / features, at = from + wide * r.in(0.05, 0.6), rest = from + 0.98 * wide - at;
    double height = most * r.in(0.2, 1);
    const double before = points.back().y;
    if (out.opaque && most == 1 && height > 0.7) height = 1;
    switch (modest ? 0 : r.whole(0, kinds.steps ? 4 : 3)) {
      case 0: out.words += "ramp ", points.push_back({at, before}), points.push_back({at + rest, r.chance(0.7) ? height : 0}); break;
      case 1: {
        const double w = 0.5 * rest * r.magnitude(1e-4, 1);  // narrower ones are a few steps of f32 wide
        out.words += fmt::format("spike {:.2g} ", w);
        points.push_back({at, before}), points.push_back({at + w, height}), points.push_back({at + 2 * w, r.chance(0.8) ? 0 : before});
        break;
      }
      case 2: out.words += "flat ", points.push_back({at, before}), points.push_back({at + rest, before > 0 ? before : height}); break;
      case 3: {
        const double w = std::min(rest, r.magnitude(narrowest, 0.05));
        out.words += fmt::format("narrow ramp {:.2g} ", w);
        points.push_back({at, before}), points.push_back({at + w, before > 0 && r.chance(0.5) ? 0 : height});
        break;
      }
      default: {
        out.words += "step ";
        points.push_back({at, before}), points.push_back({at, before > 0 && r.chance(0.5) ? 0 : height});
      }
    }
  }
  for (Vec2& p : points) p.x = lo + p.x * size;
  t.opacity = points;
  out.item.opacity.points = points;
  // Thin to solid: up to an optical depth of about 70 over a cell.
  t.unit = out.item.unit_distance = cell * r.magnitude(0.1, 20);
  out.words += fmt::format("most {} unit {:.3g} cells ", most, t.unit / cell);

  ColorScale& s = out.item.color;
  s.lo = lo, s.hi = hi;
  if (lo > 0 && hi / lo > 2 && r.chance(0.5)) s.kind = ScaleKind::log, out.words += "log ";
  else if (r.chance(0.15))
    s.kind = ScaleKind::symlog, s.linear_threshold = r.in(0.01, 0.5) * std::max(std::abs(lo), std::abs(hi)), out.words += "symlog ";
  else if (r.chance(0.3)) s.lo -= size * r.in(-0.3, 0.3), s.hi += size * r.in(-0.3, 0.3);
  if (kinds.steps && r.chance(0.15)) s.clamp = false, out.words += "clamp=false ";
  t.lo = s.lo, t.hi = s.hi, t.kind = s.kind, t.threshold = s.linear_threshold > 0 ? s.linear_threshold : 1, t.clamp = s.clamp;
  const int stops = r.whole(2, 5);
  const bool constant = r.chance(0.15);
  std::string text;
  const auto color = [&] {
    const int c[3] = {r.whole(0, 255), r.whole(0, 255), r.whole(0, 255)};
    return std::array<int, 3>{c[0], c[1], c[2]};
  };
  std::array<int, 3> last = color();
  double at = 0;
  const auto stop = [&](double where, const std::array<int, 3>& c) {
    text += fmt::format("{}{}:#{:02x}{:02x}{:02x}", text.empty() ? "" : ",", where, c[0], c[1], c[2]);
    t.stops.push_back({where, Vec3{double(c[0]), double(c[1]), double(c[2])} / 255.0});
  };
  stop(0, last);
  for (int i = 1; i < stops; ++i) {
    at = i + 1 == stops ? 1 : kinds.color_steps ? at + (1 - at) * r.in(0.1, 0.8) : double(i) / (stops - 1);
    if (kinds.color_steps && i + 1 < stops && r.chance(0.4)) stop(at, last), out.words += "colour step ";
    if (!constant) last = color();
    stop(at, last);
  }
  parse_color_stops(text, s, true);
}

/// A lattice of samples over [-1, 1]^3 times `size`, uniform (turned, of uneven spacing) or rectilinear.
inline RandomVolume random_lattice(Random& r, const Kinds& kinds, bool uneven, double size, Vec3 middle = {0, 0, 0}) {
  RandomVolume out;
  out.words = uneven ? "rectilinear " : "uniform ", out.opaque = true;
  auto lattice = std::make_shared<TrueLattice>();
  TrueLattice& l = *lattice;
  l.n = {r.whole(5, 14), r.whole(5, 14), r.whole(5, 14)};
  if (!uneven && r.chance(0.5)) {
    const Vec3 a = normalize(Vec3{r.in(-1, 1), r.in(-1, 1), r.in(-1, 1)}), b = normalize(cross(a, Vec3{r.in(-1, 1), r.in(-1, 1), 1.5}));
    const Vec3 c = cross(a, b);
    for (int i = 0; i < 3; ++i) l.turn.m[i][0] = a[i], l.turn.m[i][1] = b[i], l.turn.m[i][2] = c[i];
  }
  l.origin = middle;
  for (size_t a = 0; a < 3; ++a) {
    const double reach = size * r.in(0.6, 1);
    const int n = l.n[a];
    for (int i = 0; i < n; ++i) {
      double f = double(i) / (n - 1);
      if (uneven && i > 0 && i + 1 < n) f += r.in(-0.35, 0.35) / (n - 1);
      l.x[a].push_back(reach * (2 * f - 1));
    }
  }
  const auto f = random_function(r, out.words);
  for (int k = 0; k < l.n[2]; ++k)
    for (int j = 0; j < l.n[1]; ++j)
      for (int i = 0; i < l.n[0]; ++i) l.v.push_back(f(Vec3{l.x[0][size_t(i)], l.x[1][size_t(j)], l.x[2][size_t(k)]} / size));
  const ElementType type = random_type(r, kinds, l.v, out.words);
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(l.v).converted(type), "", Role::scalars});
  out.edge = HUGE_VAL;
  if (uneven) {
    RectilinearGrid g;
    std::vector<double> at[3];
    for (size_t a = 0; a < 3; ++a)
      for (double x : l.x[a]) at[a].push_back(x + l.origin[int(a)]);
    g.x = Array::from_vector(at[0]), g.y = Array::from_vector(at[1]), g.z = Array::from_vector(at[2]);
    for (size_t a = 0; a < 3; ++a)
      for (size_t i = 1; i < at[a].size(); ++i) out.edge = std::min(out.edge, at[a][i] - at[a][i - 1]);
    out.item.data = make_dataset(g, fields);
  } else {
    UniformGrid g;
    g.direction = l.turn;
    Vec3 first;
    for (int a = 0; a < 3; ++a) {
      g.dims[size_t(a)] = size_t(l.n[size_t(a)]);
      g.spacing[a] = l.x[size_t(a)][1] - l.x[size_t(a)][0], first[a] = l.x[size_t(a)][0];
      out.edge = std::min(out.edge, g.spacing[a]);
    }
    g.origin = l.origin + l.turn * first;
    out.item.data = make_dataset(g, fields);
  }
  out.cell = out.edge;
  out.item.field = "f";
  out.box = out.item.data->bounds();
  const auto [lo, hi] = std::minmax_element(l.v.begin(), l.v.end());
  out.lo = *lo, out.hi = *hi;
  out.along = [lattice](const Vec3& o, const Vec3& d) {
    TrueVolume v;
    v.value = [lattice, o, d](double t) { return lattice->value(o + d * t); };
    v.gradient = [lattice, o, d](double t) { return lattice->gradient(o + d * t); };
    v.ends = lattice->ends(o, d);
    return v;
  };
  return out;
}

}  // namespace sg::test
