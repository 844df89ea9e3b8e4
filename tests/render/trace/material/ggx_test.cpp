// SPDX-License-Identifier: Apache-2.0
#include "render/trace/material/ggx.h"

#include <vector>

#include "render/trace/material/albedo.h"
#include "render/trace/material/fresnel.h"
#include "render/trace/sampling/sampler.h"
#include "support/statistics.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

namespace {

Vec3f at(double cosine, double angle) {
  const double s = std::sqrt(1 - cosine * cosine);
  return Vec3f(Vec3(s * std::cos(angle), s * std::sin(angle), cosine));
}

}  // namespace

TEST_CASE("ggx: normals weighted with their cosine cover the surface once: the integral of D cos is 1") {
  for (const auto& [ax, ay] : {std::pair{.1f, .1f}, {.5f, .5f}, {1.f, 1.f}, {.1f, .4f}, {.02f, .02f}}) {
    const Ggx ggx(ax, ay);
    // In slopes D cos becomes a density that falls off as their fourth power: substitute slope = alpha tan(v).
    const int n = 2000, m = 64;
    double sum = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < m; ++j) {
        const double v = (i + .5) / n * M_PI / 2, t = std::tan(v), angle = (j + .5) / m * 2 * M_PI;
        const Vec3f normal = normalize(Vec3f(Vec3(-double(ax) * t * std::cos(angle), -double(ay) * t * std::sin(angle), 1)));
        const double z = double(normal.z), slopes = double(ax) * double(ay) * t / (std::cos(v) * std::cos(v));
        sum += double(ggx.normals(normal)) * z * z * z * z * slopes * (M_PI / 2 / n) * (2 * M_PI / m);  // d omega = cos^3 d slopes
      }
    CHECK(sum == Approx(1).epsilon(1e-4));
  }
}

TEST_CASE("ggx: what is seen of the normals from any direction is the projected area, and sampled in proportion (chi-square)") {
  for (const auto& [ax, ay] : {std::pair{.3f, .3f}, {1.f, 1.f}, {.2f, .6f}})
    for (const double cosine : {1., .7, .2, .02}) {
      const Ggx ggx(ax, ay);
      const Vec3f w = at(cosine, .5);
      const int nz = 16, na = 16, fine = 24, n = 40'000;
      std::vector<double> expected(nz * na), observed(nz * na);
      double whole = 0;
      for (int i = 0; i < nz * fine; ++i)
        for (int j = 0; j < na * fine; ++j) {
          const Vec3f m = at((i + .5) / (nz * fine), (j + .5) / (na * fine) * 2 * M_PI);
          const double share = double(ggx.visible_pdf(w, m)) * 2 * M_PI / (nz * na * fine * fine);
          whole += share, expected[size_t(i / fine * na + j / fine)] += n * share;
        }
      CAPTURE(cosine);
      CAPTURE(ax);
      CHECK(whole == Approx(1).epsilon(3e-3));
      Sampler s(SamplerKind::independent, 5, 1);
      for (int i = 0; i < n; ++i) {
        s.start(uint32_t(i), 0, 0);
        const Vec3f m = ggx.visible(w, s.next2());
        double angle = std::atan2(double(m.y), double(m.x));
        if (angle < 0) angle += 2 * M_PI;
        ++observed[size_t(std::min(int(double(m.z) * nz), nz - 1) * na + std::min(int(angle / (2 * M_PI) * na), na - 1))];
        CHECK((m.z > 0 && dot(m, w) > -1e-6f && std::abs(length(m) - 1) < 1e-6f));
      }
      for (double& e : expected) e = std::max(e, 1e-9);  // slivers between the midpoints
      CHECK(test::chi_square_chance(observed, expected) > 1e-4);
    }
}

TEST_CASE("ggx: white single reflections at normal incidence keep .98815, .87739, .68787, .30686 for alpha .1, .3, .5, 1") {
  const std::pair<float, double> known[] = {{.1f, .98815}, {.3f, .87739}, {.5f, .68787}, {1.f, .30686}};
  for (const auto& [alpha, albedo] : known) CHECK(std::abs(double(mirror_albedo(Ggx(alpha, alpha)).white(1)) - albedo) < 2e-4);
  CHECK(mirror_albedo(Ggx()).white(0.3f) == 1);
}

TEST_CASE("ggx: the same by the slopes of the mirrors, and 1 - ln 2 for alpha 1") {
  for (const float alpha : {.05f, .1f, .5f, 1.f}) {
    double sum = 0;
    const int n = 100'000;
    for (int i = 0; i < n; ++i) {
      // Of mirrors that lean by t a share alpha^2 / (alpha^2 + tan^2 t) leans more; light is reflected by 2 t.
      const double v = (i + .5) / n, share = v * v * v, t = std::atan(double(alpha) * std::sqrt((1 - share) / share));
      if (t < M_PI / 4) sum += 3 * v * v / n * 2 / (1 + std::sqrt(1 + double(alpha * alpha) * std::tan(2 * t) * std::tan(2 * t)));
    }
    CHECK(mirror_albedo(Ggx(alpha, alpha)).white(1) == Approx(sum).epsilon(2e-4));
    if (alpha == 1) CHECK(sum == Approx(1 - std::log(2)).epsilon(1e-5));
  }
}

TEST_CASE("ggx: roughness is the root of alpha; below a thousandth a surface is smooth") {
  CHECK(Ggx::of_roughness(.5f).normals({0, 0, 1}) == Approx(1 / (M_PI * .25 * .25)).epsilon(1e-5));
  CHECK_FALSE(Ggx::of_roughness(.04f).smooth());
  CHECK(Ggx::of_roughness(.03f).smooth());
  CHECK_FALSE(Ggx::of_roughness(.5f, .9f).isotropic());
}

TEST_CASE("albedo: curves are exact at their places and their average is the integral; boundaries neither make nor hide energy") {
  const AlbedoCurve root = AlbedoCurve::of([](float c) { return std::sqrt(c); });  // linear in the root of the cosine
  CHECK(root(.37f) == Approx(std::sqrt(.37)).epsilon(1e-5));
  CHECK(root.average() == Approx(.8).epsilon(1e-5));
  for (const float alpha : {.01f, .2f, .6f, 1.f})
    for (const float eta : {1.3f, 1.5f, 1 / 1.5f}) {
      const Ggx ggx(alpha, alpha);
      const BoundaryAlbedo solid = boundary_albedo(ggx, eta, false), sheet = boundary_albedo(ggx, eta, true);
      const AlbedoCurve mirror = mirror_albedo(ggx).white;
      for (const float c : {.02f, .3f, .8f, 1.f}) {
        CHECK(solid.reflected(c) + solid.passed(c) < 1.0005f);
        CHECK(sheet.reflected(c) + sheet.passed(c) == Approx(double(mirror(c))).epsilon(1e-4));
      }
    }
  const BoundaryAlbedo smooth = boundary_albedo(Ggx(), 1.5f, false);
  CHECK(smooth.reflected(.5f) == Approx(double(fresnel_dielectric(.5f, 1.5f).reflected())).epsilon(1e-3));
}
