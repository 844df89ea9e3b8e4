// SPDX-License-Identifier: Apache-2.0
// The outer surface of the data, with its lines and vertices.
#pragma once
#include "color/legend_content.h"
#include "scene/choose/coloring.h"
#include "scene/scene.h"
#include "scene/show/lic.h"

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
  std::optional<MaterialPreset> material;
};
void describe(Schema& s, SurfaceShow& p);

/// Adds items for the dataset; returns what the legend shows when a field is mapped to colours.
std::optional<Legend> add(Scene& scene, const DatasetPtr& data, const SurfaceShow& p, Context& context);

}  // namespace sg
