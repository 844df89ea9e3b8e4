// SPDX-License-Identifier: Apache-2.0
#include "render/trace/material/bsdf.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/trace/material/cases.h"
#include "render/trace/sampling/sampler.h"
#include "support/statistics.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test_cases;
using doctest::Approx;

namespace {

Vec2 angles_of(Vec3f d) {
  const double a = std::atan2(double(d.y), double(d.x));
  return {std::acos(std::clamp(double(d.z), -1., 1.)), a < 0 ? a + 2 * M_PI : a};
}

// Where smooth surfaces send the light of wo.
std::vector<Vec2> smooth_directions(Vec3f wo, float ior) {
  std::vector<Vec2> all{angles_of({-wo.x, -wo.y, wo.z}), angles_of(wo), angles_of(-wo)};
  for (const float eta : {ior, 1 / ior}) {
    const float r2 = (1 - wo.z * wo.z) / (eta * eta);
    if (r2 < 1) all.push_back(angles_of({-wo.x / eta, -wo.y / eta, wo.z > 0 ? -std::sqrt(1 - r2) : std::sqrt(1 - r2)}));
  }
  return all;
}

// Integral over solid angle of f(direction) for angles t from the normal and a about it: midpoints, in quarters where twice as many differ.
// `peaks`: (t, a) of directions about which f may be narrower than the first midpoints are apart.
double integral(const auto& f, double t, double dt, double a, double da, double enough, const std::vector<Vec2>& peaks = {},
                int depth = 0) {
  auto midpoints = [&](int n) {
    double sum = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double angle = t + dt * (i + .5) / n;
        sum += std::sin(angle) * double(f(direction(std::cos(angle), a + da * (j + .5) / n)));
      }
    return sum * dt * da / (n * n);
  };
  const bool narrow = depth < 8 && std::any_of(peaks.begin(), peaks.end(), [&](Vec2 p) {
                        return p.x >= t - dt / 4 && p.x <= t + dt * 1.25 && p.y >= a - da / 4 && p.y <= a + da * 1.25;
                      });
  if (!narrow) {
    const double rough = midpoints(depth ? 4 : 8), fine = midpoints(depth ? 8 : 16);
    if (depth == 11 || std::abs(fine - rough) < 1e-3 * fine + enough) return fine;
  }
  double sum = 0;
  for (int k = 0; k < 4; ++k) sum += integral(f, t + (k & 1) * dt / 2, dt / 2, a + (k >> 1) * da / 2, da / 2, enough / 2, peaks, depth + 1);
  return sum;
}

}  // namespace

TEST_CASE("bsdf: what is sampled has the density pdf(), which with deltas and what fails integrates to one (chi-square)") {
  const int n = 20'000, nt = 16, na = 12;
  for (const Case& c : cases()) {
    if (c.preset) continue;
    CAPTURE(c.name);
    const Material material(c.material);
    const Bsdf b = make_bsdf(material, material.base_color(), c.opacity);
    if (b.delta_only()) continue;
    for (const size_t k : {0, 2, 3, 4}) {
      const Vec3f wo = directions()[k];
      CAPTURE(wo.z);
      const std::vector<Vec2> peaks = smooth_directions(wo, material.ior());
      std::vector<double> expected(nt * na), observed(nt * na);
      double whole = 0;
      for (int box = 0; box < nt * na; ++box) {
        const double t = M_PI * (box / na) / nt, a = 2 * M_PI * (box % na) / na;
        whole += expected[size_t(box)] = integral([&](Vec3f wi) { return b.pdf(wo, wi); }, t, M_PI / nt, a, 2 * M_PI / na, 2e-6, peaks);
        expected[size_t(box)] *= n;
      }
      const Furnace f = furnace(b, wo, 4096);
      CHECK(whole + f.delta_chance + f.nothing == Approx(1).epsilon(.006));
      Sampler s(SamplerKind::independent, 17, 1);
      double others = 0;
      for (int i = 0; i < n; ++i) {
        s.start(uint32_t(i), 0, 0);
        const Vec2f u = s.next2();
        const auto drawn = b.sample(wo, s.next(), u);
        if (!drawn || drawn->delta) {
          ++others;
          continue;
        }
        const Vec3f d = drawn->direction;
        const Vec2 at = angles_of(d);
        ++observed[size_t(std::min(int(at.x / M_PI * nt), nt - 1) * na + std::min(int(at.y / (2 * M_PI) * na), na - 1))];
      }
      expected.push_back(n * std::max(0., 1 - whole)), observed.push_back(others);
      // Bins in which less than one is expected may hold one: they are pooled, not impossible.
      for (double& e : expected) e = std::max(e, 1e-9);
      CHECK(test::chi_square_chance(observed, expected) > 1e-6);
    }
  }
}

TEST_CASE("bsdf: energy is kept by what evaluate() says as well, not only by samples") {
  for (const Case& c : cases()) {
    const Material material(c.material);
    const Bsdf b = make_bsdf(material, material.base_color(), c.opacity);
    if (!c.white || c.material.specular_roughness < .4 || c.material.transmission_weight == 0 || c.material.specular_ior == 1) continue;
    CAPTURE(c.name);
    for (const Vec3f wo : directions()) {
      const double energy = integral([&](Vec3f wi) { return std::abs(wi.z) * b.evaluate(wo, wi, Transport::importance).y; }, 0, M_PI, 0,
                                     2 * M_PI, 1e-5, smooth_directions(wo, material.ior()));
      CHECK(energy == Approx(1).epsilon(.015));
    }
  }
}
