// SPDX-License-Identifier: Apache-2.0
#include "render/trace/material/material.h"

#include <algorithm>
#include <cmath>

#include "render/trace/material/fresnel.h"

namespace sg::trace {

namespace {

// The index of refraction that reflects `weight` times as much at normal incidence; 1 below what can be told from it.
float weighted_ior(double ior, double weight) {
  const double r = (ior - 1) / (ior + 1), root = std::sqrt(weight) * r;
  const double eta = (1 + root) / (1 - root);
  return eta < 1.001 ? 1.f : float(eta);
}

AlbedoCurve lost_by(const BoundaryAlbedo& albedo) {
  return AlbedoCurve::of([&](float cosine) { return std::max(0.f, 1 - albedo.reflected(cosine) - albedo.passed(cosine)); });
}

// What enters through the coat less what Bsdf lets out again: reflected once by the metal, or several times within its roughness.
AlbedoCurve trapped_by_coat(const Ggx& ggx, const AlbedoCurve& mirror_lost, const AlbedoCurve& coat_albedo, float coat_open) {
  const AlbedoCurve passes = AlbedoCurve::of([&](float cosine) { return 1 - coat_albedo(cosine); });
  const AlbedoCurve once = mirror_albedo(ggx, passes);
  const float lost = mirror_lost.average();
  const float again = lost > 0 ? AlbedoCurve::of([&](float c) { return mirror_lost(c) * passes(c); }).average() / lost : 0;
  return AlbedoCurve::of([&](float cosine) {
    const float out = (once(cosine) + mirror_lost(cosine) * again) / coat_open;
    return passes(cosine) * std::max(0.f, 1 - out);
  });
}

}  // namespace

Material::Material(const SurfaceMaterial& m, double length, double around, bool varies) {
  check(m);
  priority_ = m.dielectric_priority;
  base_color_ = Vec3f(m.base_color), emission_ = Vec3f(m.emission), subsurface_radius_ = Vec3f(m.subsurface_radius * length);
  subsurface_anisotropy_ = float(m.subsurface_anisotropy), thin_ = m.thin_walled;
  shares = {float(m.coat_weight),
            float(m.retro_weight),
            float(m.base_metalness),
            float(m.transmission_weight),
            float(m.subsurface_weight),
            {1, 1, 1},
            {1, 1, 1}};
  const float coat = shares.coat, retro = shares.retro, metalness = shares.metalness, clear = shares.clear;
  has_boundary_ = varies || (metalness < 1 && retro < 1);
  for (int i = 0; i < 3; ++i) {
    shares.coat_filter[i] = float(std::sqrt(m.coat_color[i]));
    if (m.transmission_depth <= 0 || thin_) shares.clear_filter[i] = float(m.transmission_color[i]);
    else absorption_[i] = float(-std::log(std::max(m.transmission_color[i], 1e-10)) / (m.transmission_depth * length));
  }
  if (coat > 0) {
    coat_ggx = Ggx::of_roughness(float(m.coat_roughness)), coat_eta = float(m.coat_ior);
    coat_albedo = boundary_albedo(coat_ggx, coat_eta, false).reflected;
    coat_open = 1 - coat_albedo.least();
  }
  ggx = Ggx::of_roughness(float(m.specular_roughness), float(m.specular_anisotropy));
  if (metalness > 0 || retro > 0) mirror = mirror_albedo(ggx);
  mirror_lost = AlbedoCurve::of([&](float cosine) { return 1 - mirror.white(cosine); });
  if (coat > 0 && (metalness > 0 || retro > 0)) coat_traps = trapped_by_coat(ggx, mirror_lost, coat_albedo, coat_open);
  if (has_boundary_) {
    ior_ = weighted_ior(m.specular_ior, m.specular_weight);
    const float eta = ior_ / float(around);
    side[0].eta = std::abs(eta - 1) < 0.001f ? 1 : eta;
    side[1].eta = 1 / side[0].eta;
    for (int i = 0; i < (clear > 0 && !thin_ ? 2 : 1); ++i) {
      side[i].albedo = boundary_albedo(ggx, side[i].eta, thin_);
      side[i].lost = lost_by(side[i].albedo);
    }
    if (thin_) side[0].lost_passes = 0.5f, side[1] = side[0];
    // What is lost in uniform light: outside 1 per area and angle, inside n^2. As much of it has to pass in one way as in the other.
    const float from_outside = side[0].lost.average(), from_inside = side[0].eta * side[0].eta * side[1].lost.average();
    if (!thin_ && from_outside + from_inside > 0) {
      side[0].lost_passes = from_inside / (from_outside + from_inside);
      side[1].lost_passes = from_outside / (from_outside + from_inside);
    }
  }
  open_ = AlbedoCurve::of([&](float cosine) { return 1 - side[0].albedo.reflected(cosine); });
  under_coat_ = AlbedoCurve::of([&](float cosine) { return coat_albedo(cosine) * open_(cosine); });
  if (m.metal && (metalness > 0 || retro > 0)) {
    conductor = index_of(*m.metal);
    metal_curves = conductor_albedo(ggx, conductor->eta, conductor->k);
    const auto smooth = conductor_albedo(Ggx(), conductor->eta, conductor->k);
    for (int i = 0; i < 3; ++i) conductor_average_[i] = smooth[size_t(i)].average();
  }
}

Vec3f Material::metal_fresnel(float cosine, Vec3f base) const {
  if (!conductor) return fresnel_schlick(cosine, base);
  Vec3f f;
  for (int i = 0; i < 3; ++i) f[i] = fresnel_conductor(cosine, conductor->eta[i], conductor->k[i]);
  return f;
}

Vec3f Material::metal_average(Vec3f base) const {
  return conductor ? conductor_average_ : base + (Vec3f(1, 1, 1) - base) * (1.f / 21);  // integral of 2 c (1 - c)^5
}

Vec3f Material::metal_albedo(float cosine, Vec3f base) const {
  if (ggx.smooth()) return metal_fresnel(cosine, base);
  if (conductor) return {metal_curves[0](cosine), metal_curves[1](cosine), metal_curves[2](cosine)};
  const float grazing = mirror.grazing(cosine);
  return base * (mirror.white(cosine) - grazing) + Vec3f(grazing, grazing, grazing);
}

}  // namespace sg::trace
