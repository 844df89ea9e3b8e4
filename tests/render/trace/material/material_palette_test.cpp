// SPDX-License-Identifier: Apache-2.0
// Materials whose numbers change from point to point: what is kept of them stands for all values between.
#include "render/trace/material/material_palette.h"

#include "render/trace/material/bsdf.h"
#include "render/trace/material/ggx.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

namespace {

SurfaceMaterial coated() {
  SurfaceMaterial m;
  m.specular_roughness = 0.8, m.coat_roughness = 0.5, m.specular_ior = 2, m.coat_ior = 1.8, m.coat_weight = 1;
  return m;
}

MaterialPalette palette(std::initializer_list<MaterialFactor> factors) {
  MaterialPalette::Varies varies{};
  for (const MaterialFactor f : factors) varies[size_t(f)] = true;
  return {coated(), 1, 1, varies};
}

MaterialPalette::Shares shares(std::initializer_list<std::pair<MaterialFactor, float>> of) {
  MaterialPalette::Shares s;
  s.fill(1);
  for (const auto& [f, v] : of) s[size_t(f)] = v;
  return s;
}

}  // namespace

TEST_CASE("material palette: each number is the share of it that is asked for") {
  using enum MaterialFactor;
  const auto n = [](const Ggx& g) { return g.normals(normalize(Vec3f{0.3f, 0.1f, 1})); };
  const auto rough = [&](double r) { return Approx(n(Ggx::of_roughness(float(r)))); };
  const auto all = palette({roughness, coat_roughness, specular, ior, coat_ior});
  const Material& m = all.at(shares({{roughness, 0.5f}, {coat_roughness, 0.25f}, {ior, 0.75f}, {coat_ior, 0.5f}}), 1);
  CHECK(n(m.ggx) == rough(0.4));
  CHECK(n(m.coat_ggx) == rough(0.125));
  CHECK(m.ior() == Approx(1.75));
  CHECK(m.coat_eta == Approx(1.4));
  // Without a boundary, and with a quarter of its reflectance: half of (2 - 1) / (2 + 1).
  CHECK(all.at(shares({{specular, 0}}), 1).ior() == 1);
  CHECK(all.at(shares({{specular, 0.25f}}), 1).ior() == Approx((1 + 1. / 6) / (1 - 1. / 6)));
  // What does not vary is as described, whatever is said of it.
  const auto one = palette({roughness});
  CHECK(one.at(shares({{roughness, 0.5f}, {ior, 0.1f}}), 1).ior() == Approx(2));
  CHECK(&one.at(shares({{roughness, 0.5f}}), 7) == &one.at(shares({{roughness, 0.5f}, {coat_ior, 0}}), 8));
}

TEST_CASE("material palette: between two steps both are taken, in proportion, and the same for the same point") {
  using enum MaterialFactor;
  const auto p = palette({ior});  // steps of 1/32 of the index above 1
  const double share = (10 + 0.3) / 32;
  double sum = 0;
  constexpr uint32_t points = 20000;
  for (uint32_t spot = 0; spot < points; ++spot) {
    const Material& m = p.at(shares({{ior, float(share)}}), spot * 2654435761u);
    CHECK_MESSAGE(&m == &p.at(shares({{ior, float(share)}}), spot * 2654435761u), spot);
    sum += double(m.ior()) - 1;
  }
  // The standard error of a share of 0.3 among so many.
  const double error = std::sqrt(0.3 * 0.7 / points) / 32;
  CHECK(std::abs(sum / points - share) <= 4 * error);
  for (const float odd : {-1.f, 2.f, NAN, INFINITY}) {
    const float index = p.at(shares({{ior, odd}}), 5).ior();
    CHECK(index >= 1);
    CHECK(index <= 2);
  }
}

TEST_CASE("material palette: filters at a point multiply what passes the coat, there and back") {
  SurfaceMaterial m;
  m.coat_weight = 1, m.coat_color = {0.64, 1, 1}, m.specular_weight = 0;
  const Material material(m);
  MaterialShares half = material.shares;
  half.coat_filter = half.coat_filter * Vec3f{0.5f, 1, 1};
  const Vec3f o = normalize(Vec3f{0.2f, 0, 1}), i = normalize(Vec3f{-0.4f, 0.3f, 1});
  const Bsdf whole = make_bsdf(material, {1, 1, 1}), filtered = make_bsdf(material, half, {1, 1, 1});
  CHECK(filtered.evaluate(o, i).x == Approx(0.25f * whole.evaluate(o, i).x).epsilon(1e-3));
  CHECK(filtered.evaluate(o, i).y == whole.evaluate(o, i).y);
}
