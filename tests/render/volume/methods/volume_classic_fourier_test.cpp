// SPDX-License-Identifier: Apache-2.0
// Fourier volume rendering: the transform, the slice theorem, and X-ray pictures against integrals along rays.
#include <complex>

#include "data/memory/memo.h"
#include "render/volume/methods/fft.h"
#include "render/volume/methods/spectrum.h"
#include "volume_classic_support.h"

using namespace sg;
using namespace sg::test;
using doctest::Approx;

namespace {

/// Black to white in many steps, so that a colour tells the value.
ColorScale ruler(double lo, double hi) {
  ColorScale s;
  for (int i = 0; i <= 4095; ++i) {
    const float c = srgb_encode(float(i) / 4095);
    s.map.colors.push_back({c, c, c});
  }
  s.lo = lo, s.hi = hi;
  return s;
}

VolumeItem xray(VolumeItem v, double most) {
  v.mode = RayFunction::sum, v.color = ruler(-0.1 * most, 1.1 * most), v.opacity.points = {{0, 1}};
  return v;
}

/// Values of the picture; NaN where nothing was drawn.
std::vector<double> values(const VolumeItem& v, const Projection& p, const Frame* opaque = nullptr) {
  const auto layer = draw_layer(
      v, p, [](const volume::LayerInput& in) { return volume::fourier(in); }, opaque);
  std::vector<double> out;
  for (size_t i = 0; i < layer.rgba.size(); i += 4)
    out.push_back(layer.rgba[i + 3] == 0 ? NAN : v.color.lo + (v.color.hi - v.color.lo) * double(layer.rgba[i]));
  return out;
}

/// Integral of the trilinear field along each pixel's ray, times weight(t of the depth range of the box).
std::vector<double> integrals(const VolumeItem& v, const Projection& p, const std::function<double(double)>& weight) {
  const volume::Volume vol = volume::prepare(v, 1, {});
  std::vector<double> out;
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      const auto ray = p.ray(x + 0.5, y + 0.5);
      const volume::Course c = volume::course(vol, ray.origin, ray.direction, 0, 1e9);
      const int n = 640;
      double sum = 0;
      for (int i = 0; c.leave > c.enter && i < n; i += volume::run_length) {
        volume::Run run;
        double t[volume::run_length];
        for (int m = 0; m < volume::run_length; ++m) {
          t[m] = c.enter + (c.leave - c.enter) * (i + m + 0.5) / n;
          run.ux[m] = vol.u(0, c.start.x + t[m] * c.along.x), run.uy[m] = vol.u(1, c.start.y + t[m] * c.along.y),
          run.uz[m] = vol.u(2, c.start.z + t[m] * c.along.z);
        }
        vol.kernels.sample(vol.voxels, run.ux, run.uy, run.uz, run.value);
        for (int m = 0; m < volume::run_length; ++m) sum += (double(run.value[m]) + double(vol.base)) * weight(t[m]);
      }
      out.push_back(c.leave > c.enter ? sum * (c.leave - c.enter) / n : NAN);
    }
  return out;
}

Distance relative(const std::vector<double>& a, const std::vector<double>& b) {
  Distance d;
  double most = 0;
  size_t n = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    if (!(a[i] == a[i]) || !(b[i] == b[i])) continue;
    const double e = std::abs(a[i] - b[i]);
    d.rms += e * e, d.most = std::max(d.most, e), most = std::max(most, std::abs(b[i])), ++n;
  }
  d.rms = std::sqrt(d.rms / double(n)) / most, d.most /= most;
  return d;
}

}  // namespace

TEST_CASE("fourier: the transform of any even size of factors 2, 3 and 5 is the sum it stands for, and back") {
  CHECK(volume::fft_size(1) == 2);
  CHECK(volume::fft_size(97) == 100);
  CHECK(volume::fft_size(511) == 512);
  CHECK_THROWS_AS(volume::Fft<double>(14), Error);
  for (const size_t n : {2, 4, 6, 10, 12, 30, 60, 64, 90, 120, 250}) {
    const volume::Fft<double> fft(n);
    std::vector<double> re(n), im(n), a(n), b(n);
    for (size_t i = 0; i < n; ++i) re[i] = random_unit(1, i) - 0.5, im[i] = random_unit(2, i) - 0.5;
    const auto re0 = re, im0 = im;
    fft.transform(re.data(), im.data(), a.data(), b.data());
    for (size_t k = 0; k < n; ++k) {
      std::complex<double> want = 0;
      for (size_t i = 0; i < n; ++i) want += std::complex(re0[i], im0[i]) * std::polar(1.0, -2 * M_PI * double(k * i % n) / double(n));
      REQUIRE(std::abs(std::complex(re[k], im[k]) - want) < 2e-14 * std::sqrt(double(n)));
    }
    fft.transform(im.data(), re.data(), a.data(), b.data());
    for (size_t i = 0; i < n; ++i)
      REQUIRE(std::abs(re[i] / double(n) - re0[i]) + std::abs(im[i] / double(n) - im0[i]) < 1e-15 * double(n) + 1e-14);
  }
}

TEST_CASE("fourier: the transform of a sum along z is the central slice of the volume's transform, to 1e-15") {
  const size_t n = 24;
  const volume::Fft<double> fft(n);
  std::vector<double> a(n), b(n), re(n * n * n), im(n * n * n), flat_re(n * n), flat_im(n * n);
  for (size_t i = 0; i < re.size(); ++i) re[i] = random_unit(7, i) - 0.5, flat_re[i % (n * n)] += re[i];
  double norm = 0;
  const auto along = [&](std::vector<double>& r, std::vector<double>& i, size_t stride) {
    std::vector<double> x(n), y(n);
    for (size_t first = 0; first < r.size(); ++first) {
      if (first / stride % n != 0) continue;
      for (size_t m = 0; m < n; ++m) x[m] = r[first + m * stride], y[m] = i[first + m * stride];
      fft.transform(x.data(), y.data(), a.data(), b.data());
      for (size_t m = 0; m < n; ++m) r[first + m * stride] = x[m], i[first + m * stride] = y[m];
    }
  };
  for (const size_t stride : {size_t(1), n, n * n}) along(re, im, stride);
  for (const size_t stride : {size_t(1), n}) along(flat_re, flat_im, stride);
  double most = 0;
  for (size_t i = 0; i < n * n; ++i) {
    norm = std::max(norm, std::hypot(flat_re[i], flat_im[i]));
    most = std::max(most, std::hypot(flat_re[i] - re[i], flat_im[i] - im[i]));
  }
  INFO("residual " << most / norm);
  CHECK(most / norm < 2e-15);
}

TEST_CASE("fourier: the spectrum between its points is the sum over the samples, and so are its slopes") {
  UniformGrid g;
  g.dims = {9, 12, 7};
  VolumeItem v = item(grid(g, [](Vec3 p) { return 2 + std::sin(p.x) + 0.3 * p.y * std::cos(p.z); }), grey(0, 1), constant_opacity(1));
  v.mode = RayFunction::sum;
  const Projection p = parallel_view(4, 4, 1);
  const Frame nothing(4, 4);
  Context context;
  const std::vector<Light> lights;
  const volume::Stage stage = volume::make_stage({v, p, nothing, lights, context}, {"fourier", {RayFunction::sum}});
  const volume::Spectrum spectrum(stage);
  double worst = 0, worst_slope = 0, all = 0;
  for (uint64_t trial = 0; trial < 60; ++trial) {
    const Vec3 k{random_unit(1, trial) - 0.5, random_unit(2, trial) * 3 - 1.5, random_unit(3, trial) - 0.5};
    std::complex<double> want = 0, slope_y = 0;
    double total = 0;
    for (size_t z = 0; z < 7; ++z)
      for (size_t y = 0; y < 12; ++y)
        for (size_t x = 0; x < 9; ++x) {
          const Vec3 n = Vec3(double(x), double(y), double(z)) - spectrum.centre();
          const double share = (x % 8 ? 1 : 0.5) * (y % 11 ? 1 : 0.5) * (z % 6 ? 1 : 0.5);
          const double f = share * (2 + std::sin(double(x)) + 0.3 * double(y) * std::cos(double(z)));
          const auto term = f * std::polar(1.0, -2 * M_PI * dot(k, n));
          want += term, slope_y += term * std::complex(0.0, -2 * M_PI * n.y), total += std::abs(f);
        }
    const auto got = spectrum.with_slopes(k);
    CHECK(got[0].re == spectrum.at(k).re);
    worst = std::max(worst, std::abs(std::complex<double>(double(got[0].re), double(got[0].im)) - want));
    worst_slope = std::max(worst_slope, std::abs(std::complex<double>(double(got[2].re), double(got[2].im)) - slope_y));
    all = total;
  }
  INFO("of the sum of all samples: " << worst / all << ", slopes " << worst_slope / all);
  CHECK(worst / all < 3e-4);
  CHECK(worst_slope / all < 0.05);  // of 2 pi times half the size
}

TEST_CASE("fourier: X-ray pictures are the integrals along rays to 1 % RMS, from any side, on rotated and anisotropic grids") {
  UniformGrid skew;
  skew.dims = {41, 33, 25}, skew.spacing = {0.05, 0.06, 0.08};
  const double c = std::cos(0.5), s = std::sin(0.5);
  skew.direction.m[0][0] = c, skew.direction.m[0][1] = -s, skew.direction.m[1][0] = s, skew.direction.m[1][1] = c;
  skew.origin = skew.direction * (skew.spacing * Vec3{-20, -16, -12});
  const auto bump = [](Vec3 p) { return std::exp(-6 * dot(p, p)) * (1 + 0.5 * std::sin(4 * p.x)); };
  const VolumeItem items[] = {xray(smooth_item(41), 3), xray(item(grid(skew, bump), grey(0, 1), constant_opacity(1)), 1)};
  for (const VolumeItem& v : items)
    for (const Vec3 forward : {Vec3{0, 0, -1}, Vec3{0.3, -0.5, -1}, Vec3{1, 0.1, 0.2}}) {
      const Projection p = parallel_view(32, 32, 12, forward, {0, 1, 0.1});
      const Distance d = relative(values(v, p), integrals(v, p, [](double) { return 1.0; }));
      INFO("rms " << d.rms << " most " << d.most);
      CHECK(d.rms < 3e-3);
      CHECK(d.most < 2e-2);
    }
}

TEST_CASE("fourier: a field that ends at the sides of the box still agrees to 1 % RMS") {
  const VolumeItem v = xray(item(grid(cube(41, -1, 1), [](Vec3 p) { return 1 + 0.3 * p.x; }), grey(0, 1), constant_opacity(1)), 3);
  for (const Vec3 forward : {Vec3{0, 0, -1}, Vec3{0.3, -0.5, -1}}) {
    const Projection p = parallel_view(32, 32, 10, forward, {0, 1, 0.1});
    const Distance d = relative(values(v, p), integrals(v, p, [](double) { return 1.0; }));
    INFO("rms " << d.rms << " most " << d.most);
    CHECK(d.rms < 1e-2);
  }
}

TEST_CASE("fourier: a Gaussian ball is its projection, and the average is the sum over the chord") {
  const double s = 0.3;
  VolumeItem v =
      xray(item(grid(cube(97, -1.8, 1.8), [&](Vec3 p) { return std::exp(-dot(p, p) / (2 * s * s)); }), grey(0, 1), constant_opacity(1)), 1);
  const Projection p = parallel_view(21, 21, 10);
  const auto sums = values(v, p);
  for (int x = 0; x < 21; ++x) {
    const double b = (x - 10) / 10.0, want = s * std::sqrt(2 * M_PI) * std::exp(-b * b / (2 * s * s));
    REQUIRE(std::abs(sums[size_t(21 * 10 + x)] - want) < 5e-3 * s * std::sqrt(2 * M_PI));
  }
  v.mode = RayFunction::average;
  const auto means = values(v, p);
  CHECK(std::abs(means[21 * 10 + 10] - sums[21 * 10 + 10] / 3.6) < 1e-3);
}

TEST_CASE("fourier: averages hold up to the outline") {
  // The mean is one over places a voxel around, at most.
  for (const bool even : {true, false}) {
    const DatasetPtr data = grid(cube(17, -1, 1), [&](Vec3 p) { return even ? 0.5 : 0.5 + 0.3 * p.x; });
    VolumeItem v = item(data, ruler(0, 1), constant_opacity(1));
    v.mode = RayFunction::average, v.opacity.points = {{0, 1}};
    for (const Vec3 forward : {Vec3(0, 0, -1), Vec3(0.5, -0.4, -1), Vec3(1, 0.2, 0.7)}) {
      const Projection p = parallel_view(40, 40, 14, forward);
      const auto means = values(v, p), sums = integrals(v, p, [](double) { return 1; });
      size_t seen = 0;
      for (int i = 0; i < p.width * p.height; ++i) {
        const auto ray = p.ray(i % p.width + 0.5, i / p.width + 0.5);
        const volume::Course c = volume::course(volume::prepare(v, 1, {}), ray.origin, ray.direction, 0, 1e9);
        CHECK((means[size_t(i)] == means[size_t(i)]) == (c.leave > c.enter));
        if (!(c.leave > c.enter)) continue;
        ++seen;
        CHECK(std::abs(means[size_t(i)] - sums[size_t(i)] / (c.leave - c.enter)) < (even ? 1e-3 : 0.3 * 0.125 * std::sqrt(3.0)));
      }
      CHECK(seen > 500);
    }
  }
}

TEST_CASE("fourier: the depth cue weighs the field by a straight line from 1 at the near end to 1 - cue at the far end") {
  VolumeItem v = xray(smooth_item(41), 3);
  v.light.depth_cue = 0.8;
  const Projection p = parallel_view(24, 24, 9, {0.3, -0.5, -1});
  double nearest = HUGE_VAL, farthest = -HUGE_VAL;
  for (int c = 0; c < 8; ++c) {
    const double z = p.to_eye({c & 1 ? 1.0 : -1.0, c & 2 ? 1.0 : -1.0, c & 4 ? 1.0 : -1.0}).z;
    nearest = std::min(nearest, z), farthest = std::max(farthest, z);
  }
  const Distance d = relative(values(v, p), integrals(v, p, [&](double t) { return 1 - 0.8 * (t - nearest) / (farthest - nearest); }));
  INFO("rms " << d.rms << " most " << d.most);
  CHECK(d.rms < 1e-2);
}

TEST_CASE("fourier: the spectrum is made once, the same bytes from one thread and from eight") {
  VolumeItem v = xray(smooth_item(33), 3);
  const Projection p = parallel_view(40, 40, 15, {0.3, -0.5, -1});
  set_thread_count(1);
  const auto one = draw_layer(v, p, [](const volume::LayerInput& in) { return volume::fourier(in); });
  const size_t kept = v.data->memo().bytes();
  CHECK(kept > 68 * 68 * 34 * 8 - 1);
  CHECK(draw_layer(v, p, [](const volume::LayerInput& in) { return volume::fourier(in); }).rgba == one.rgba);
  CHECK(v.data->memo().bytes() == kept);
  set_thread_count(8);
  v.data = smooth_item(33).data;
  const auto eight = draw_layer(v, p, [](const volume::LayerInput& in) { return volume::fourier(in); });
  set_thread_count(0);
  CHECK(std::memcmp(one.rgba.data(), eight.rgba.data(), one.rgba.size() * 4) == 0);
}

TEST_CASE("fourier: surfaces in the volume keep their pixels, and what has no line integral is refused in words") {
  VolumeItem v = xray(smooth_item(17), 3);
  const Projection p = parallel_view(1, 1, 15);
  Frame opaque(1, 1);
  opaque.depth[0] = 100;
  CHECK(values(v, p, &opaque)[0] != values(v, p, &opaque)[0]);
  opaque.depth[0] = 102;
  CHECK(values(v, p, &opaque)[0] > 0);
  const Method method = [](const volume::LayerInput& in) { return volume::fourier(in); };
  CHECK(refused(v, perspective_view(4, 4, 4, {0, 0, 6}, {0, 0, 0}), method, "parallel"));
  v.mode = RayFunction::composite;
  CHECK(refused(v, p, method, "sum, average"));
  v = xray(smooth_item(17), 3), v.clip.push_back({{1, 0, 0}, 0});
  CHECK(refused(v, p, method, "clipped"));
  v = xray(smooth_item(17), 3);
  const Frame nothing(1, 1);
  Context context;
  context.memory_limit = 1000;
  CHECK_THROWS_WITH_AS(volume::fourier({v, p, nothing, {}, context}), doctest::Contains("memory limit"), Error);
}
