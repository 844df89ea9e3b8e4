// SPDX-License-Identifier: Apache-2.0
// RayFunction: what a ray through a volume collects, with one row each for its properties. To add one: a row here, a
// case in Caster::collect (render/volume/rays/cast.cpp), its search in rays/functions.h.
#pragma once
#include <array>
#include <cstddef>
#include <string_view>

#include "base/schema/enum_words.h"

namespace sg {

enum class RayFunction {
  composite,
  maximum,
  minimum,
  average,
  sum,
  first_hit,
  distance,
  accumulate,
  isosurface,
  maximum_difference,
};

struct RayFunctionInfo {
  /// What the colours (and the axis of the opacity) represent. Lengths are world lengths.
  enum class Axis { value, value_times_length, length };
  /// Where a ray need not look.
  enum class Skips { nothing, transparent, below_level, without_level };

  RayFunction function;
  std::string_view name, about;
  Axis axis = Axis::value;
  bool needs_level = false;
  bool absorbs = false;        ///< takes light away along its way: has shadows, occlusion and an extinction
  bool in_parts = false;       ///< parts of a ray, put together, are the ray
  bool classifies = false;     ///< needs an opacity that distinguishes materials
  bool shows_opacity = false;  ///< the opacity of values can be read from the picture and is shown in the legend
  Skips skips = Skips::nothing;

  bool collects() const { return axis != Axis::value; }  ///< what is drawn has another axis than the field's values
};

/// In the order of the enum.
inline constexpr std::array<RayFunctionInfo, 10> ray_functions = [] {
  using enum RayFunction;
  using Axis = RayFunctionInfo::Axis;
  using Skips = RayFunctionInfo::Skips;
  return std::array<RayFunctionInfo, 10>{{
      {.function = composite,
       .name = "composite",
       .about = "emission and absorption (Max 1995)",
       .absorbs = true,
       .in_parts = true,
       .classifies = true,
       .shows_opacity = true,
       .skips = Skips::transparent},
      {.function = maximum, .name = "maximum", .about = "the largest value", .classifies = true},
      {.function = minimum, .name = "minimum", .about = "the smallest value"},
      {.function = average, .name = "average", .about = "integral of the value along the ray divided by the length inside the volume"},
      {.function = sum,
       .name = "sum",
       .about = "integral of the value along the ray, as in an X-ray picture, in value times length",
       .axis = Axis::value_times_length},
      {.function = first_hit,
       .name = "first_hit",
       .about = "the point where the value first reaches the level, lit",
       .needs_level = true,
       .skips = Skips::below_level},
      {.function = distance,
       .name = "distance",
       .about = "distance from where the ray enters the volume to that point, through the colour scale",
       .axis = Axis::length,
       .needs_level = true},
      {.function = accumulate,
       .name = "accumulate",
       .about = "length along the ray where the value is at least the level, through the colour scale",
       .axis = Axis::length,
       .needs_level = true,
       .skips = Skips::below_level},
      {.function = isosurface,
       .name = "isosurface",
       .about = "the surfaces value = levels, lit, each with the opacity of its value",
       .needs_level = true,
       .in_parts = true,
       .shows_opacity = true,
       .skips = Skips::without_level},
      {.function = maximum_difference,
       .name = "maximum_difference",
       .about = "MIDA: compositing that lets new maxima shine through (Bruckner and Groeller 2009)",
       .absorbs = true,
       .classifies = true,
       .shows_opacity = true},
  }};
}();
static_assert([] {
  for (size_t i = 0; i < ray_functions.size(); ++i)
    if (size_t(ray_functions[i].function) != i) return false;
  return true;
}());
constexpr const RayFunctionInfo& info_of(RayFunction f) { return ray_functions[size_t(f)]; }

constexpr auto enum_words(RayFunction) {
  std::array<Word<RayFunction>, ray_functions.size()> words{};
  for (size_t i = 0; i < words.size(); ++i) words[i] = {ray_functions[i].name, ray_functions[i].function};
  return words;
}

}  // namespace sg
