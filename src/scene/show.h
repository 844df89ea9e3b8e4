// SPDX-License-Identifier: Apache-2.0
// The ways to show a dataset: each is a parameter struct with one declaration and a function that adds items to a scene.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/context.h"
#include "base/schema.h"
#include "color/legend_content.h"
#include "scene/scene.h"
#include "scene/show_lic.h"

namespace sg {

/// How values become colours: shared by every way to show.
struct ColoringParams {
  FieldName field;
  int component = -1;
  std::string map = "auto";
  std::vector<double> range;
  std::string scale = "linear";
  double linear_threshold = 0;
  std::string below, above, nan;
  bool clamp = true;
  std::string color;
};
void describe(Schema& s, ColoringParams& p);

struct SurfaceShow {
  ColoringParams coloring;
  double opacity = 1;
  bool edges = false, flat = false, lit = true;
  double feature_angle = 40;
  LicShow lic;
  std::string texture;
};
struct LinesShow {
  ColoringParams coloring;
  double opacity = 1, width = 1.5;
  bool lit = false;
  double halo = 0;
  std::string halo_color = "#0d0d0f";
};
struct PointsShow {
  ColoringParams coloring;
  double opacity = 1, size = 4;
  bool discs = true;
};
struct LabelsShow {
  FieldName field;
  double size = 1;
  std::string color;
};
struct OutlineShow {
  std::string color = "#707078";
  double width = 1.2;
};
void describe(Schema& s, SurfaceShow& p);
void describe(Schema& s, LinesShow& p);
void describe(Schema& s, PointsShow& p);
void describe(Schema& s, LabelsShow& p);
void describe(Schema& s, OutlineShow& p);

/// One way to show, as the command line, pipeline files and help see it.
struct ShowKind {
  std::string_view name, sentence;
  std::string (*help)();
  std::string (*json)();
  /// Throws Error(usage) for bad words; all mistakes at once.
  void (*check)(const std::vector<std::string>& words);
  /// Adds items for the dataset; returns what the legend shows when a field is mapped to colours.
  std::optional<Legend> (*add)(Scene&, const DatasetPtr&, const std::vector<std::string>& words, Context&);
};
std::span<const ShowKind> show_kinds();
/// Throws Error(usage) with "did you mean".
const ShowKind& find_show(std::string_view name);

/// The colour scale for a field: map and range as asked, or chosen from the data (categorical for labels, diverging and
/// symmetric when signed about zero, else sequential; the field 'band' of filled contours: one colour a band, with its limits).
ColorScale choose_scale(const Dataset& data, const Field& field, const ColoringParams& params, Context& context);

/// Signed about zero, so that both signs get colours of their own: neither side is a mere twentieth of the other.
bool two_sided(const Field& field, const Range& range);

/// The field that colours a dataset when none is named: the bands of filled contours, its scalars when they vary, else its own colours,
/// else the first field that varies, points before cells, scalars before vectors, numberings last. Null when there is none.
const Field* automatic_field(const Dataset& data);

/// The field that `params` names, else the automatic one; null for one colour and when there is none. Throws Error(usage).
const Field* wanted_field(const Dataset& data, const ColoringParams& params);

/// A point cloud with point fields 'value', 'angle' and 'line', as the operation line_labels makes it.
bool is_line_labels(const Dataset& data);

/// Has the cell fields 'band', 'band low' and 'band high' that the operation bands makes: filled contours.
bool is_banded(const Dataset& data);

/// Integer values that name things: few distinct ones, in pieces. For fields of lattices, points and cells.
bool looks_like_labels(const Dataset& data, const Field& field);

}  // namespace sg
