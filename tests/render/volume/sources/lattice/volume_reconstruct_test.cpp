// SPDX-License-Identifier: Apache-2.0
// Reconstruction kernels and gradients on rays: V10-V12, against sums over the kernels, and at holes and borders.
#include <cstdio>
#include <tuple>

#include "base/schema/schema.h"
#include "color/cie.h"
#include "filter/field/sampling/reconstruction.h"
#include "render/volume/rays/functions.h"
#include "render/volume/sources/lattice/lattice_ray.h"
#include "render/volume/sources/lattice/reconstructed_ray.h"
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;
using volume::RaySource;
using volume::Stretch;

namespace {

constexpr Kernel kernels[] = {Kernel::nearest, Kernel::linear,         Kernel::catmull_rom, Kernel::mitchell,
                              Kernel::bspline, Kernel::bspline_smooth, Kernel::gaussian,    Kernel::sinc};

VolumeSampling sampling(Kernel k, GradientKind gradient = GradientKind::central) {
  VolumeSampling s;
  s.kernel = k, s.gradient = gradient, s.tolerance = 1.0 / 4096;
  return s;
}
std::unique_ptr<RaySource> source(const DatasetPtr& data, const VolumeSampling& s, Association association = Association::point) {
  VolumeItem v = item(data, grey(0, 1), constant_opacity(1));
  v.association = association;
  return volume::reconstructed_source(std::make_shared<const volume::Volume>(volume::prepare(v, 1, {})), s);
}
std::vector<Stretch> stretches(volume::RayField& walker, Vec3 origin, Vec3 direction) {
  walker.start(origin, direction, 0, 1e9);
  std::vector<Stretch> all;
  Stretch some[7];
  while (const size_t n = walker.next(some)) all.insert(all.end(), some, some + n);
  return all;
}
/// Value at t; NaN where there is none.
double value_at(const std::vector<Stretch>& all, double t) {
  auto it = std::partition_point(all.begin(), all.end(), [&](const Stretch& s) { return s.to < t; });
  return it != all.end() && it->from <= t ? double(it->value(t)) : NAN;
}
/// Value at a place, by a ray through it.
double value_of(const RaySource& s, Vec3 p, Vec3 direction = {0.3, 0.5, 0.81}) {
  const Vec3 d = normalize(direction);
  return value_at(stretches(*s.walker(), p - d * 50.0, d), 50);
}
Vec3f gradient_of(const RaySource& s, Vec3 p) {
  auto walker = s.walker();
  const Vec3 d = normalize(Vec3{0.3, 0.5, 0.81});
  walker->start(p - d * 50.0, d, 0, 1e9);
  return walker->gradient({50, 50.1, {}, 0}, 50);
}

constexpr double ml_frequency = 6, ml_alpha = 0.25;
double marschner_lobb(Vec3 p) {
  const double r = std::hypot(p.x, p.y), rho = std::cos(2 * M_PI * ml_frequency * std::cos(M_PI * r / 2));
  return (1 - std::sin(M_PI * p.z / 2) + ml_alpha * (1 + rho)) / (2 * (1 + ml_alpha));
}
Vec3 marschner_lobb_gradient(Vec3 p) {
  const double r = std::hypot(p.x, p.y), c = 2 * M_PI * ml_frequency;
  const double by_r = ml_alpha * std::sin(c * std::cos(M_PI * r / 2)) * c * std::sin(M_PI * r / 2) * (M_PI / 2) / (2 * (1 + ml_alpha));
  return {by_r * p.x / r, by_r * p.y / r, -std::cos(M_PI * p.z / 2) * (M_PI / 2) / (2 * (1 + ml_alpha))};
}

struct Errors {
  double rms = 0, most = 0;
};
/// Over |x| < 0.9 of the signal on n^3 samples, along rays parallel to z; a quarter of them, the others are their mirror images.
Errors errors(const RaySource& s, int across = 120, int along = 60) {
  auto walker = s.walker();
  Errors e;
  size_t count = 0;
  for (int j = 0; j < across; ++j)
    for (int i = 0; i < across; ++i) {
      const double x = 0.9 * (i + 0.5) / across, y = 0.9 * (j + 0.5) / across;
      const auto all = stretches(*walker, {x, y, -2}, {0, 0, 1});
      for (int k = 0; k < along; ++k) {
        const double z = 0.9 * (2 * (k + 0.5) / along - 1), d = value_at(all, z + 2) - marschner_lobb({x, y, z});
        e.rms += d * d, e.most = std::max(e.most, std::abs(d)), ++count;
      }
    }
  e.rms = std::sqrt(e.rms / double(count));
  return e;
}

/// Values of the tensor product by its definition, in index space; beyond the border 2 s[0] - s[-i].
struct Reference {
  std::array<size_t, 3> n;
  std::vector<double> s;  // samples or coefficients
  Kernel kernel;
  double get(long i, long j, long k) const {
    const long at[3] = {i, j, k};
    for (int a = 0; a < 3; ++a) {
      long other[2][3] = {{i, j, k}, {i, j, k}};
      const long last = long(n[size_t(a)]) - 1;
      if (at[a] >= 0 && at[a] <= last) continue;
      other[0][a] = at[a] < 0 ? 0 : last, other[1][a] = at[a] < 0 ? -at[a] : 2 * last - at[a];
      return 2 * get(other[0][0], other[0][1], other[0][2]) - get(other[1][0], other[1][1], other[1][2]);
    }
    return s[size_t(i) + n[0] * (size_t(j) + n[1] * size_t(k))];
  }
  double at(Vec3 u) const {
    long c[3];
    double sum = 0, weights = 0, share[3][6];
    for (int a = 0; a < 3; ++a) {
      c[a] = std::clamp(long(std::floor(u[a])), 0L, long(n[size_t(a)]) - 2);
      for (int m = 0; m < 6; ++m) share[a][m] = kernel_value(kernel, u[a] - double(c[a] - 2 + m));
    }
    for (int k = 0; k < 6; ++k)
      for (int j = 0; j < 6; ++j)
        for (int i = 0; i < 6; ++i)
          if (const double w = share[0][i] * share[1][j] * share[2][k]; w != 0)
            sum += w * get(c[0] - 2 + i, c[1] - 2 + j, c[2] - 2 + k), weights += w;
    return sum / weights;
  }
};
/// Natural splines axis by axis, by elimination.
void solve_spline(std::vector<double>& s, std::array<size_t, 3> n) {
  size_t stride = 1;
  for (size_t a = 0; a < 3; stride *= n[a], ++a)
    for (size_t first = 0; first < s.size(); ++first) {
      if (first / stride % n[a] != 0) continue;
      const size_t m = n[a];
      std::vector<double> upper(m, 0.0), c(m);
      for (size_t i = 0; i < m; ++i) c[i] = s[first + i * stride];
      for (size_t i = 1; i + 1 < m; ++i) {
        const double pivot = 4 - upper[i - 1];
        upper[i] = 1 / pivot, c[i] = (6 * c[i] - c[i - 1]) / pivot;
      }
      for (size_t i = m - 1; i-- > 1;) c[i] -= upper[i] * c[i + 1];
      for (size_t i = 0; i < m; ++i) s[first + i * stride] = c[i];
    }
}

DatasetPtr noise(std::array<size_t, 3> dims, ElementType type = ElementType::f32, uint64_t seed = 3) {
  UniformGrid g;
  g.dims = dims;
  uint64_t i = 0;
  return grid(
      g, [&](Vec3) { return type == ElementType::f32 ? random_unit(seed, i++) : std::floor(200 * random_unit(seed, i++)); }, type);
}
Reference reference(const DatasetPtr& data, std::array<size_t, 3> dims, Kernel k) {
  Reference r{dims, {}, k};
  const Array& a = data->fields().require("f").array;
  for (size_t i = 0; i < a.count(); ++i) r.s.push_back(a.get(i));
  if (traits(k).prefilter) solve_spline(r.s, dims);
  return r;
}

}  // namespace

TEST_CASE("reconstruction: shares sum to 1 and their derivatives to 0 and are their slopes (V11)") {
  for (Kernel k : kernels) {
    INFO(word_of(k));
    for (int i = 0; i <= 100; ++i) {
      const double f = i / 100.0, h = 1e-6, g = std::clamp(f, h, 1 - h);
      double w[most_taps], d[most_taps], lo[most_taps], hi[most_taps], sum = 0, change = 0;
      kernel_weights(k, f, w), kernel_slopes(k, f, d);
      for (int j = 0; j < 2 * traits(k).radius; ++j) sum += w[j], change += d[j];
      CHECK(sum == doctest::Approx(1).epsilon(1e-12));
      CHECK(std::abs(change) < 1e-12);
      if (k == Kernel::nearest) continue;
      kernel_weights(k, g - h, lo), kernel_weights(k, g + h, hi), kernel_slopes(k, g, d);
      for (int j = 0; j < 2 * traits(k).radius; ++j) CHECK(d[j] == doctest::Approx((hi[j] - lo[j]) / (2 * h)).epsilon(1e-4).scale(1));
    }
  }
}

TEST_CASE("reconstruction: BC splines keep straight lines just when B + 2C = 1, and make t^2 + B/3 of t^2 (V11)") {
  for (int b = 0; b <= 6; ++b)
    for (int c = 0; c <= 6; ++c) {
      const double B = b / 6.0, C = c / 6.0;
      double line = 0, parabola = 0;
      for (int i = 1; i < 100; ++i) {
        const double t = i / 100.0;
        double sum = 0, one = 0, two = 0;
        for (int j = -1; j <= 2; ++j) {
          const double w = bc_spline(B, C, t - j);
          sum += w, one += w * j, two += w * j * j;
        }
        CHECK(sum == doctest::Approx(1).epsilon(1e-12));
        line = std::max(line, std::abs(one - t)), parabola = std::max(parabola, std::abs(two - (t * t + B / 3)));
      }
      if (b + 2 * c == 6) CHECK(line < 1e-14);
      else CHECK(line > 1e-3);
      if (b + 2 * c == 6) CHECK(parabola < 1e-14);
    }
}

TEST_CASE("reconstruction: traits tell which kernels interpolate and which keep straight lines") {
  for (Kernel k : kernels) {
    INFO(word_of(k));
    const int taps = 2 * traits(k).radius, zero = traits(k).radius - 1;
    double w[most_taps];
    kernel_weights(k, 0, w);
    if (!traits(k).prefilter) CHECK((std::abs(w[zero] - 1) < 1e-12) == traits(k).interpolates);
    kernel_weights(k, 0.3, w);
    double first = 0;
    for (int j = 0; j < taps; ++j) first += w[j] * (j - zero);
    CHECK((std::abs(first - 0.3) < 1e-12) == traits(k).linear);
  }
}

TEST_CASE("reconstruction: the recursive filter gives the coefficients of the natural spline, on lines of any length") {
  for (std::array<size_t, 3> n : {std::array<size_t, 3>{40, 3, 5}, {2, 9, 1}, {1, 1, 70}, {33, 34, 4}}) {
    std::vector<float> c(n[0] * n[1] * n[2]);
    for (size_t i = 0; i < c.size(); ++i) c[i] = float(random_unit(1, i));
    std::vector<double> truth(c.begin(), c.end());
    solve_spline(truth, n);
    bspline_coefficients(c.data(), n);
    double off = 0;
    for (size_t i = 0; i < c.size(); ++i) off = std::max(off, std::abs(double(c[i]) - truth[i]));
    CHECK(off < 2e-5);
  }
}

TEST_CASE("reconstruction: errors on the signal of Marschner and Lobb are those of the literature (V10)") {
  const DatasetPtr data = grid(cube(40, -1, 1), marschner_lobb);
  const std::pair<Kernel, Errors> expected[] = {{Kernel::nearest, {0.0500, 0.180}},
                                                {Kernel::linear, {0.0353, 0.0893}},
                                                {Kernel::catmull_rom, {0.0263, 0.0834}},
                                                {Kernel::mitchell, {0.0324, 0.0863}},
                                                {Kernel::bspline_smooth, {0.0478, 0.0916}}};
  for (const auto& [k, truth] : expected) {
    INFO(word_of(k));
    const Errors e = errors(*source(data, sampling(k)));
    CHECK(std::abs(e.rms / truth.rms - 1) < 0.03);
    CHECK(std::abs(e.most / truth.most - 1) < 0.03);
  }
}

TEST_CASE("reconstruction: prints the table of errors of docs/reconstruction.md" * doctest::skip()) {
  const DatasetPtr data = grid(cube(40, -1, 1), marschner_lobb);
  std::printf("| kernel | RMS | largest |\n|---|---|---|\n");
  for (Kernel k : kernels) {
    const Errors e = errors(*source(data, sampling(k)), 120, 120);
    std::printf("| %s | %.4f | %.4f |\n", std::string(word_of(k)).c_str(), e.rms, e.most);
  }
}

TEST_CASE("reconstruction: every kernel's field along slanted rays is the sum over its support") {
  const std::array<size_t, 3> dims{9, 7, 8};
  for (ElementType type : {ElementType::f32, ElementType::u8}) {
    const DatasetPtr data = noise(dims, type);
    const double range = type == ElementType::u8 ? 200 : 1;
    for (Kernel k : kernels) {
      INFO(word_of(k));
      const auto s = source(data, sampling(k));
      const Reference truth = reference(data, dims, k);
      const Vec3 d = normalize(Vec3{0.9, 0.61, 0.73});
      const auto all = stretches(*s->walker(), Vec3{0.11, 0.23, -0.4} - d * 3.0, d);
      REQUIRE(all.size() > 10);
      double worst = 0, from = all.front().from, to = all.back().to;
      for (int i = 1; i < 1000; ++i) {
        const double t = from + (to - from) * (i + 0.37) / 1001, v = value_at(all, t);
        REQUIRE(v == v);
        worst = std::max(worst, std::abs(v - truth.at(Vec3{0.11, 0.23, -0.4} + d * (t - 3))));
      }
      CHECK(worst < range * (1.0 / 4096 / 128 + 4e-6));
    }
  }
}

TEST_CASE("reconstruction: the integral along a ray is that of the field") {
  const std::array<size_t, 3> dims{12, 12, 12};
  const DatasetPtr data = noise(dims);
  for (Kernel k : kernels) {
    INFO(word_of(k));
    const auto s = source(data, sampling(k));
    const Reference truth = reference(data, dims, k);
    auto walker = s->walker();
    const Vec3 d = normalize(Vec3{0.7, 0.5, 0.6}), o{-0.2, 0.4, 0.1};
    walker->start(o, d, 0, 100);
    const volume::Sum sum = integral(*walker);
    const int n = 10000;
    double brute = 0;
    for (int i = 0; i < n; ++i) brute += truth.at(o + d * (sum.first + sum.length * (i + 0.5) / n)) * sum.length / n;
    CHECK(sum.integral == doctest::Approx(brute).epsilon(k == Kernel::nearest ? 1e-3 : 1e-5));
  }
}

TEST_CASE("reconstruction: interpolating kernels pass through the samples") {
  const std::array<size_t, 3> dims{6, 5, 7};
  const DatasetPtr data = noise(dims);
  const Array& a = data->fields().require("f").array;
  for (Kernel k : kernels) {
    INFO(word_of(k));
    const auto s = source(data, sampling(k));
    double worst = 0;
    for (size_t i = 0; i < a.count(); ++i) {
      const Vec3 p{double(i % 6), double(i / 6 % 5), double(i / 30)};
      const Vec3 inward = Vec3{2.5, 2.0, 3.0} - p;  // from outside through the sample
      auto walker = s->walker();
      const Vec3 d = normalize(inward);
      const auto all = stretches(*walker, p - d * 2.0, d);
      worst = std::max(worst, std::abs(value_at(all, 2 + 1e-9) - a.get(i)));
    }
    if (traits(k).interpolates) CHECK(worst < 1e-5);
    else CHECK(worst > 0.02);
  }
}

TEST_CASE("reconstruction: linear and central is the plain source") {
  const DatasetPtr data = noise({8, 8, 8});
  VolumeItem v = item(data, grey(0, 1), constant_opacity(1));
  const auto plain = volume::lattice_source(std::make_shared<const volume::Volume>(volume::prepare(v, 1, {})));
  const auto other = source(data, sampling(Kernel::linear));
  for (int i = 0; i < 50; ++i) {
    const Vec3 p{0.5 + 6 * random_unit(1, uint64_t(i)), 0.5 + 6 * random_unit(2, uint64_t(i)), 0.5 + 6 * random_unit(4, uint64_t(i))};
    CHECK(value_of(*other, p) == doctest::Approx(value_of(*plain, p)).epsilon(1e-5));
    if (std::min({p.x, p.y, p.z}) < 1 || std::max({p.x, p.y, p.z}) > 6) continue;
    CHECK(length(Vec3(gradient_of(*other, p)) - Vec3(gradient_of(*plain, p))) < 1e-4);
  }
}

TEST_CASE("reconstruction: gradients of even slopes are exact, on turned and on uneven grids, up to the border") {
  UniformGrid turned = cube(7, -1, 1);
  turned.direction.m[0][0] = std::cos(0.4), turned.direction.m[0][1] = -std::sin(0.4);
  turned.direction.m[1][0] = std::sin(0.4), turned.direction.m[1][1] = std::cos(0.4);
  turned.spacing = {0.3, 0.2, 0.5};
  const Vec3 slope{1.5, -2, 0.75};
  const auto f = [&](Vec3 p) { return dot(slope, p); };
  const DatasetPtr even = grid(turned, f);
  RectilinearGrid r;
  std::vector<double> axis{-1, -0.7, -0.55, 0, 0.1, 0.6, 1}, values;
  r.x = r.y = r.z = Array::from_vector(axis);
  for (double z : axis)
    for (double y : axis)
      for (double x : axis) values.push_back(f({x, y, z}));
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(values).converted(ElementType::f32), "", Role::scalars});
  const DatasetPtr uneven = make_dataset(r, fields);
  for (Kernel k : kernels)
    for (GradientKind gradient : {GradientKind::central, GradientKind::sobel, GradientKind::intermediate, GradientKind::analytic}) {
      if (k == Kernel::nearest && gradient != GradientKind::central && gradient != GradientKind::sobel) continue;  // steps have no slope
      if (!traits(k).linear && gradient == GradientKind::analytic) continue;  // nor do these have an even one
      INFO(word_of(k), ", ", word_of(gradient));
      const auto a = source(even, sampling(k, gradient)), b = source(uneven, sampling(k, gradient));
      for (int i = 0; i < 20; ++i) {
        const Vec3 u{random_unit(1, uint64_t(i)), random_unit(2, uint64_t(i)), random_unit(3, uint64_t(i))};
        const Vec3 p = turned.origin + turned.direction * (turned.spacing * (u * 6.0));
        if (traits(k).linear || k == Kernel::nearest) CHECK(length(Vec3(gradient_of(*a, p)) - slope) < 2e-4);
        if (gradient != GradientKind::analytic || k == Kernel::linear)
          CHECK(length(Vec3(gradient_of(*b, u * 2.0 - Vec3{1, 1, 1})) - slope) < 2e-4);
      }
    }
}

TEST_CASE("reconstruction: gradients converge with order 2, by every estimator (V12)") {
  // The signal at a third of its frequency: the asymptote begins at grids of this size.
  const double c = 2 * M_PI * 2;
  const auto f = [&](Vec3 p) {
    const double rho = std::cos(c * std::cos(M_PI * std::hypot(p.x, p.y) / 2));
    return (1 - std::sin(M_PI * p.z / 2) + ml_alpha * (1 + rho)) / (2 * (1 + ml_alpha));
  };
  const auto slope = [&](Vec3 p) {
    const double r = std::hypot(p.x, p.y);
    const double by_r = ml_alpha * std::sin(c * std::cos(M_PI * r / 2)) * c * std::sin(M_PI * r / 2) * (M_PI / 2) / (2 * (1 + ml_alpha));
    return Vec3{by_r * p.x / r, by_r * p.y / r, -std::cos(M_PI * p.z / 2) * (M_PI / 2) / (2 * (1 + ml_alpha))};
  };
  const auto rms = [&](size_t n, Kernel k, GradientKind gradient) {
    const auto s = source(grid(cube(n, -1, 1), f), sampling(k, gradient));
    double sum = 0;
    const int points = 600;
    for (int i = 0; i < points; ++i) {
      const auto unit = [&](uint64_t a) { return 0.8 * (2 * random_unit(a, uint64_t(i)) - 1); };
      const Vec3 p{unit(1), unit(2), unit(3)};
      const Vec3 d = Vec3(gradient_of(*s, p)) - slope(p);
      sum += dot(d, d);
    }
    return std::sqrt(sum / points);
  };
  const std::tuple<Kernel, GradientKind, double> ways[] = {{Kernel::linear, GradientKind::central, 2},
                                                           {Kernel::catmull_rom, GradientKind::central, 2},
                                                           {Kernel::linear, GradientKind::sobel, 2},
                                                           {Kernel::linear, GradientKind::intermediate, 2},
                                                           {Kernel::mitchell, GradientKind::intermediate, 2},
                                                           {Kernel::catmull_rom, GradientKind::analytic, 2},
                                                           {Kernel::bspline_smooth, GradientKind::analytic, 2},
                                                           {Kernel::bspline, GradientKind::analytic, 3},
                                                           {Kernel::linear, GradientKind::analytic, 1}};
  for (const auto& [k, gradient, order] : ways) {
    INFO(word_of(k), ", ", word_of(gradient));
    const double p = std::log2(rms(49, k, gradient) / rms(97, k, gradient));
    CHECK(std::abs(p - order) < 0.2);
  }
  // At full frequency and 40^3 the estimators differ as they should: the spline's own derivative is the best, Sobel smooths most.
  const DatasetPtr data = grid(cube(40, -1, 1), marschner_lobb);
  const auto error = [&](Kernel k, GradientKind gradient) {
    const auto s = source(data, sampling(k, gradient));
    double sum = 0;
    for (int i = 0; i < 500; ++i) {
      const auto unit = [&](uint64_t a) { return 0.8 * (2 * random_unit(a, uint64_t(i)) - 1); };
      const Vec3 p{unit(1), unit(2), unit(3)}, d = Vec3(gradient_of(*s, p)) - marschner_lobb_gradient(p);
      sum += dot(d, d);
    }
    return std::sqrt(sum / 500);
  };
  CHECK(error(Kernel::bspline, GradientKind::analytic) < error(Kernel::linear, GradientKind::intermediate));
  CHECK(error(Kernel::linear, GradientKind::intermediate) < error(Kernel::linear, GradientKind::central));
  CHECK(error(Kernel::linear, GradientKind::central) < error(Kernel::linear, GradientKind::sobel));
}

TEST_CASE("reconstruction: a cell draws where its corners have values, and beside holes what rises evenly goes on") {
  // A hole in the middle, and one cell hidden.
  UniformGrid g;
  g.dims = {9, 9, 9};
  const auto plane = [](Vec3 p) { return 3 + p.x - 0.5 * p.y + 0.25 * p.z; };
  const auto holed = [&](Vec3 p) { return p == Vec3{4, 4, 4} ? NAN : plane(p); };
  const DatasetPtr points = grid(g, holed);
  uint8_t* ghost = nullptr;
  DatasetParts parts = points->parts();
  parts.cell_ghost = Array::make<uint8_t>(512, 1, &ghost);
  std::fill(ghost, ghost + 512, uint8_t(0));
  ghost[1 + 8 * (1 + 8 * 1)] = ghost_hidden_cell;
  const DatasetPtr data = make_dataset(std::move(parts));
  for (Kernel k : kernels) {
    INFO(word_of(k));
    const auto s = source(data, sampling(k));
    int drawn = 0, wrong = 0;
    double off = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 p{8 * random_unit(1, uint64_t(i)), 8 * random_unit(2, uint64_t(i)), 8 * random_unit(3, uint64_t(i))};
      const double v = value_of(*s, p);
      const auto within = [&](double lo, double hi) { return std::min({p.x, p.y, p.z}) > lo && std::max({p.x, p.y, p.z}) < hi; };
      const bool hole = (k == Kernel::nearest ? within(3.5, 4.5) : within(3, 5)) || within(1, 2);
      wrong += (v == v) == hole, drawn += v == v;
      if (v == v) off = std::max(off, std::abs(v - plane(p)));
    }
    CHECK(wrong == 0);
    CHECK(drawn > 2000);
    if (traits(k).linear) CHECK(off < 1e-4);
  }
}

TEST_CASE("reconstruction: a cell without a value takes nothing of its neighbours' voxels") {
  UniformGrid g;
  g.dims = {6, 6, 6};
  std::vector<float> v(125, 2.0f);
  v[2 + 5 * (2 + 5 * 2)] = NAN;
  FieldSet fields;
  fields.add({"f", Association::cell, Array::from_vector(v), "", Role::scalars});
  const DatasetPtr data = make_dataset(g, fields);
  for (Kernel k : kernels) {
    INFO(word_of(k));
    const auto s = source(data, sampling(k), Association::cell);
    const auto all = stretches(*s->walker(), {2.4, 2.6, -3}, {0, 0, 1});
    double length = 0, off = 0;
    for (const Stretch& part : all) {
      length += part.to - part.from;
      for (float b : part.b) off = std::max(off, double(std::abs(b - 2)));
    }
    CHECK(length == doctest::Approx(4).epsilon(1e-9));  // the box but the voxel, its outer half cells included
    CHECK(off < 1e-4);
    CHECK(value_at(all, 5.5) != value_at(all, 5.5));
  }
}

TEST_CASE("reconstruction: grids one sample thick, of two samples and without any value") {
  for (std::array<size_t, 3> dims : {std::array<size_t, 3>{9, 1, 9}, {1, 1, 1}, {2, 2, 2}, {1, 7, 2}}) {
    const DatasetPtr data = noise(dims);
    std::array<size_t, 3> doubled = dims;
    for (size_t& n : doubled) n = std::max<size_t>(n, 2);
    for (Kernel k : kernels) {
      INFO(word_of(k));
      const auto s = source(data, sampling(k));
      // Along the thin axis the field is constant: that of the sheet.
      const Vec3 p{dims[0] > 1 ? 0.37 * double(dims[0] - 1) : 0.2, dims[1] > 1 ? 0.61 * double(dims[1] - 1) : -0.3,
                   dims[2] > 1 ? 0.45 * double(dims[2] - 1) : 0.1};
      Reference r{doubled, {}, k};
      const Array& a = data->fields().require("f").array;
      for (size_t c = 0; c < doubled[2]; ++c)
        for (size_t b = 0; b < doubled[1]; ++b)
          for (size_t i = 0; i < doubled[0]; ++i)
            r.s.push_back(a.get(std::min(i, dims[0] - 1) + dims[0] * (std::min(b, dims[1] - 1) + dims[1] * std::min(c, dims[2] - 1))));
      if (traits(k).prefilter) solve_spline(r.s, doubled);
      CHECK(value_of(*s, p) == doctest::Approx(r.at(p)).epsilon(1e-4));
    }
  }
  const DatasetPtr nothing = grid(cube(5, -1, 1), [](Vec3) { return NAN; });
  for (Kernel k : kernels) CHECK(stretches(*source(nothing, sampling(k))->walker(), {0.1, 0.2, -4}, {0, 0, 1}).empty());
}

TEST_CASE("reconstruction: pictures do not depend on passing over empty bricks, threads or how often they are drawn") {
  const DatasetPtr data = grid(cube(30, -1, 1), [](Vec3 p) { return std::exp(-8 * dot(p, p)) * (1 + 0.5 * std::sin(20 * p.x)); });
  for (Kernel k : {Kernel::nearest, Kernel::catmull_rom, Kernel::bspline, Kernel::sinc})
    for (RayFunction mode : {RayFunction::composite, RayFunction::isosurface}) {
      VolumeItem v = item(data, grey(0, 1.5), OpacityCurve{});
      v.opacity.points = {{0.5, 0}, {0.6, 0.5}, {0.7, 0}, {2, 0.9}};
      v.sampling.kernel = k, v.sampling.gradient = GradientKind::analytic, v.mode = mode, v.levels = {0.62}, v.shaded = true;
      v.unit_distance = 0.1;
      const Scene scene = scene_of({v});
      const Projection view = perspective_view(16, 16, 19, {1.9, 1.4, 2.6}, {0, 0, 0});
      volume::Knobs all;
      all.skip_empty = false;
      set_thread_count(1);
      const Frame one = draw(scene, view), every = draw(scene, view, all);
      set_thread_count(8);
      const Frame eight = draw(scene, view);
      set_thread_count(0);
      CHECK(same_bytes(one, eight));
      CHECK(largest_difference(one, every) < 1e-6);
      float most = 0;
      for (size_t i = 3; i < one.rgba.size(); i += 4) most = std::max(most, one.rgba[i]);
      CHECK(most > 0.1f);
    }
}

TEST_CASE("reconstruction: the picture lies within the tolerance of brute force") {
  const std::array<size_t, 3> dims{10, 10, 10};
  const DatasetPtr data = noise(dims);
  for (Kernel k : kernels) {
    INFO(word_of(k));
    VolumeItem v = item(data, grey(-0.5, 1.5), OpacityCurve{});
    // Knots beyond the data, where lobes reach.
    v.opacity.points = {{-0.3, 0.7}, {-0.1, 0}, {0.4, 0}, {0.6, 0.3}, {1.02, 0}, {1.1, 0.9}};
    v.sampling.kernel = k;
    const Reference truth = reference(data, dims, k);
    for (int ray = 0; ray < 4; ++ray) {
      const double x = 1.27 + 1.1 * ray, y = 7.83 - 0.9 * ray;
      const Frame f = look(scene_of({v}), x, y);
      double light = 0, pass = 1;
      const int n = 12000;
      for (int i = 0; i < n && pass > 1e-7; ++i) {
        const double value = truth.at({x, y, 9 - 9 * (i + 0.5) / n});
        const double alpha = 1 - std::pow(1 - v.opacity.at(value), 9.0 / n);
        light += pass * alpha * srgb_to_linear(double(v.color.color(value).x)), pass *= 1 - alpha;
      }
      CHECK(std::abs(double(f.rgba[3]) - (1 - pass)) < 1.0 / 512);
      CHECK(std::abs(double(f.rgba[0]) - light) < 1.0 / 512);
    }
  }
}

TEST_CASE("reconstruction: unknown names and meshes without samples in rows are refused") {
  const DatasetPtr data = noise({4, 4, 4});
  VolumeItem v = item(data, grey(0, 1), constant_opacity(1));
  VolumeSampling sampling;
  Schema schema;
  describe(schema, sampling);
  CHECK_THROWS_WITH_AS(set_param(schema, "kernel", "cubic", "volume"), doctest::Contains("kernel"), Error);
  CHECK_THROWS_WITH_AS(set_param(schema, "gradient", "sobell", "volume"), doctest::Contains("sobel"), Error);
  CurvilinearGrid g;
  g.dims = {2, 2, 2};
  std::vector<float> xyz;
  for (int i = 0; i < 8; ++i) xyz.insert(xyz.end(), {float(i & 1), float(i >> 1 & 1), float(i >> 2)});
  g.points.xyz = Array::from_vector(xyz, 3);
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::vector<float>(8, 1.0f)), "", Role::scalars});
  VolumeItem bent = item(make_dataset(g, fields), grey(0, 1), constant_opacity(1));
  bent.sampling.kernel = Kernel::bspline;
  CHECK_THROWS_WITH_AS(look(scene_of({bent})), doctest::Contains("resample"), Error);
}
