// SPDX-License-Identifier: Apache-2.0
// The denoiser: nearer to the truth, edges of what is seen kept, nothing done where there is no noise.
#include "render/trace/denoise/denoise.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "denoise_scenes.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using doctest::Approx;

namespace {

/// A picture whose left half is grey and right half white, as two items in front of each other, with noise of a known variance.
struct Made {
  Frame frame{40, 30};
  Features features;
  Plane<float> variance;
};
Made halves(double deviation) {
  Made m;
  m.features.width = 40, m.features.height = 30;
  for (auto* planes : {&m.features.mean, &m.features.variance})
    for (auto& p : *planes) p.assign(m.frame.pixels(), 0);
  m.variance.assign(m.frame.pixels(), float(deviation * deviation));
  for (size_t i = 0; i < m.frame.pixels(); ++i) {
    const bool right = i % 40 >= 20;
    // Sums of twelve uniform numbers.
    double noise = -6;
    for (uint64_t k = 0; k < 12; ++k) noise += random_unit(7, 12 * i + k);
    for (size_t c = 0; c < 3; ++c) {
      m.frame.rgba[4 * i + c] = float((right ? 0.6 : 0.3) + deviation * noise);
      m.features.mean[Features::albedo + c][i] = right ? 0.8f : 0.4f;
    }
    m.frame.rgba[4 * i + 3] = 1, m.features.mean[Features::cover][i] = 1;
  }
  return m;
}

}  // namespace

TEST_CASE("denoise: pictures with 8 paths a pixel come nearer to the truth") {
  for (const NoisyScene& s : {glossy_room(64, 48), soft_shadow(64, 48), smoke(40, 30)}) {
    CAPTURE(s.name);
    LightOptions exact = s.options, few = s.options, denoised;
    exact.paths = 128, exact.seed = 99, few.paths = 8;
    denoised = few, denoised.denoise = true;
    const Frame truth = picture_of(s, exact);
    const double before = displayed_difference(picture_of(s, few), truth), after = displayed_difference(picture_of(s, denoised), truth);
    CHECK(after < 0.8 * before);
  }
}

TEST_CASE("denoise: even halves become even, and the edge between them stays where it is") {
  Made m = halves(0.05);
  Context context;
  denoise(m.features, m.variance, m.frame, context);
  double off = 0;
  for (size_t i = 0; i < m.frame.pixels(); ++i) {
    const double want = i % 40 >= 20 ? 0.6 : 0.3, found = double(m.frame.rgba[4 * i]);
    off += std::pow(found - want, 2) / double(m.frame.pixels());
    CHECK(std::abs(found - want) < 0.08);
    CHECK(m.frame.rgba[4 * i + 3] == Approx(1));
  }
  // A mean over n pixels has an n-th of the variance; of 225 neighbours at least 20 count.
  CHECK(std::sqrt(off) < 0.05 / std::sqrt(20.0));
}

TEST_CASE("denoise: where there is no noise no byte changes") {
  Made m = halves(0);
  for (size_t i = 0; i < m.frame.rgba.size(); ++i) m.frame.rgba[i] = float(random_unit(3, i));
  const Frame before = m.frame;
  Context context;
  denoise(m.features, m.variance, m.frame, context);
  CHECK(std::equal(before.rgba.begin(), before.rgba.end(), m.frame.rgba.begin()));

  // Of a picture: what lies around the ball.
  NoisyScene s = soft_shadow();
  s.scene.items.erase(s.scene.items.begin(), s.scene.items.begin() + 3);
  s.options.paths = 16;
  const Frame plain = picture_of(s, s.options);
  s.options.denoise = true;
  const Frame denoised = picture_of(s, s.options);
  for (size_t i = 0; i < plain.pixels(); ++i)
    if (plain.rgba[4 * i + 3] == 0) CHECK(denoised.rgba[4 * i + 3] == 0);
}

TEST_CASE("denoise: the same bytes for any number of threads, by all integrators") {
  NoisyScene s = glossy_room(50, 70);
  s.options.paths = 4, s.options.denoise = true;
  const int before = thread_count();
  for (const IntegratorKind kind :
       {IntegratorKind::path, IntegratorKind::whitted, IntegratorKind::ambient_occlusion, IntegratorKind::bdpt}) {
    CAPTURE(kind);
    s.options.integrator = kind;
    std::vector<Frame> frames;
    for (int threads = 1; threads <= 3; ++threads) {
      set_thread_count(threads);
      frames.push_back(picture_of(s, s.options));
    }
    CHECK(std::equal(frames[0].rgba.begin(), frames[0].rgba.end(), frames[1].rgba.begin()));
    CHECK(std::equal(frames[0].rgba.begin(), frames[0].rgba.end(), frames[2].rgba.begin()));
  }
  set_thread_count(before);
}

TEST_CASE("features: what is seen first, as cover, colour, direction and distance") {
  LightScene l;
  add_floor(l, 0.5);
  const NoisyScene s = finished(
      "floor", l.scene,
      [] {
        Camera c = look({0, 0, 2.1}, {0, 0, -0.9}, 20);
        c.up = {0, 1, 0};
        return c;
      }(),
      9, 9);
  LightOptions options = s.options;
  options.paths = 4, options.features = true;
  TraceReport report;
  picture_of(s, options, report);
  const size_t middle = 40;
  for (size_t c = 0; c < 3; ++c) CHECK(report.planes.albedo[3 * middle + c] == Approx(0.5).epsilon(0.01));
  CHECK(report.planes.normal[3 * middle + 2] == Approx(1));
  CHECK(std::abs(report.planes.normal[3 * middle]) < 1e-6);
}
