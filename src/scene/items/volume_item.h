// SPDX-License-Identifier: Apache-2.0
// VolumeItem: a scalar field that is seen through, and everything that decides how.
#pragma once
#include <string>
#include <vector>

#include "base/schema/enum_words.h"
#include "color/color_scale.h"
#include "color/transfer_function.h"
#include "data/dataset.h"
#include "scene/items/material.h"
#include "scene/items/ray_function.h"

namespace sg {

class Schema;

/// The algorithm that draws it. `ray` is the reference; the others are there to compare (docs/volume_methods.md).
enum class VolumeMethod { ray, splat, slices, cells, shear_warp, fourier };
constexpr auto enum_words(VolumeMethod) {
  using enum VolumeMethod;
  return std::array{Word{"ray", ray},     Word{"splat", splat},           Word{"slices", slices},
                    Word{"cells", cells}, Word{"shear_warp", shear_warp}, Word{"fourier", fourier}};
}

/// How finely a ray looks.
struct VolumeSampling {
  double tolerance = 1.0 / 512;      ///< of full scale: largest error of a pixel that the integral may have
  double step = 0;                   ///< world length of fixed steps; 0 = by the tolerance
  std::string classify = "post";     ///< with steps: pre, post, integrated or table
  bool jitter = false;               ///< with steps: the first sample anywhere in the first step
  std::string kernel = "linear";     ///< nearest, linear, catmull_rom, mitchell, bspline, bspline_smooth, gaussian, sinc
  std::string gradient = "central";  ///< central, sobel, intermediate, analytic
  std::string antialias = "none";    ///< none, split (rays divide where cells are smaller than a pixel) or mip (means of such cells)
};
void describe(Schema& s, VolumeSampling& p);

/// Light in the volume.
struct VolumeLight {
  double ambient = 0.12, diffuse = 0.88, specular = 0.18, power = 32;  ///< Blinn-Phong terms in linear light
  double shadows = 0;          ///< 0 none, 1 full: share of the light that the volume itself takes away (single scattering)
  double occlusion = 0;        ///< 0 none, 1 full: share of the ambient light that near matter takes away
  double depth_cue = 0;        ///< 0 none, 1: the far end of the volume fades into the background
  std::string style = "none";  ///< none, silhouette, tone or hatch
  double ink = 0;              ///< opacity per unit length that silhouettes and strokes have of their own, where nothing else is drawn too
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
  VolumeSampling sampling;
  VolumeLight light;
  std::vector<ClipPlane> clip;
  uint32_t group = 0;  ///< items of the same one (not 0) are parts of one volume: a ray's maximum, first hit, ... is that of all of them
};

}  // namespace sg
