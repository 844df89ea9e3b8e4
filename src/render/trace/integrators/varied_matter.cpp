// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/varied_matter.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "render/prepare/picture_set.h"
#include "render/trace/integrators/surface_color.h"

namespace sg::trace {

namespace {

// Which of the numbers that materials are prepared for its pictures multiply.
MaterialPalette::Varies varying_numbers(const raster::PreparedItem& item) {
  MaterialPalette::Varies varies{};
  if (item.pictures && item.made_of)
    for (const raster::PlacedFactors& f : item.pictures->factors)
      for (const FactorChannel& c : f.channels)
        if (size_t(c.factor) < MaterialPalette::numbers) varies[size_t(c.factor)] = true;
  return varies;
}

// What pictures multiply numbers of a material with at a point.
class Factors {
 public:
  Factors() { of_.fill({1, 1, 1}); }
  void multiply(MaterialFactor f, Vec3f by) { of_[size_t(f)] = of_[size_t(f)] * by; }
  const Vec3f& color(MaterialFactor f) const { return of_[size_t(f)]; }
  float operator[](MaterialFactor f) const { return of_[size_t(f)].x; }
  MaterialPalette::Shares prepared() const {
    MaterialPalette::Shares shares;
    for (size_t i = 0; i < shares.size(); ++i) shares[i] = of_[i].x;
    return shares;
  }

 private:
  std::array<Vec3f, material_factors> of_;
};

// A number for a point, as good as random.
uint32_t spot_of(const Hit& hit) {
  uint32_t n = hit.primitive;
  for (const float x : {hit.u, hit.v, hit.t}) n = (n ^ std::bit_cast<uint32_t>(x)) * 0x85ebca6bu, n ^= n >> 15;
  return n;
}

Vec3f root_of(Vec3f c) { return {std::sqrt(c.x), std::sqrt(c.y), std::sqrt(c.z)}; }

}  // namespace

std::unique_ptr<const MaterialPalette> palette_of(const raster::PreparedItem& item, double length, double around) {
  const MaterialPalette::Varies varies = varying_numbers(item);
  if (std::none_of(varies.begin(), varies.end(), [](bool v) { return v; })) return nullptr;
  return std::make_unique<const MaterialPalette>(*item.made_of, length, around, varies);
}

MaterialShares take_pictures(const raster::PreparedItem& item, const Ray& ray, const Hit& hit, const RayFootprint& footprint, double scale,
                             const MaterialPalette* palette, Vertex& v) {
  const raster::PictureSet& pictures = *item.pictures;
  Factors factors;
  for (const raster::PlacedFactors& f : pictures.factors) {
    const Vec4f t = surface_picture(f.picture, item, ray, hit, footprint, scale);
    if (!(t.w > 0)) continue;
    const auto share = [&](int channel) { return std::clamp(t[channel] / t.w, 0.f, 1.f); };
    for (const FactorChannel& c : f.channels)
      factors.multiply(c.factor, c.factor < MaterialFactor::transmission_color ? Vec3f(1, 1, 1) * share(c.channel)
                                                                               : Vec3f(share(0), share(1), share(2)));
  }
  if (palette) v.material = &palette->at(factors.prepared(), spot_of(hit));
  v.below_radius = v.below_radius * factors.color(MaterialFactor::subsurface_radius);
  v.below_anisotropy *= factors[MaterialFactor::subsurface_anisotropy];
  if (pictures.emission) {
    const Vec4f t = surface_picture(*pictures.emission, item, ray, hit, {}, scale);  // as the lights know it
    v.emission = v.emission * Vec3f{t.x, t.y, t.z};
  }
  if (pictures.normal) {
    const Vec3f bent = surface_normal(item, ray, hit, footprint, scale, v.point.shading_normal);
    // What looks away from a viewer who sees the face could not be seen.
    if ((dot(ray.direction, bent) < 0) == (dot(ray.direction, v.point.face_normal) < 0)) v.point.shading_normal = bent;
  }
  if (!pictures.stretched_along.empty())
    if (const Vec3f along = surface_direction(pictures, item, hit); dot(along, along) > 0) v.point.tangent = normalize(along);
  MaterialShares shares = v.material->shares;
  shares.coat *= factors[MaterialFactor::coat], shares.retro *= factors[MaterialFactor::retro];
  shares.metalness *= factors[MaterialFactor::metalness], shares.clear *= factors[MaterialFactor::transmission];
  shares.subsurface *= factors[MaterialFactor::subsurface];
  shares.coat_filter = shares.coat_filter * root_of(factors.color(MaterialFactor::coat_color));  // of one passage of two
  shares.clear_filter = shares.clear_filter * factors.color(MaterialFactor::transmission_color);
  return shares;
}

}  // namespace sg::trace
