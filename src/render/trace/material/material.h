// SPDX-License-Identifier: Apache-2.0
// A material with all that does not depend on the point of the surface: made once, read by the Bsdf of each point.
#pragma once
#include <array>
#include <optional>

#include "render/trace/material/albedo.h"
#include "render/trace/material/ggx.h"
#include "scene/items/surface_material.h"

namespace sg::trace {

/// How much of a surface is what, each a share of what those before leave, and what filters light there: of a material, or lowered at a
/// point by pictures.
struct MaterialShares {
  float coat = 0, retro = 0, metalness = 0, clear = 0, subsurface = 0;
  Vec3f coat_filter{1, 1, 1};   ///< of one passage through the coat
  Vec3f clear_filter{1, 1, 1};  ///< of one through the boundary of clear matter

  /// Of the way through the coat, where there is one, and back.
  Vec3f body_filter() const { return Vec3f(1, 1, 1) * (1 - coat) + coat_filter * coat_filter * coat; }
};

/// One side of the boundary between outside and body.
struct BoundarySide {
  float eta = 1;          ///< index of refraction beyond, by that on this side
  BoundaryAlbedo albedo;  ///< of single reflections and refractions
  AlbedoCurve lost;       ///< what these lose: light that meets the boundary again
  float lost_passes = 0;  ///< the share of it that comes out on the other side; the same in both ways, by reciprocity
};

class Material {
 public:
  /// Some ten milliseconds: albedos of rough boundaries are integrated. Throws Error(usage) for values out of range (check()).
  /// `length`: of a length of the description, in those of rays. `around`: index of refraction of what a clear body is in. `varies`: the
  /// shares are lower at some points, so that what they leave nothing of is prepared, too.
  explicit Material(const SurfaceMaterial& described, double length = 1, double around = 1, bool varies = false);

  Vec3f base_color() const { return base_color_; }
  Vec3f emission() const { return emission_; }
  bool emits() const { return emission_ != Vec3f(); }
  bool thin() const { return thin_; }
  /// Whether rays go on inside: a body behind the surface, with an index of refraction and absorption of its own.
  bool has_inside() const { return shares.clear > 0 && has_boundary_ && !thin_; }
  float ior() const { return ior_; }
  /// Of clear bodies that overlap; 0: none (insides.h).
  int priority() const { return priority_; }
  /// Per length inside the clear body: light fades by exp(-absorption length).
  Vec3f absorption() const { return absorption_; }
  /// Mean free paths, share and mean cosine of scattering below the surface (subsurface.h).
  Vec3f subsurface_radius() const { return subsurface_radius_; }
  float subsurface_anisotropy() const { return subsurface_anisotropy_; }

  // For Bsdf:
  MaterialShares shares;
  // Of the coat, seen from outside:
  Ggx coat_ggx;
  float coat_eta = 1;
  AlbedoCurve coat_albedo;
  AlbedoCurve coat_traps;  ///< of light that metal which reflects everything sends to the coat, what is thrown back on it again
  float coat_open = 1;     ///< what it lets through at most, of any angle
  // Of the boundary below it, metal and retroreflectors, which have the same roughness:
  Ggx ggx;
  BoundarySide side[2];     ///< seen from outside and from inside; of thin walls and opaque bodies the first alone
  MirrorAlbedo mirror;      ///< of metal that reflects everything, single reflections
  AlbedoCurve mirror_lost;  ///< 1 - mirror.white
  // Of the diffuse body, under both, where the coat has the share `coat`:
  /// What gets there, and from there out again; its mean over uniform light.
  float open(float cosine, float coat) const { return open_(cosine) - (coat > 0 ? coat * under_coat_(cosine) : 0); }
  float open_average(float coat) const { return open_.average() - coat * under_coat_.average(); }
  std::optional<ConductorIndex> conductor;
  std::array<AlbedoCurve, 3> metal_curves;  ///< of its single reflections, red, green and blue

  /// Without roughness, or without a boundary at all.
  bool boundary_smooth() const { return ggx.smooth() || side[0].eta == 1; }
  /// Whether something goes through as if nothing was there: a smooth sheet, matter that does not refract.
  bool passes_straight() const { return shares.clear > 0 && boundary_smooth() && (thin_ || side[0].eta == 1); }
  /// What metal reflects at a microscopic mirror, and on average over all directions, if its colour at normal incidence is `base`.
  Vec3f metal_fresnel(float cosine, Vec3f base) const;
  Vec3f metal_average(Vec3f base) const;
  /// What metal reflects of single reflections, for light from a cosine.
  Vec3f metal_albedo(float cosine, Vec3f base) const;

 private:
  Vec3f base_color_, emission_, absorption_, subsurface_radius_;
  float subsurface_anisotropy_ = 0, ior_ = 1;
  int priority_ = 0;
  bool thin_ = false, has_boundary_ = false;
  AlbedoCurve open_, under_coat_;  // without a coat; what one takes of it
  Vec3f conductor_average_;
};

}  // namespace sg::trace
