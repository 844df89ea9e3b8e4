// SPDX-License-Identifier: Apache-2.0
// Light that wanders below surfaces: bodies that keep all of it, half-spaces whose colour and whose profile are known.
#include "render/trace/integrators/subsurface_walk.h"

#include "bidirectional/light_scenes.h"
#include "render/trace/material/subsurface.h"
#include "render/trace/trace.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;

namespace {

SurfaceMaterial wax(double path, double specular = 0, double g = 0) {
  SurfaceMaterial m;
  m.subsurface_weight = 1, m.specular_weight = specular, m.specular_roughness = 0.4;
  m.subsurface_radius = {path, path, path}, m.subsurface_anisotropy = g;
  return m;
}

/// A ball, or the half-space below z = -0.5, in even light.
LightScene body(SurfaceItem item) {
  LightScene s;
  s.scene.items.emplace_back(std::move(item));
  s.scene.items.emplace_back(
      sheet({-0.99f, -0.99f, 0.99f}, {0.01f, 0, 0}, {0, 0.01f, 0}, sg::trace::test::diffuse(), 0));  // keep the scene's box, far away
  s.scene.items.emplace_back(sheet({0.98f, 0.98f, -0.99f}, {0.01f, 0, 0}, {0, 0.01f, 0}, sg::trace::test::diffuse(), 0));
  s.environment = Environment(Vec3f{1, 1, 1});
  return s;
}
SurfaceItem half_space(const SurfaceMaterial& made_of, double albedo) {
  return sheet({-0.99f, -0.99f, -0.5f}, {1.98f, 0, 0}, {0, 1.98f, 0}, made_of, albedo);
}

Moments seen(const World& world, const Ray& ray, int n) {
  Moments m;
  const auto integrator = path_integrator(200);
  Sampler sampler(SamplerKind::independent, 1, n);
  for (int i = 0; i < n; ++i) {
    sampler.start(0, 0, uint32_t(i));
    const Estimate e = integrator->along(world, ray, sampler);
    m.add(double(e.radiance.x) + double(e.passed));
  }
  return m;
}

const Ray down{{0.05f, 0.02f, 0.9f}, {0, 0, -1}};

}  // namespace

TEST_CASE("subsurface walk: white bodies are invisible in even light") {
  for (const double specular : {0.0, 1.0})
    for (const double g : {0.0, 0.7}) {
      CAPTURE(specular);
      const LitWorld w(body(ball({0, 0, 0}, 0.6f, 24, wax(0.1, specular, g), 1)));
      for (const float x : {0.f, 0.4f}) {
        const Moments got = seen(w.world, {{x, 0.02f, 0.9f}, {0, 0, -1}}, 2000);
        CHECK(std::abs(got.mean - 1) <= 4 * got.standard_error() + 0.006);
      }
    }
}

TEST_CASE("subsurface walk: a half-space has its colour") {
  for (const double color : {0.3, 0.8, 0.95})
    for (const double g : {0.0, 0.6}) {
      CAPTURE(color);
      const LitWorld w(body(half_space(wax(0.01, 0, g), color)));
      const Moments got = seen(w.world, down, 8000);
      // Similarity makes up for forward scattering only about.
      CHECK(std::abs(got.mean - color) <= 4 * got.standard_error() + (g > 0 ? 0.02 : 0.005));
    }
}

TEST_CASE("subsurface walk: it comes out as far away as the diffusion profile says, within a tenth") {
  const double path = 0.01;
  const LitWorld w(body(half_space(wax(path), 0.8)));
  Hit hit;
  REQUIRE(w.world.geometry().nearest(down, hit));
  const Vertex entry = w.world.at(down, hit, {}, true);
  std::vector<double> distances;
  double all = 0;
  std::vector<double> weights;
  for (uint64_t i = 0; i < 40000; ++i) {
    RandomStream random(1000 + i);
    const auto exit = walk_below(w.world, entry, random);
    if (!exit) continue;
    distances.push_back(double(length(exit->at.point.position - entry.point.position)));
    weights.push_back(double(exit->weight.x)), all += weights.back();
  }
  CHECK(all / 40000 == doctest::Approx(0.8).epsilon(0.02));
  const DiffusionProfile profile(float(path), 0.8f);
  for (const double r : {1.0, 2.0, 4.0, 8.0}) {
    double within = 0, expected = 0;
    for (size_t i = 0; i < distances.size(); ++i) within += distances[i] < r * path ? weights[i] : 0;
    for (int i = 0; i < 1000; ++i) {
      const double x = (i + 0.5) / 1000 * r * path;
      expected += 2 * 3.14159265358979 * x * double(profile.pdf(float(x))) * r * path / 1000;
    }
    CAPTURE(r);
    CHECK(std::abs(within / all - expected) < 0.1);
  }
}

TEST_CASE("subsurface walk: a white bone in a white body is as invisible, and a dark one takes a part of the light") {
  for (const double albedo : {1.0, 0.0}) {
    LightScene s = body(ball({0, 0, 0}, 0.6f, 24, wax(0.1), 1));
    s.scene.items.emplace_back(ball({0, 0, 0}, 0.45f, 24, sg::trace::test::diffuse(), albedo));
    const LitWorld w(s);
    const Moments got = seen(w.world, down, 4000);
    if (albedo == 1) {
      CHECK(std::abs(got.mean - 1) <= 4 * got.standard_error() + 0.006);
    } else {
      CHECK(got.mean < 0.8);
      CHECK(got.mean > 0.2);
    }
  }
}
