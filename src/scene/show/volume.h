// SPDX-License-Identifier: Apache-2.0
// A scalar field of any mesh, seen through.
#pragma once
#include "color/legend_content.h"
#include "scene/choose/coloring.h"
#include "scene/scene.h"
#include "scene/show/material_words.h"
#include "scene/show/picture.h"
#include "scene/show/varying_material.h"

namespace sg {

/// What decides on opacity where none is stated. Besides these words `transfer` takes a FILE.yaml: pipelines put its words in its place.
enum class TransferChoice { automatic, histogram, boundaries };
constexpr auto enum_words(TransferChoice) {
  using enum TransferChoice;
  return std::array{Word{"auto", automatic}, Word{"histogram", histogram}, Word{"boundaries", boundaries}};
}

/// Those of the words of `second`; any other is the name of a field.
constexpr auto enum_words(SecondAxis) {
  using enum SecondAxis;
  return std::array{Word{"none", none}, Word{"gradient", gradient}, Word{"second_derivative", second_derivative},
                    Word{"curvature", curvature}};
}

struct VolumeShow {
  ColoringParams coloring;
  std::string preset, transfer = "auto", save;
  std::optional<std::string> opacity;
  std::string colors;
  FieldName opacity_by, color_by;
  std::string second = "none";
  std::optional<std::string> second_opacity;
  std::string widgets;
  double unit = 0;
  VolumeMethod method = VolumeMethod::ray;
  RayFunction mode = RayFunction::composite;
  std::vector<double> levels;
  bool shaded = true;
  MaterialShow material;
  VaryingMaterial varying;
  PictureShow picture;
  double body = 0;  ///< diagonal of all parts of a collection; 0: that of the data
  VolumeSampling sampling;
  VolumeLight light;
  VolumeScattering scattering;
  std::string clip;
};
void describe(Schema& s, VolumeShow& p);

/// Throws Error(usage) for what no data could make right; all mistakes at once.
void check(const VolumeShow& p);

/// All parts are one body.
void share(const std::vector<DatasetPtr>& parts, const std::vector<VolumeShow*>& params);

/// Adds one VolumeItem; what was chosen and why goes to context.info(). Explicit parameters override a preset: what `schema`, the
/// one of `p`, knows as stated, and all that is not a default. Throws Error(usage) for data without volume, unknown fields and presets, and
/// transfer functions that cannot be.
std::optional<Legend> add(Scene& scene, const DatasetPtr& data, const VolumeShow& p, const Schema& schema, Context& context);
std::optional<Legend> add(Scene& scene, const DatasetPtr& data, const VolumeShow& p, Context& context);

/// "1,0,0,5; box 0,1,0,1,0,1": planes as normal and offset, boxes as their six sides. Throws Error(usage).
std::vector<ClipPlane> parse_clip(const std::string& text);

/// The words that make the look of this item again on any data with its fields: opacity, colours, second axis, ray function, sampling and
/// light, all in values of the field; not the field, the clipping nor the method. What a transfer function file holds.
std::vector<std::string> transfer_words(const VolumeItem& item);

}  // namespace sg
