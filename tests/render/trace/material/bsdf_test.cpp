// SPDX-License-Identifier: Apache-2.0
#include "render/trace/material/bsdf.h"

#include <algorithm>
#include <vector>

#include "base/random.h"
#include "render/trace/material/cases.h"
#include "render/trace/material/fresnel.h"
#include "render/trace/sampling/sampler.h"
#include "render/trace/sampling/warp.h"
#include "support/statistics.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test_cases;
using doctest::Approx;

namespace {

// Shares of uniform light that go out along wo, by samples.
struct Furnace {
  Vec3 energy;
  double delta_chance = 0, nothing = 0;
};
Furnace furnace(const Bsdf& b, Vec3f wo, int n) {
  Furnace f;
  Sampler s(SamplerKind::sobol, 9, n);
  for (int i = 0; i < n; ++i) {
    s.start(0, 0, uint32_t(i));
    const Vec2f u = s.next2();
    const auto drawn = b.sample(wo, s.next(), u, Transport::importance);
    if (!drawn) f.nothing += 1. / n;
    else f.energy += Vec3(drawn->weight) * (1. / n), f.delta_chance += drawn->delta ? 1. / n : 0;
  }
  return f;
}

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
  const bool narrow = depth < 6 && std::any_of(peaks.begin(), peaks.end(), [&](Vec2 p) {
                        return p.x >= t - dt / 4 && p.x <= t + dt * 1.25 && p.y >= a - da / 4 && p.y <= a + da * 1.25;
                      });
  if (!narrow) {
    const double rough = midpoints(depth ? 4 : 8), fine = midpoints(depth ? 8 : 16);
    if (depth == 8 || std::abs(fine - rough) < 1e-3 * fine + enough) return fine;
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
    for (const Vec3f wo : directions()) {
      CAPTURE(wo.z);
      const std::vector<Vec2> peaks = smooth_directions(wo, material.ior());
      std::vector<double> expected(nt * na), observed(nt * na);
      double whole = 0;
      for (int k = 0; k < nt * na; ++k) {
        const double t = M_PI * (k / na) / nt, a = 2 * M_PI * (k % na) / na;
        whole += expected[size_t(k)] = integral([&](Vec3f wi) { return b.pdf(wo, wi); }, t, M_PI / nt, a, 2 * M_PI / na, 2e-6, peaks);
        expected[size_t(k)] *= n;
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

TEST_CASE("bsdf: the weight of a sample is f |cos| / pdf, its direction is unit, and it says on which side it is") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const Material material(c.material);
    const Bsdf b = make_bsdf(material, material.base_color(), c.opacity);
    for (const Vec3f wo : directions())
      for (const Transport t : {Transport::radiance, Transport::importance})
        for (uint64_t i = 0; i < 200; ++i) {
          const auto unit = [&](uint64_t k) { return std::min(float(random_unit(i, k)), 0x1.fffffep-1f); };
          const auto s = b.sample(wo, unit(0), {unit(1), unit(2)}, t);
          if (!s) continue;
          CHECK(length(s->direction) == Approx(1).epsilon(1e-5));
          CHECK(s->transmitted == (s->direction.z * wo.z < 0));
          CHECK(s->pdf > 0);
          CHECK(s->weight.x >= 0);
          if (!s->transmitted || material.thin()) CHECK(s->eta == 1);
          if (s->delta) continue;
          CHECK(b.pdf(wo, s->direction) == Approx(double(s->pdf)).epsilon(1e-3));
          const Vec3f weight = b.evaluate(wo, s->direction, t) * (std::abs(s->direction.z) / s->pdf);
          for (int k = 0; k < 3; ++k) CHECK(weight[k] == Approx(double(s->weight[k])).epsilon(2e-3));
        }
  }
}

TEST_CASE("bsdf: no kind gives back more than arrives from any direction, and white ones all of it") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const Material material(c.material);
    const Bsdf b = make_bsdf(material, material.base_color(), c.opacity);
    for (const Vec3f wo : directions()) {
      CAPTURE(wo.z);
      const Vec3 energy = furnace(b, wo, 32768).energy;
      for (int k = 0; k < 3; ++k) {
        CHECK(energy[k] < 1.005);
        if (c.white) CHECK(energy[k] == Approx(1).epsilon(5e-3));
      }
      if (c.material.coat_weight > 0 || (c.material.specular_anisotropy > 0)) continue;
      CHECK(b.albedo(wo).y == Approx(energy.y).epsilon(.05));
    }
  }
}

TEST_CASE("bsdf: reciprocal; across a boundary with the squares of the indices of refraction") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const Material material(c.material);
    const Bsdf b = make_bsdf(material, material.base_color(), c.opacity);
    int compared = 0;
    for (uint64_t i = 0; i < 400; ++i) {
      const Vec3f wo = uniform_sphere({float(random_unit(1, i)), float(random_unit(2, i))});
      const Vec3f wi = uniform_sphere({float(random_unit(3, i)), float(random_unit(4, i))});
      if (std::abs(wo.z) < .02f || std::abs(wi.z) < .02f) continue;
      const Vec3f there = b.evaluate(wo, wi), back = b.evaluate(wi, wo);
      double scale = 1;
      if (wo.z * wi.z < 0 && material.has_inside()) scale = wo.z > 0 ? double(material.ior()) : 1 / double(material.ior());
      for (int k = 0; k < 3; ++k) CHECK(double(there[k]) * scale * scale == Approx(double(back[k])).epsilon(3e-3).scale(1e-4));
      const Vec3f importance = b.evaluate(wo, wi, Transport::importance);
      CHECK(double(importance.y) == Approx(double(there.y) * scale * scale).epsilon(1e-4).scale(1e-4));
      compared += there.y > 0;
    }
    CHECK((compared > 50 || b.delta_only() || c.material.base_metalness == 1 || c.material.retro_weight == 1 ||
           c.material.transmission_weight == 1));
  }
}

TEST_CASE("bsdf: energy is kept by what evaluate() says as well, not only by samples") {
  for (const Case& c : cases()) {
    const Material material(c.material);
    const Bsdf b = make_bsdf(material, material.base_color(), c.opacity);
    if (!c.white || c.material.specular_roughness < .4 || c.material.transmission_weight == 0 || c.material.specular_ior == 1) continue;
    CAPTURE(c.name);
    for (const Vec3f wo : directions()) {
      const double energy =
          integral([&](Vec3f wi) { return std::abs(wi.z) * b.evaluate(wo, wi, Transport::importance).y; }, 0, M_PI, 0, 2 * M_PI, 1e-4);
      CHECK(energy == Approx(1).epsilon(.015));
    }
  }
}

TEST_CASE("bsdf: smooth glass bends light by Snell's law and mirrors beyond the critical angle; sheets let it straight through") {
  const Material glass(preset_material(MaterialPreset::glass)), sheet(preset_material(MaterialPreset::thin_glass));
  const Bsdf b = make_bsdf(glass);
  CHECK(b.delta_only());
  CHECK(glass.has_inside());
  const Vec3f wo = direction(.6, 1);
  const auto in = b.sample(wo, .999f, {.5f, .5f});
  REQUIRE(in);
  CHECK((in->transmitted && in->delta));
  CHECK(in->eta == Approx(1.5));
  CHECK(std::hypot(in->direction.x, in->direction.y) == Approx(.8 / 1.5).epsilon(1e-5));
  CHECK(in->weight.y == Approx(1 / 2.25).epsilon(1e-4));  // radiance is lower by eta^2 outside
  const auto out = b.sample(in->direction, .999f, {.5f, .5f});
  REQUIRE(out);
  CHECK(out->eta == Approx(1 / 1.5));
  for (int k = 0; k < 3; ++k) CHECK(out->direction[k] == Approx(double(wo[k])).epsilon(1e-5));
  const auto total = b.sample(direction(-.5, 1), .999f, {.5f, .5f});
  REQUIRE(total);
  CHECK_FALSE(total->transmitted);
  CHECK(total->weight.y == Approx(1));
  const Bsdf s = make_bsdf(sheet);
  CHECK_FALSE(sheet.has_inside());
  const auto through = s.sample(wo, .999f, {.5f, .5f});
  REQUIRE(through);
  CHECK(through->direction == -wo);
  CHECK(through->eta == 1);
}

TEST_CASE("bsdf: matte is base colour by pi, retroreflectors send light back, opacity passes straight on") {
  SurfaceMaterial described = preset_material(MaterialPreset::matte);
  const Material matte(described);
  const Bsdf b = make_bsdf(matte, {.2f, .5f, .9f});
  for (const Vec3f wo : directions()) {
    const Vec3f f = b.evaluate(wo, direction(wo.z > 0 ? .4 : -.4, 2));
    CHECK(f.x == Approx(.2 / M_PI).epsilon(1e-5));
    CHECK(f.z == Approx(.9 / M_PI).epsilon(1e-5));
    CHECK(b.evaluate(wo, direction(wo.z > 0 ? -.4 : .4, 2)) == Vec3f());
  }
  SurfaceMaterial retro;
  retro.retro_weight = 1, retro.specular_roughness = 0;
  const Material back(retro);
  CHECK(make_bsdf(back).sample(direction(.3, 1), .5f, {.1f, .7f})->direction == direction(.3, 1));
  const Bsdf half = make_bsdf(matte, {1, 1, 1}, .25f);
  const auto on = half.sample(direction(.3, 1), .1f, {.1f, .7f});
  CHECK(on->direction == -direction(.3, 1));
  CHECK((on->delta && on->transmitted && on->weight.x == Approx(1)));
  CHECK(half.evaluate(direction(.3, 1), direction(.5, 2)).x == Approx(.25 / M_PI).epsilon(1e-5));
}

TEST_CASE("bsdf: what enters below the surface and leaves it again keeps the energy of what is diffuse otherwise") {
  SurfaceMaterial described = preset_material(MaterialPreset::wax);
  described.subsurface_weight = .6, described.base_color = {1, 1, 1};
  const Material wax(described);
  const Bsdf whole = make_bsdf(wax, {1, 1, 1}), part = make_bsdf(wax, {1, 1, 1}, 1, true);
  double leaves = 0;
  for (int i = 0; i < 1000; ++i) {
    const float z = (float(i) + .5f) / 1000;
    leaves += double(part.leaving(direction(double(z), 1)).x) * 2 * double(z) / 1000;
  }
  CHECK(leaves == Approx(1).epsilon(1e-3));
  for (const Vec3f wo : directions())
    CHECK(double(part.albedo(wo).x + part.entering(wo).x) == Approx(double(whole.albedo(wo).x)).epsilon(1e-4));
}
