// SPDX-License-Identifier: Apache-2.0
// Directions that light takes, drawn about in proportion to how much takes them.
#include <algorithm>
#include <cmath>

#include "render/trace/material/bsdf.h"
#include "render/trace/material/fresnel.h"
#include "render/trace/material/refraction.h"
#include "render/trace/sampling/unit_float.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

namespace {

float mean_of(Vec3f c) { return (c.x + c.y + c.z) / 3; }

Vec3f grey(float v) { return {v, v, v}; }

}  // namespace

bool Bsdf::is_delta(Way way) const {
  switch (way) {
    case straight: return true;
    case of_coat: return material_->coat_ggx.smooth();
    case of_metal:
    case of_retro: return material_->ggx.smooth();
    case of_boundary: return material_->boundary_smooth();
    default: return false;
  }
}

// Where the boundary lets light pass, how many of the samples that meet a mirror of this reflectance are reflected.
float Bsdf::reflect_chance(float reflectance) const {
  const float passed = share_.clear * mean_of(share_.clear_filter) * (1 - reflectance);
  return passed > 0 ? reflectance / (reflectance + passed) : 1;
}

Bsdf::Shares Bsdf::shares(float z, bool inside) const {
  const Material& m = *material_;
  const BoundarySide& side = m.side[inside];
  const float under_retro = 1 - share_.retro, metal = under_retro * share_.metalness, rest = under_retro * (1 - share_.metalness);
  Shares s{};
  // What gets through the coat on its way in, and on its average way out.
  Vec3f layers = grey(1);
  if (share_.coat > 0 && !inside) {
    s.albedo[of_coat] = grey(share_.coat * m.coat_albedo(z));
    layers = grey(1 - share_.coat) + through_coat(z) * share_.coat_filter * (share_.coat * (1 - m.coat_albedo.average()) / m.coat_open);
  }
  if (metal > 0 || (share_.retro > 0 && !inside)) {
    const Vec3f once = m.metal_albedo(z, base_);
    const Vec3f again = again_ * (m.ggx.smooth() ? 0 : m.mirror_lost(z));
    s.albedo[of_metal] = layers * once * metal, s.albedo[of_metal_again] = layers * again * metal;
    if (!inside) {
      const Vec3f trapped = share_.coat > 0 ? trapped_ * m.coat_traps(z) : Vec3f();
      s.albedo[of_metal_again] += trapped * metal;
      s.albedo[of_retro] = layers * once * share_.retro, s.albedo[of_retro_again] = (layers * again + trapped) * share_.retro;
    }
  }
  if (rest > 0) {
    const bool smooth = m.boundary_smooth();
    const float reflected = smooth ? reflectance(z, inside) : side.albedo.reflected(z),
                passed = smooth ? 1 - reflected : side.albedo.passed(z);
    s.albedo[of_boundary] = layers * (grey(reflected) + share_.clear_filter * (share_.clear * passed)) * rest;
    if (share_.clear > 0 && !smooth)
      s.albedo[of_boundary_again] =
          layers * (grey(1 - side.lost_passes) + share_.clear_filter * side.lost_passes) * (rest * share_.clear * side.lost(z));
    if (!inside) s.albedo[of_body] = base_ * share_.body_filter() * (rest * body_share() * m.open(z, share_.coat));
  }
  float sum = 0;
  for (Vec3f& a : s.albedo) a *= opacity_;
  s.albedo[straight] = grey(1 - opacity_);
  for (const Vec3f& a : s.albedo) sum += mean_of(a);
  if (sum > 0)
    for (size_t i = 0; i < ways; ++i) s.chance[i] = mean_of(s.albedo[i]) / sum;
  return s;
}

float Bsdf::pdf_facing(Vec3f o, Vec3f i, bool inside, const Shares& s) const {
  const Material& m = *material_;
  if (!(o.z > 0) || i.z == 0) return 0;
  const BoundarySide& side = m.side[inside];
  const float through = body_through(), z = std::abs(i.z);
  if (i.z > 0) {
    const Vec3f h = normalize(o + i);
    float pdf = z / pi *
                (s.chance[of_metal_again] + s.chance[of_retro_again] + s.chance[of_boundary_again] * (1 - side.lost_passes) +
                 s.chance[of_body] * (1 - through));
    // The density of the mirrors that are seen, by 4 cos: that of the directions they reflect to.
    if (!m.ggx.smooth()) {
      float chance = s.chance[of_metal];
      if (!is_delta(of_boundary) && s.chance[of_boundary] > 0)
        chance += s.chance[of_boundary] * reflect_chance(reflectance(dot(o, h), inside));
      if (chance > 0) pdf += chance * m.ggx.normals(h) * m.ggx.seen(o) / (4 * o.z);
      if (s.chance[of_retro] > 0) pdf += s.chance[of_retro] * m.ggx.normals(normalize(o + turned_back(i))) * m.ggx.seen(o) / (4 * o.z);
    }
    if (s.chance[of_coat] > 0 && !m.coat_ggx.smooth()) pdf += s.chance[of_coat] * m.coat_ggx.normals(h) * m.coat_ggx.seen(o) / (4 * o.z);
    return pdf;
  }
  float pdf = z / pi * (s.chance[of_boundary_again] * side.lost_passes + s.chance[of_body] * through);
  if (share_.clear == 0 || is_delta(of_boundary) || s.chance[of_boundary] == 0) return pdf;
  if (m.thin()) {
    const Vec3f h = normalize(o + Vec3f(i.x, i.y, z));
    pdf += s.chance[of_boundary] * (1 - reflect_chance(reflectance(dot(o, h), false))) * m.ggx.normals(h) * m.ggx.seen(o) / (4 * o.z);
  } else if (const auto r = Refraction::between(o, i, side.eta)) {
    pdf += s.chance[of_boundary] * (1 - reflect_chance(reflectance(r->cosine_o, inside))) * m.ggx.visible_pdf(o, r->m) * r->spread;
  }
  return pdf;
}

float Bsdf::pdf(const Outgoing& wo, Vec3f wi) const { return pdf_facing(wo.o, {wi.x, wi.y, wi.z * wo.turn}, wo.inside, wo.shares); }

std::optional<BsdfSample> Bsdf::sample_delta(Way way, Vec3f o, bool inside, float chance, float choice, Transport transport) const {
  const Material& m = *material_;
  if (way == straight) return BsdfSample{grey((1 - opacity_) / chance), -o, chance, true, true};
  const float under_retro = 1 - share_.retro;
  const Vec3f mirrored = turned_back(o);
  BsdfSample s{{}, mirrored, chance, true};
  if (way == of_coat) s.weight = grey(share_.coat * fresnel_dielectric(o.z, m.coat_eta).reflected());
  if (way == of_metal) s.weight = m.metal_fresnel(o.z, base_) * through_coat(o, mirrored, inside) * (under_retro * share_.metalness);
  if (way == of_retro) s.direction = o, s.weight = m.metal_fresnel(o.z, base_) * through_coat(o, o, inside) * share_.retro;
  if (way == of_boundary) {
    const float r = reflectance(o.z, inside), reflects = reflect_chance(r), rest = under_retro * (1 - share_.metalness),
                eta = m.side[inside].eta;
    if (choice < reflects) {
      s.weight = through_coat(o, mirrored, inside) * (rest * r), s.pdf *= reflects;
    } else {
      s.transmitted = true, s.crossed = !m.thin(), s.pdf *= 1 - reflects;
      if (m.thin()) s.direction = -o;
      else s.direction = refracted(o, {0, 0, 1}, eta, fresnel_dielectric(o.z, eta).cosine_through), s.eta = eta;
      const float scale = transport == Transport::radiance && !m.thin() ? 1 / (eta * eta) : 1;
      s.weight = share_.clear_filter * through_coat(o, s.direction, inside) * (rest * share_.clear * (1 - r) * scale);
    }
  }
  s.weight *= opacity_ / s.pdf;
  return s;
}

std::optional<Vec3f> Bsdf::sample_direction(Way way, Vec3f o, bool inside, float choice, Vec2f u) const {
  const Material& m = *material_;
  const BoundarySide& side = m.side[inside];
  Vec3f i = cosine_hemisphere(u);
  switch (way) {
    case of_coat:
    case of_metal: i = reflected(o, (way == of_coat ? m.coat_ggx : m.ggx).visible(o, u)); break;
    case of_retro: i = turned_back(reflected(o, m.ggx.visible(o, u))); break;
    case of_boundary: {
      const Vec3f normal = m.ggx.visible(o, u);
      const float cosine = dot(o, normal);
      const bool passes = choice >= reflect_chance(reflectance(cosine, inside));
      if (passes && !m.thin()) {
        i = refracted(o, normal, side.eta, fresnel_dielectric(std::min(cosine, 1.f), side.eta).cosine_through);
        if (i.z < 0) return i;
        return std::nullopt;
      }
      i = reflected(o, normal);
      if (i.z <= 0) return std::nullopt;
      if (passes) i.z = -i.z;
      return i;
    }
    case of_boundary_again:
      if (choice < side.lost_passes) i.z = -i.z;
      return i;
    case of_body:
      if (choice < body_through()) i.z = -i.z;
      return i;
    default: break;
  }
  if (i.z > 0) return i;
  return std::nullopt;
}

std::optional<BsdfSample> Bsdf::sample(const Outgoing& wo, float choice, Vec2f u, Transport transport) const {
  const Vec3f o = wo.o;
  const bool inside = wo.inside;
  const Shares& s = wo.shares;
  if (!(o.z > 0)) return std::nullopt;
  // The way, and where in its share `choice` lies.
  size_t way = ways;
  for (size_t k = 0; k < ways; ++k) {
    if (s.chance[k] <= 0) continue;
    way = k;
    if (choice < s.chance[k]) break;
    choice -= s.chance[k];
  }
  if (way == ways) return std::nullopt;
  choice = below_one(std::min(1.0, double(choice) / double(s.chance[way])));
  std::optional<BsdfSample> drawn;
  if (is_delta(Way(way))) {
    drawn = sample_delta(Way(way), o, inside, s.chance[way], choice, transport);
  } else if (const std::optional<Vec3f> i = sample_direction(Way(way), o, inside, choice, u)) {
    const float pdf = pdf_facing(o, *i, inside, s);
    if (!(pdf > 0)) return std::nullopt;
    drawn = BsdfSample{evaluate_facing(o, *i, inside, transport) * (std::abs(i->z) / pdf), *i, pdf};
    drawn->transmitted = i->z < 0, drawn->crossed = drawn->transmitted && !material_->thin();
    if (drawn->crossed) drawn->eta = material_->side[inside].eta;
  }
  if (drawn) drawn->direction.z *= wo.turn;
  return drawn;
}

bool Bsdf::delta_only() const {
  if (opacity_ == 0) return true;
  const Material& m = *material_;
  const float under_retro = 1 - share_.retro, rest = under_retro * (1 - share_.metalness);
  const bool mirrors = share_.metalness * under_retro > 0 || share_.retro > 0, body = rest * body_share() > 0;
  const bool boundary = rest > 0 && (m.side[0].eta != 1 || share_.clear > 0);
  return !body && !(share_.coat > 0 && (mirrors || !m.coat_ggx.smooth())) && !(mirrors && !m.ggx.smooth()) &&
         !(boundary && !m.boundary_smooth());
}

}  // namespace sg::trace
