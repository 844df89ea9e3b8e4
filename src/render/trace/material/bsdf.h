// SPDX-License-Identifier: Apache-2.0
// How a point of a surface scatters light: f(wo, wi) of two unit directions that point away from it, in the local frame with z along the
// shading normal, on the side of which the outside is. Sheets and opaque surfaces are alike from both sides.
//
// Every kind keeps energy: of uniform light no more comes back than arrives, and all of it where nothing absorbs. Light that a rough
// boundary loses after one reflection is given back (Kulla, Conty 2017), a diffuse body gets what its boundary lets through. Reciprocal:
// f(wo, wi) = f(wi, wo); of radiance across a boundary f(wo, wi) eta(wi)^2 = f(wi, wo) eta(wo)^2.
#pragma once
#include <array>
#include <optional>

#include "base/vec.h"
#include "render/trace/material/material.h"

namespace sg::trace {

/// What travels along wi towards the point: radiance, where paths begin at the camera, or importance, where they begin at a light. Across a
/// boundary they differ by a factor of eta^2, as radiance is compressed in the denser matter.
enum class Transport { radiance, importance };

struct BsdfSample {
  Vec3f weight;              ///< f |cos| / pdf
  Vec3f direction;           ///< wi
  float pdf = 0;             ///< per solid angle, of all ways to this direction together; of a delta the chance that it is chosen
  bool delta = false;        ///< one direction alone, which evaluate() and pdf() know nothing of
  bool transmitted = false;  ///< to the other side
  bool crossed = false;      ///< into a body, or out of it: not where the surface is not, by its opacity
  float eta = 1;             ///< index of refraction beyond, by that on this side, if a boundary was crossed; of sheets 1
};

class Bsdf {
  // Ways that light takes; each has a share of the samples.
  enum Way { straight, of_coat, of_metal, of_metal_again, of_boundary, of_boundary_again, of_body, of_retro, of_retro_again, ways };
  struct Shares {
    std::array<Vec3f, ways> albedo;
    std::array<float, ways> chance;  // all 0 where nothing is reflected
  };

 public:
  /// A direction wo, and what all that asks about it has in common.
  class Outgoing {
    friend class Bsdf;
    Vec3f o;  // on the side where z > 0: wo, or its mirror image by `turn`
    float turn = 1;
    bool inside = false;
    Shares shares;
  };
  Outgoing outgoing(Vec3f wo) const;

  /// f per solid angle, without the cosine and without deltas; 0 for directions in the surface.
  Vec3f evaluate(Vec3f wo, Vec3f wi, Transport transport = Transport::radiance) const;
  /// Density with which sample() draws wi for wo, without deltas. Its integral is less than 1 by the chances of deltas and by that of no
  /// sample, which is at most what single reflections at the rough boundary lose.
  float pdf(const Outgoing& wo, Vec3f wi) const;
  float pdf(Vec3f wo, Vec3f wi) const { return pdf(outgoing(wo), wi); }
  /// Nothing where the drawn microscopic mirror sends the light into the surface, or nothing is reflected at all. `choice`, u: uniform in
  /// [0, 1).
  std::optional<BsdfSample> sample(const Outgoing& wo, float choice, Vec2f u, Transport transport = Transport::radiance) const;
  std::optional<BsdfSample> sample(Vec3f wo, float choice, Vec2f u, Transport transport = Transport::radiance) const {
    return sample(outgoing(wo), choice, u, transport);
  }
  /// About the share of uniform light that goes out along wo, straight passage included; exact where surfaces are not translucent and
  /// have no coat.
  Vec3f albedo(const Outgoing& wo) const;
  Vec3f albedo(Vec3f wo) const { return albedo(outgoing(wo)); }
  bool delta_only() const;
  /// What passes straight on, as through nothing: by opacity, a smooth sheet of glass, clear matter that does not refract. These are those
  /// deltas of sample() that go on along -wo with eta 1.
  Vec3f straight_on(Vec3f wo) const;
  /// Of the part in which light wanders below the surface, where the Bsdf was made for that: the weight with which light that arrives along
  /// wo goes in, and the one, relative to a density of cos / pi, with which it comes out along wi. White bodies without a coat keep all
  /// energy.
  Vec3f entering(Vec3f wo) const;
  Vec3f base_color() const { return base_; }  ///< of which matter below the surface is
  const MaterialShares& material_shares() const { return share_; }
  float leaving(Vec3f wi) const;

 private:
  friend Bsdf make_bsdf(const Material&, const MaterialShares&, Vec3f, float, bool);
  // Of directions in a frame in which o.z > 0.
  Shares shares(float z, bool inside) const;
  Vec3f evaluate_facing(Vec3f o, Vec3f i, bool inside, Transport transport) const;
  Vec3f reflected_facing(Vec3f o, Vec3f i, bool inside) const;
  Vec3f passed_facing(Vec3f o, Vec3f i, bool inside, Transport transport) const;
  float pdf_facing(Vec3f o, Vec3f i, bool inside, const Shares& shares) const;
  std::optional<Vec3f> sample_direction(Way way, Vec3f o, bool inside, float choice, Vec2f u) const;
  std::optional<BsdfSample> sample_delta(Way way, Vec3f o, bool inside, float chance, float choice, Transport transport) const;
  Vec3f through_coat(float z) const;
  Vec3f through_coat(Vec3f o, Vec3f i, bool inside) const;
  float reflectance(float cosine, bool inside) const;
  float reflect_chance(float reflectance) const;
  float body_share() const;
  float body_through() const;
  Vec3f body(float z_o, float z_i) const;
  bool is_delta(Way way) const;
  bool inside_of(Vec3f w) const { return w.z < 0 && material_->has_inside(); }

  const Material* material_ = nullptr;
  MaterialShares share_;
  Vec3f base_;
  Vec3f again_;    // what metal of this colour reflects twice or more (multiple_mirrors)
  Vec3f trapped_;  // what it and the coat leave of light that goes to and fro between them
  float opacity_ = 1;
  bool walks_ = false;
};

/// At a point whose base colour is `base_color` (clamped to 0 to 1), on a surface that covers `opacity` of it: the rest passes straight on.
/// With `walks` the subsurface share is left to the integrator (Bsdf::entering), else it is diffuse. `shares`: none above the material's.
/// The material must outlive it.
Bsdf make_bsdf(const Material& material, const MaterialShares& shares, Vec3f base_color, float opacity = 1, bool walks = false);
inline Bsdf make_bsdf(const Material& material, Vec3f base_color, float opacity = 1, bool walks = false) {
  return make_bsdf(material, material.shares, base_color, opacity, walks);
}
inline Bsdf make_bsdf(const Material& material) { return make_bsdf(material, material.base_color()); }

}  // namespace sg::trace
