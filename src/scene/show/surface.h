// SPDX-License-Identifier: Apache-2.0
// The outer surface of the data, with its lines and vertices.
#pragma once
#include "color/legend_content.h"
#include "scene/choose/coloring.h"
#include "scene/scene.h"
#include "scene/show/isoline_words.h"
#include "scene/show/lic.h"
#include "scene/show/material_words.h"
#include "scene/show/picture.h"
#include "scene/show/varying_material.h"

namespace sg {

enum class SurfaceStyle { solid, wireframe, points };
constexpr auto enum_words(SurfaceStyle) {
  using enum SurfaceStyle;
  return std::array{Word{"solid", solid}, Word{"wireframe", wireframe}, Word{"points", points}};
}

struct SurfaceShow {
  ColoringParams coloring;
  SurfaceStyle style = SurfaceStyle::solid;
  double opacity = 1;
  bool edges = false, flat = false;
  std::optional<bool> lit;
  double feature_angle = 40;
  LicShow lic;
  FieldName texture;
  PictureShow picture;
  IsolineShow isolines;
  MaterialShow material;
  VaryingMaterial varying;
  double body = 0;  ///< diagonal of all parts of a collection; 0: that of the data
  bool own_materials = true;
};
void describe(Schema& s, SurfaceShow& p);
/// Throws Error(usage) for what no data could make right.
void check(const SurfaceShow& p);
/// The field that colours when none is named: none under a picture and of a stated material, and none where the data has its own.
const Field* automatic_field(const SurfaceShow& p, const Dataset& data);

/// All parts are one body.
void share(const std::vector<DatasetPtr>& parts, const std::vector<SurfaceShow*>& params);

/// Adds items for the dataset; returns what the legend shows when a field is mapped to colours.
std::optional<Legend> add(Scene& scene, const DatasetPtr& data, const SurfaceShow& p, Context& context);

}  // namespace sg
