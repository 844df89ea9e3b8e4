// SPDX-License-Identifier: Apache-2.0
// The words of `--show 'volume ...'` and what they make: a VolumeItem and its legend.
#pragma once
#include "scene/show.h"

namespace sg {

struct VolumeShow {
  ColoringParams coloring;
  std::string preset, transfer = "auto", save;
  std::string opacity = "auto", colors;
  FieldName opacity_by, color_by;
  std::string second = "none", second_opacity = "auto", widgets;
  double unit = 0;
  std::string method = "ray", mode = "composite";
  std::vector<double> levels;
  bool shaded = true;
  VolumeSampling sampling;
  VolumeLight light;
  std::string clip;
};
void describe(Schema& s, VolumeShow& p);

/// The words as parameters; the second finds the mistakes that can be seen without data, all at once. Throw Error(usage).
VolumeShow read_volume_words(const std::vector<std::string>& words);
VolumeShow checked_volume_words(const std::vector<std::string>& words);
void check_volume_words(const std::vector<std::string>& words);

/// Adds one VolumeItem; what was chosen and why goes to context.info(). A preset's words come before the stated ones. Throws Error(usage)
/// for data without volume, unknown fields and presets, and transfer functions that cannot be.
std::optional<Legend> add_volume(Scene& scene, const DatasetPtr& data, const std::vector<std::string>& words, Context& context);

/// "1,0,0,5; box 0,1,0,1,0,1": planes as normal and offset, boxes as their six sides. Throws Error(usage).
std::vector<ClipPlane> parse_clip(const std::string& text);

/// The words that make the look of this item again on any data with its fields: opacity, colours, second axis, ray function, sampling and
/// light, all in values of the field; not the field, the clipping nor the method. What a transfer function file holds.
std::vector<std::string> transfer_words(const VolumeItem& item);

}  // namespace sg
