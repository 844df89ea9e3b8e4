// SPDX-License-Identifier: Apache-2.0
// VolumeItem: a scalar field that is seen through, and everything that decides how.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/schema/enum_words.h"
#include "color/color_scale.h"
#include "color/transfer_function.h"
#include "data/dataset.h"
#include "filter/field/sampling/reconstruction.h"
#include "scene/items/material.h"
#include "scene/items/ray_function.h"
#include "scene/items/surface_material.h"
#include "scene/items/surface_pictures.h"
#include "scene/items/volume_scattering.h"

namespace sg {

class Schema;

/// The algorithm that draws it. `ray` is the reference; the others are there to compare (docs/volume_methods.md).
enum class VolumeMethod { ray, splat, slices, cells, shear_warp, fourier };
constexpr auto enum_words(VolumeMethod) {
  using enum VolumeMethod;
  return std::array{Word{"ray", ray},     Word{"splat", splat},           Word{"slices", slices},
                    Word{"cells", cells}, Word{"shear_warp", shear_warp}, Word{"fourier", fourier}};
}

/// With fixed steps: how samples become colours.
enum class VolumeClassify {
  post,        ///< the colour of the interpolated value
  pre,         ///< interpolated colours of the samples around
  integrated,  ///< the integral over the step, by the values at its ends
  table,       ///< the same from a table by both values and the length
};
constexpr auto enum_words(VolumeClassify) {
  using enum VolumeClassify;
  return std::array{Word{"post", post}, Word{"pre", pre}, Word{"integrated", integrated}, Word{"table", table}};
}

/// How gradients of a lattice are estimated. All are products of three rows of weights on the samples.
enum class GradientKind : uint8_t {
  central,       ///< half the difference of the field one sample further and one before
  sobel,         ///< the same, averaged by 1 2 1 across each other axis (Sobel 1968 in 3x3x3; Zucker and Hummel 1981 weight otherwise)
  intermediate,  ///< the difference of the field half a sample further and half before (Bentum, Lichtenbelt, Malzbender 1996)
  analytic,      ///< the derivative of the kernel: that of the very field that is drawn
};
constexpr auto enum_words(GradientKind) {
  using enum GradientKind;
  return std::array{Word{"central", central}, Word{"sobel", sobel}, Word{"intermediate", intermediate}, Word{"analytic", analytic}};
}

/// What is done where cells are smaller than a pixel.
enum class VolumeAntialias {
  none,
  split,  ///< rays divide
  mip,    ///< means of such cells
};
constexpr auto enum_words(VolumeAntialias) {
  using enum VolumeAntialias;
  return std::array{Word{"none", none}, Word{"split", split}, Word{"mip", mip}};
}

/// Illustrative pictures.
enum class LightStyle { none, silhouette, tone, hatch };
constexpr auto enum_words(LightStyle) {
  using enum LightStyle;
  return std::array{Word{"none", none}, Word{"silhouette", silhouette}, Word{"tone", tone}, Word{"hatch", hatch}};
}

/// How finely a ray looks.
struct VolumeSampling {
  std::optional<double> tolerance;                 ///< of full scale: largest error of a pixel that the integral may have
  double step = 0;                                 ///< world length of fixed steps; 0 = by the tolerance
  VolumeClassify classify = VolumeClassify::post;  ///< with steps
  bool jitter = false;                             ///< with steps: the first sample anywhere in the first step
  Kernel kernel = Kernel::linear;                  ///< what the field is between its samples
  GradientKind gradient = GradientKind::central;
  VolumeAntialias antialias = VolumeAntialias::none;

  static constexpr double usual_tolerance = 1.0 / 512;
  double within() const { return tolerance.value_or(usual_tolerance); }
};
void describe(Schema& s, VolumeSampling& p);

/// Light in the volume.
struct VolumeLight {
  double ambient = 0.12, diffuse = 0.88, specular = 0.18, power = 32;  ///< Blinn-Phong terms in linear light
  double shadows = 0;    ///< 0 none, 1 full: share of the light that the volume itself takes away (single scattering)
  double occlusion = 0;  ///< 0 none, 1 full: share of the ambient light that near matter takes away
  double depth_cue = 0;  ///< 0 none, 1: the far end of the volume fades into the background
  LightStyle style = LightStyle::none;
  double ink = 0;  ///< opacity per unit length that silhouettes and strokes have of their own, where nothing else is drawn too
};
void describe(Schema& s, VolumeLight& p);
inline Material material_of(const VolumeLight& l, bool lit = true) {
  return {float(l.ambient), float(l.diffuse), float(l.specular), float(l.power), lit};
}

/// The side of a plane that is drawn: dot(normal, x) <= offset.
struct ClipPlane {
  Vec3 normal;
  double offset = 0;
};

/// A scalar field of any mesh, seen through.
struct VolumeItem {
  using Mode = RayFunction;
  DatasetPtr data;
  std::string field;
  Association association = Association::point;
  int component = -1;
  ColorScale color;
  OpacityCurve opacity;      ///< over values
  double unit_distance = 0;  ///< length to which opacity refers; 0 = 1/100 of the diagonal of the bounds
  TransferDetail detail;     ///< what opacity and colour depend on besides the value
  VolumeMethod method = VolumeMethod::ray;
  RayFunction mode = RayFunction::composite;
  std::vector<double> levels;  ///< of first_hit, distance, accumulate (one) and isosurface
  bool shaded = true;
  std::optional<SurfaceMaterial> made_of;           ///< of mode isosurface, for integrators; empty = plastic of its colours
  std::shared_ptr<const SurfacePictures> pictures;  ///< of mode isosurface, for integrators; null: none
  VolumeSampling sampling;
  VolumeLight light;
  VolumeScattering scattering;
  std::vector<ClipPlane> clip;
  uint32_t group = 0;  ///< items of the same one (not 0) are parts of one volume: a ray's maximum, first hit, ... is that of all of them
};

}  // namespace sg
