// SPDX-License-Identifier: Apache-2.0
// What goes out along wo of light that arrives along wi. How directions are drawn: bsdf_sample.cpp.
#include "render/trace/material/bsdf.h"

#include <algorithm>
#include <cmath>

#include "render/trace/material/fresnel.h"
#include "render/trace/material/refraction.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

namespace {

constexpr Vec3f white{1, 1, 1};

Vec3f clamped(Vec3f c) { return {std::clamp(c.x, 0.f, 1.f), std::clamp(c.y, 0.f, 1.f), std::clamp(c.z, 0.f, 1.f)}; }

// Light that is lost by what it meets first, or gets through it, and comes out again in all directions: reciprocal, and as much as it is.
float given_back(float of_o, float of_i, float average) { return average > 1e-6f ? of_o * of_i / (pi * average) : 0; }
float given_back(const AlbedoCurve& of_o, float o, const AlbedoCurve& of_i, float i) {
  return given_back(of_o(o), of_i(i), of_i.average());
}

}  // namespace

Bsdf make_bsdf(const Material& material, const MaterialShares& shares, Vec3f base_color, float opacity, bool walks) {
  Bsdf b;
  b.material_ = &material, b.share_ = shares;
  b.base_ = clamped(base_color), b.opacity_ = std::clamp(opacity, 0.f, 1.f), b.walks_ = walks && !material.thin();
  if (shares.metalness > 0 || shares.retro > 0) {
    const Vec3f once = material.metal_average(b.base_), through = shares.coat_filter * once;
    b.again_ = multiple_mirrors(once, material.mirror.white.average());
    b.trapped_ = through * through * shares.coat;
  }
  return b;
}

Vec3f Bsdf::through_coat(float z) const { return share_.coat_filter * (1 - material_->coat_albedo(z)); }

// Of both directions, those of them that are outside.
Vec3f Bsdf::through_coat(Vec3f o, Vec3f i, bool inside) const {
  const float coat = share_.coat;
  if (coat == 0) return white;
  const bool o_outside = !inside, i_outside = material_->thin() || (i.z > 0) == o_outside;
  const Vec3f passed = (o_outside ? through_coat(o.z) : white) * (i_outside ? through_coat(std::abs(i.z)) : white);
  // What is sent back from below the coat to what is below it, and comes out later: as much as leaves it to the angle that lets most
  // through.
  return white * (1 - coat) + passed * (o_outside && i_outside ? coat / material_->coat_open : coat);
}

float Bsdf::reflectance(float cosine, bool inside) const {
  const float r = fresnel_dielectric(std::min(cosine, 1.f), material_->side[inside].eta).reflected();
  return material_->thin() ? sheet_reflectance(r) : r;
}

// Of what enters the body, that which is diffuse.
float Bsdf::body_share() const { return (1 - share_.clear) * (walks_ ? 1 - share_.subsurface : 1); }

// What is diffuse of sheets, and comes out on the other side.
float Bsdf::body_through() const { return material_->thin() ? share_.subsurface / 2 : 0; }

Vec3f Bsdf::body(float z_o, float z_i) const {
  const Material& m = *material_;
  const float coat = share_.coat, under = (1 - share_.retro) * (1 - share_.metalness) * body_share();
  return base_ * share_.body_filter() * (under * given_back(m.open(z_o, coat), m.open(z_i, coat), m.open_average(coat)));
}

Vec3f Bsdf::reflected_facing(Vec3f o, Vec3f i, bool inside) const {
  const Material& m = *material_;
  const BoundarySide& side = m.side[inside];
  const Vec3f h = normalize(o + i);
  const float cosine = dot(o, h), under_retro = 1 - share_.retro, metal = under_retro * share_.metalness,
              rest = under_retro * (1 - share_.metalness);
  Vec3f f;
  if (!m.ggx.smooth()) {
    const float mirrors = m.ggx.normals(h) * m.ggx.seen(o, i) / (4 * o.z * i.z);
    if (metal > 0) {
      f += m.metal_fresnel(cosine, base_) * (metal * mirrors);
      f += again_ * (metal * given_back(m.mirror_lost, o.z, m.mirror_lost, i.z));
    }
    if (rest > 0 && !m.boundary_smooth()) {
      const float again = share_.clear * (1 - side.lost_passes) * given_back(side.lost, o.z, side.lost, i.z);
      f += white * (rest * (reflectance(cosine, inside) * mirrors + again));
    }
  }
  f = f * through_coat(o, i, inside);
  if (!inside && rest > 0 && body_share() > 0) f += body(o.z, i.z) * (1 - body_through());
  if (inside) return f;
  if (share_.retro > 0 && !m.ggx.smooth()) {
    const Vec3f back = normalize(o + turned_back(i));
    const float mirrors = m.ggx.normals(back) * m.ggx.seen(o, i) / (4 * o.z * i.z);
    const Vec3f again = again_ * given_back(m.mirror_lost, o.z, m.mirror_lost, i.z);
    f += (m.metal_fresnel(dot(o, back), base_) * mirrors + again) * through_coat(o, i, false) * share_.retro;
  }
  if (share_.coat > 0) f += trapped_ * ((metal + share_.retro) * given_back(m.coat_traps, o.z, m.coat_traps, i.z));
  if (share_.coat > 0 && !m.coat_ggx.smooth()) {
    const float r = fresnel_dielectric(std::min(cosine, 1.f), m.coat_eta).reflected();
    f += white * (share_.coat * r * m.coat_ggx.normals(h) * m.coat_ggx.seen(o, i) / (4 * o.z * i.z));
  }
  return f;
}

Vec3f Bsdf::passed_facing(Vec3f o, Vec3f i, bool inside, Transport transport) const {
  const Material& m = *material_;
  const float rest = (1 - share_.retro) * (1 - share_.metalness), z = -i.z;
  if (rest == 0 || (!m.thin() && !m.has_inside())) return {};
  const BoundarySide &side = m.side[inside], &other = m.side[!inside];
  Vec3f f;
  if (share_.clear > 0 && !m.boundary_smooth()) {
    float passed = share_.clear * side.lost_passes * given_back(side.lost, o.z, other.lost, z);
    if (m.thin()) {
      const Vec3f to(i.x, i.y, z), h = normalize(o + to);
      passed += share_.clear * (1 - reflectance(dot(o, h), false)) * m.ggx.normals(h) * m.ggx.seen(o, to) / (4 * o.z * z);
    } else {
      if (const auto r = Refraction::between(o, i, side.eta))
        passed += share_.clear * (1 - reflectance(r->cosine_o, inside)) * m.ggx.normals(r->m) * m.ggx.seen(o, i) * r->cosine_o * r->spread /
                  (o.z * z);
      if (transport == Transport::radiance) passed /= side.eta * side.eta;
    }
    f += share_.clear_filter * (rest * passed);
  }
  f = f * through_coat(o, i, inside);
  if (body_through() > 0) f += body(o.z, z) * body_through();
  return f;
}

Vec3f Bsdf::evaluate_facing(Vec3f o, Vec3f i, bool inside, Transport transport) const {
  if (!(o.z > 0) || i.z == 0) return {};
  return (i.z > 0 ? reflected_facing(o, i, inside) : passed_facing(o, i, inside, transport)) * opacity_;
}

Vec3f Bsdf::evaluate(Vec3f wo, Vec3f wi, Transport transport) const {
  const float turn = wo.z < 0 ? -1.f : 1.f;
  return evaluate_facing({wo.x, wo.y, wo.z * turn}, {wi.x, wi.y, wi.z * turn}, inside_of(wo), transport);
}

Bsdf::Outgoing Bsdf::outgoing(Vec3f wo) const {
  Outgoing out;
  out.turn = wo.z < 0 ? -1.f : 1.f, out.inside = inside_of(wo), out.o = {wo.x, wo.y, wo.z * out.turn};
  out.shares = shares(out.o.z, out.inside);
  return out;
}

Vec3f Bsdf::albedo(const Outgoing& wo) const {
  Vec3f sum;
  for (const Vec3f a : wo.shares.albedo) sum += a;
  return sum;
}

Vec3f Bsdf::straight_on(Vec3f wo) const {
  const Material& m = *material_;
  const Vec3f o(wo.x, wo.y, std::abs(wo.z));
  const bool inside = inside_of(wo);
  Vec3f through = white * (1 - opacity_);
  if (m.passes_straight() && o.z > 0)
    through += share_.clear_filter * through_coat(o, -o, inside) *
               (opacity_ * (1 - share_.retro) * (1 - share_.metalness) * share_.clear * (1 - reflectance(o.z, inside)));
  return through;
}

Vec3f Bsdf::entering(Vec3f wo) const {
  const Material& m = *material_;
  if (!walks_ || inside_of(wo)) return {};
  return share_.body_filter() * ((1 - share_.retro) * (1 - share_.metalness) * (1 - share_.clear) * share_.subsurface * opacity_ *
                                 m.open(std::abs(wo.z), share_.coat));
}

float Bsdf::leaving(Vec3f wi) const { return material_->open(std::abs(wi.z), share_.coat) / material_->open_average(share_.coat); }

}  // namespace sg::trace
