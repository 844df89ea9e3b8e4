// SPDX-License-Identifier: Apache-2.0
// What pictures by paths say of themselves: the error of each pixel, pictures on the way, where time ended them.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "../denoise/denoise_scenes.h"
#include "base/error.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using doctest::Approx;

namespace {

constexpr IntegratorKind all[] = {IntegratorKind::path,  IntegratorKind::whitted, IntegratorKind::ambient_occlusion,
                                  IntegratorKind::light, IntegratorKind::bdpt,    IntegratorKind::metropolis};

double root_mean_square(const Plane<float>& p) {
  double sum = 0;
  for (const float v : p) sum += double(v) * double(v) / double(p.size());
  return std::sqrt(sum);
}

bool same_light(const Frame& a, const Frame& b) { return std::equal(a.rgba.begin(), a.rgba.end(), b.rgba.begin(), b.rgba.end()); }

}  // namespace

TEST_CASE("noise: the error of each pixel is the spread of pictures with other seeds, and all of them make the told noise") {
  NoisyScene s = glossy_room(24, 18);
  s.options.paths = 32, s.options.sampler = SamplerKind::independent;
  for (const IntegratorKind kind : all) {
    CAPTURE(kind);
    s.options.integrator = kind;
    constexpr int seeds = 16;
    std::vector<sg::test::Moments> pixels(24 * 18);
    std::vector<double> told(pixels.size());
    for (uint64_t seed = 0; seed < seeds; ++seed) {
      s.options.seed = seed;
      TraceReport report;
      const Frame f = picture_of(s, s.options, report);
      CHECK(root_mean_square(report.planes.error) == Approx(report.noise).epsilon(1e-4));
      for (size_t i = 0; i < pixels.size(); ++i) {
        const float* c = &f.rgba[4 * i];
        pixels[i].add(0.2126 * double(c[0]) + 0.7152 * double(c[1]) + 0.0722 * double(c[2]));
        told[i] += double(report.planes.error[i]) * double(report.planes.error[i]) / seeds;
      }
    }
    // By the thirds of the picture from the left, each of 144 pixels, in linear light where sRGB's curve is all but straight.
    for (int third = 0; third < 3; ++third) {
      double want = 0, found = 0;
      for (size_t i = 0; i < pixels.size(); ++i) {
        if (int(i % 24) / 8 != third) continue;
        const auto y = std::clamp(float(pixels[i].mean), 0.02f, 1.f);
        const double slope = double(srgb_encode(y + 0.01f) - srgb_encode(y - 0.01f)) / 0.02;
        found += pixels[i].variance() * slope * slope, want += told[i];
      }
      CAPTURE(third);
      CHECK(std::sqrt(want) == Approx(std::sqrt(found)).epsilon(0.25));
    }
  }
}

TEST_CASE("progressive: a picture that is looked at on the way ends as the same bytes, each time nearer to them") {
  NoisyScene s = soft_shadow(37, 29);
  s.options.noise = 0.02, s.options.paths = 64;
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::bdpt}) {
    CAPTURE(kind);
    s.options.integrator = kind;
    TraceReport want, found;
    const Frame whole = picture_of(s, s.options, want);
    std::vector<double> off, noise;
    LightWatch watch;
    watch.every = 0;
    watch.on_frame = [&](const Frame& f, const TraceReport& r) {
      off.push_back(displayed_difference(f, whole)), noise.push_back(r.noise);
      CHECK(root_mean_square(r.planes.error) == Approx(r.noise).epsilon(1e-4));
      return true;
    };
    CHECK(same_light(picture_of(s, s.options, found, watch), whole));
    CHECK(found.noise == want.noise);
    CHECK(found.paths == want.paths);
    CHECK(found.stopped == 0);
    REQUIRE(off.size() >= 2);
    CHECK(off.back() < 0.8 * off.front());

    // Who has seen enough ends it; the same number of paths makes that picture again.
    int seen = 0;
    watch.on_frame = [&](const Frame&, const TraceReport&) { return ++seen < 2; };
    const Frame ended = picture_of(s, s.options, found, watch);
    CHECK(seen == 2);
    CHECK_FALSE(found.reached);
    REQUIRE(found.stopped > 0);
    LightOptions again = s.options;
    again.stop = found.stopped;
    CHECK(same_light(picture_of(s, again), ended));
  }
}

TEST_CASE("seconds: a picture whose noise is never reached stops in time, is even, and says so") {
  NoisyScene s = glossy_room(96, 72);
  s.options.paths = 1 << 20, s.options.seconds = 0.5;
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::bdpt, IntegratorKind::metropolis}) {
    CAPTURE(kind);
    s.options.integrator = kind;
    TraceReport report;
    const auto begin = std::chrono::steady_clock::now();
    const Frame stopped = picture_of(s, s.options, report);
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    CHECK(took < 20);  // sanitizers and busy machines are slow; two passes come always
    CHECK_FALSE(report.reached);
    REQUIRE(report.stopped >= 2);
    CHECK(report.paths == Approx(report.stopped));
    CHECK(report.noise > 0);
    LightOptions again = s.options;
    again.seconds = 0, again.stop = report.stopped;
    TraceReport repeated;
    CHECK(same_light(picture_of(s, again, repeated), stopped));
    CHECK(repeated.noise == report.noise);
  }
  // Enough time changes nothing.
  s.options = soft_shadow().options;
  s.options.paths = 8;
  const Frame want = picture_of(s, s.options);
  s.options.seconds = 1000;
  CHECK(same_light(picture_of(s, s.options), want));
  for (const double seconds : {-1.0, std::nan("")}) {
    s.options.seconds = seconds;
    CHECK_THROWS_AS(picture_of(s, s.options), Error);
  }
  s.options.seconds = 0, s.options.stop = -1;
  CHECK_THROWS_AS(picture_of(s, s.options), Error);
}
