// SPDX-License-Identifier: Apache-2.0
#include "render/trace/sampling/sample_study.h"

#include <algorithm>
#include <cmath>

namespace sg::trace {

namespace {

// Standard deviation over pixels of the mean of exp(x + y) in each.
double deviation(SamplerKind kind, const SampleStudyParams& p) {
  const uint32_t pixels = 256;
  double sum = 0, squares = 0;
  for (uint32_t pixel = 0; pixel < pixels; ++pixel) {
    Sampler sampler(kind, uint64_t(p.seed) + 1 + pixel, p.count);
    double mean = 0;
    for (int i = 0; i < p.count; ++i) {
      sampler.start(pixel % 16, pixel / 16, uint32_t(i));
      const Vec2f u = sampler.next2();
      mean += std::exp(double(u.x) + double(u.y)) / p.count;
    }
    sum += mean, squares += mean * mean;
  }
  return std::sqrt(std::max(0.0, squares / pixels - sum / pixels * (sum / pixels)));
}

}  // namespace

void describe(Schema& s, SampleStudyParams& p) {
  s("sampler", p.sampler, "How the samples of a pixel lie to each other.");
  s("count", p.count, "Samples per pixel.").range(1, 16384);
  s("seed", p.seed, "Another number, another pattern.").at_least(0);
}

double l2_star_discrepancy(const std::vector<Vec2f>& points) {
  const double n = double(points.size());
  double single = 0, pairs = 0;
  for (const Vec2f f : points) {
    const double x = double(f.x), y = double(f.y);
    single += (1 - x * x) * (1 - y * y) / 4;
    for (const Vec2f g : points) pairs += (1 - std::max(x, double(g.x))) * (1 - std::max(y, double(g.y)));
  }
  return std::sqrt(std::max(0.0, 1.0 / 9 - 2 / n * single + pairs / (n * n)));
}

SampleStudy study_samples(const SampleStudyParams& p) {
  SampleStudy study;
  Sampler sampler(p.sampler, uint64_t(p.seed), p.count);
  for (int i = 0; i < p.count; ++i) {
    sampler.start(0, 0, uint32_t(i));
    study.points.push_back(sampler.next2());
  }
  study.discrepancy = l2_star_discrepancy(study.points);
  study.relative_error = deviation(p.sampler, p) / deviation(SamplerKind::independent, p);
  return study;
}

}  // namespace sg::trace
