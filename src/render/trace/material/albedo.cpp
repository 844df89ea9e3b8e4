// SPDX-License-Identifier: Apache-2.0
#include "render/trace/material/albedo.h"

#include "render/trace/material/fresnel.h"

namespace sg::trace {

namespace {

// Mean over the normals seen from w of f(m): a grid of the square that visible() takes, closer towards u.y = 1, from where come the steep
// normals of which most is lost.
template <class F>
float mean_over_visible(const Ggx& ggx, Vec3f w, F f) {
  const int angles = 32, heights = 96;
  double sum = 0, whole = 0;
  for (int j = 0; j < heights; ++j) {
    const double v = (j + 0.5) / heights, weight = v * v;
    for (int i = 0; i < angles; ++i)
      sum += weight * double(f(ggx.visible(w, {(i + 0.5f) / angles, float(1 - v * v * v)}))), whole += weight;
  }
  return float(sum / whole);
}

// The largest over the directions about the normal: along both axes and between them.
template <class F>
AlbedoCurve largest(const Ggx& ggx, F of_direction) {
  return AlbedoCurve::of([&](float cosine) {
    const float z = std::max(cosine, 1e-4f), r = std::sqrt(1 - z * z);
    if (ggx.isotropic()) return of_direction(Vec3f(r, 0, z));
    const float d = r * std::sqrt(0.5f);
    return std::max({of_direction(Vec3f(r, 0, z)), of_direction(Vec3f(d, d, z)), of_direction(Vec3f(0, r, z))});
  });
}

// Shadowing of w and the reflected direction by that of w; 0 where the latter goes into the surface.
float reflected_weight(const Ggx& ggx, Vec3f w, Vec3f m) {
  const Vec3f to = reflected(w, m);
  return to.z > 0 ? ggx.seen(w, to) / ggx.seen(w) : 0;
}

// Single reflections at mirrors that reflect f(cosine).
template <class F>
AlbedoCurve of_mirrors(const Ggx& ggx, F f) {
  if (ggx.smooth()) return AlbedoCurve::of(f);
  return largest(ggx,
                 [&](Vec3f w) { return mean_over_visible(ggx, w, [&](Vec3f m) { return f(dot(w, m)) * reflected_weight(ggx, w, m); }); });
}

}  // namespace

float AlbedoCurve::mean() const {
  // With cosine = x^2 the integral is that of 4 x^3 f, of fourth order within each piece: Gauss, three points.
  const double offset = std::sqrt(0.6) / 2, nodes[] = {0.5 - offset, 0.5, 0.5 + offset}, weights[] = {5 / 18., 8 / 18., 5 / 18.};
  double sum = 0;
  for (int i = 0; i < last; ++i)
    for (int k = 0; k < 3; ++k) {
      const double x = (i + nodes[k]) / last, f = double(at_[size_t(i)]) + (double(at_[size_t(i + 1)]) - double(at_[size_t(i)])) * nodes[k];
      sum += weights[k] / last * 4 * x * x * x * f;
    }
  return float(sum);
}

AlbedoCurve mirror_albedo(const Ggx& ggx) {
  return of_mirrors(ggx, [](float) { return 1.f; });
}

AlbedoCurve conductor_albedo(const Ggx& ggx, float eta, float k) {
  return of_mirrors(ggx, [&](float cosine) { return fresnel_conductor(cosine, eta, k); });
}

AlbedoCurve grazing_albedo(const Ggx& ggx) { return of_mirrors(ggx, schlick_share); }

BoundaryAlbedo boundary_albedo(const Ggx& ggx, float eta, bool sheet) {
  auto reflectance = [&](float cosine) {
    const float r = fresnel_dielectric(cosine, eta).reflected();
    return sheet ? sheet_reflectance(r) : r;
  };
  if (ggx.smooth() || eta == 1)
    return {AlbedoCurve::of(reflectance), AlbedoCurve::of([&](float cosine) { return 1 - reflectance(cosine); })};
  BoundaryAlbedo albedo;
  albedo.reflected = of_mirrors(ggx, reflectance);
  albedo.passed = largest(ggx, [&](Vec3f w) {
    return mean_over_visible(ggx, w, [&](Vec3f m) {
      const float cosine = dot(w, m);
      if (sheet) return (1 - reflectance(cosine)) * reflected_weight(ggx, w, m);
      const Fresnel fresnel = fresnel_dielectric(cosine, eta);
      const Vec3f to = refracted(w, m, eta, fresnel.cosine_through);
      return to.z < 0 ? (1 - fresnel.reflected()) * ggx.seen(w, to) / ggx.seen(w) : 0.f;
    });
  });
  return albedo;
}

}  // namespace sg::trace
