// SPDX-License-Identifier: Apache-2.0
#include "render/trace/material/albedo.h"

#include <cstddef>

#include "render/trace/material/fresnel.h"

namespace sg::trace {

namespace {

// N functions f(w, m) of a direction and a normal that is seen from it, as means over these normals: a grid of the square that visible()
// takes, closer towards u.y = 1, from where come the steep normals of which most is lost. `turn`: the part of a turn that is seen; half of
// it where both halves are alike.
template <size_t N, class F>
std::array<float, N> mean_over_visible(const Ggx& ggx, Vec3f w, float turn, F f) {
  const int angles = int(32 * turn), heights = 96;
  std::array<double, N> sums{};
  double whole = 0;
  for (int j = 0; j < heights; ++j) {
    const double v = (j + 0.5) / heights, weight = v * v;
    for (int i = 0; i < angles; ++i) {
      const std::array<float, N> values = f(w, ggx.visible(w, {turn * (float(i) + 0.5f) / float(angles), float(1 - v * v * v)}));
      for (size_t k = 0; k < N; ++k) sums[k] += weight * double(values[k]);
      whole += weight;
    }
  }
  std::array<float, N> means;
  for (size_t k = 0; k < N; ++k) means[k] = float(sums[k] / whole);
  return means;
}

template <size_t N, class F>
std::array<AlbedoCurve, N> curves(const Ggx& ggx, F f) {
  std::array<std::array<float, AlbedoCurve::places>, N> values{};
  for (int i = 0; i < AlbedoCurve::places; ++i) {
    const float z = std::max(AlbedoCurve::cosine_of(i), 1e-4f), r = std::sqrt(1 - z * z), d = r * std::sqrt(0.5f);
    auto take = [&](const std::array<float, N>& means) {
      for (size_t k = 0; k < N; ++k) values[k][size_t(i)] = std::max(values[k][size_t(i)], means[k]);
    };
    if (ggx.isotropic()) {
      take(mean_over_visible<N>(ggx, {r, 0, z}, 0.5f, f));
      continue;
    }
    for (const Vec3f w : {Vec3f(r, 0, z), Vec3f(d, d, z), Vec3f(0, r, z)}) take(mean_over_visible<N>(ggx, w, 1, f));
  }
  std::array<AlbedoCurve, N> all;
  for (size_t k = 0; k < N; ++k) all[k] = AlbedoCurve(values[k]);
  return all;
}

// Shadowing of w and the reflected direction by that of w; 0 where the latter goes into the surface.
float reflected_weight(const Ggx& ggx, Vec3f w, Vec3f m) {
  const Vec3f to = reflected(w, m);
  return to.z > 0 ? ggx.seen(w, to) / ggx.seen(w) : 0;
}

}  // namespace

float AlbedoCurve::mean() const {
  // With cosine = x^2 the integral is that of 4 x^3 f, of fourth order within each piece: Gauss, three points.
  const double offset = std::sqrt(0.6) / 2, nodes[] = {0.5 - offset, 0.5, 0.5 + offset}, weights[] = {5 / 18., 8 / 18., 5 / 18.};
  const int last = places - 1;
  double sum = 0;
  for (int i = 0; i < last; ++i)
    for (int k = 0; k < 3; ++k) {
      const double x = (i + nodes[k]) / last, f = double(at_[size_t(i)]) + (double(at_[size_t(i + 1)]) - double(at_[size_t(i)])) * nodes[k];
      sum += weights[k] / last * 4 * x * x * x * f;
    }
  return float(sum);
}

MirrorAlbedo mirror_albedo(const Ggx& ggx) {
  if (ggx.smooth()) return {AlbedoCurve::of([](float) { return 1.f; }), AlbedoCurve::of(schlick_share)};
  const auto both = curves<2>(ggx, [&](Vec3f w, Vec3f m) {
    const float weight = reflected_weight(ggx, w, m);
    return std::array<float, 2>{weight, weight * schlick_share(dot(w, m))};
  });
  return {both[0], both[1]};
}

AlbedoCurve mirror_albedo(const Ggx& ggx, const AlbedoCurve& passes) {
  if (ggx.smooth()) return passes;
  return curves<1>(ggx, [&](Vec3f w, Vec3f m) { return std::array<float, 1>{reflected_weight(ggx, w, m) * passes(reflected(w, m).z)}; })[0];
}

std::array<AlbedoCurve, 3> conductor_albedo(const Ggx& ggx, Vec3f eta, Vec3f k) {
  auto fresnel = [&](float cosine, int i) { return fresnel_conductor(cosine, eta[i], k[i]); };
  if (ggx.smooth()) {
    auto curve = [&](int i) { return AlbedoCurve::of([&](float cosine) { return fresnel(cosine, i); }); };
    return {curve(0), curve(1), curve(2)};
  }
  return curves<3>(ggx, [&](Vec3f w, Vec3f m) {
    const float weight = reflected_weight(ggx, w, m), cosine = dot(w, m);
    return std::array<float, 3>{weight * fresnel(cosine, 0), weight * fresnel(cosine, 1), weight * fresnel(cosine, 2)};
  });
}

BoundaryAlbedo boundary_albedo(const Ggx& ggx, float eta, bool sheet) {
  auto reflectance = [&](float cosine) {
    const float r = fresnel_dielectric(cosine, eta).reflected();
    return sheet ? sheet_reflectance(r) : r;
  };
  if (ggx.smooth() || eta == 1)
    return {AlbedoCurve::of(reflectance), AlbedoCurve::of([&](float cosine) { return 1 - reflectance(cosine); })};
  const auto both = curves<2>(ggx, [&](Vec3f w, Vec3f m) {
    const float cosine = dot(w, m), r = reflectance(cosine), weight = reflected_weight(ggx, w, m);
    if (sheet) return std::array<float, 2>{r * weight, (1 - r) * weight};
    const Vec3f to = refracted(w, m, eta, fresnel_dielectric(cosine, eta).cosine_through);
    return std::array<float, 2>{r * weight, to.z < 0 ? (1 - r) * ggx.seen(w, to) / ggx.seen(w) : 0};
  });
  return {both[0], both[1]};
}

}  // namespace sg::trace
