// SPDX-License-Identifier: Apache-2.0
// The declaration of the words, and the checks possible without data.
#include <fmt/core.h>

#include "base/text/text.h"
#include "color/transfer_text.h"
#include "color/widgets/widgets_text.h"
#include "scene/show/volume.h"
#include "scene/show/volume_presets.h"

namespace sg {

namespace {

std::string what_a_ray_collects() {
  std::string help = "Ray function: what a ray collects.";
  for (const RayFunctionInfo& f : ray_functions) help += fmt::format(" {}: {}.", f.name, f.about);
  return help;
}

}  // namespace

void describe(Schema& s, VolumeShow& p) {
  describe(s, p.coloring);
  std::string presets;
  std::vector<std::string> names;
  for (const VolumePreset& preset : volume_presets()) {
    presets += fmt::format("{}{} ({})", presets.empty() ? "" : ", ", preset.name, preset.about);
    names.emplace_back(preset.name);
  }
  s("preset", p.preset, fmt::format("A named set of parameters; those given explicitly override it: {}.", presets)).choices(names);
  s("transfer", p.transfer,
    "How opacity (and colours) are chosen where none are given: auto, histogram, boundaries (of materials, where gradients are large), or "
    "a FILE.yaml written with save.");
  s("save", p.save, "Write the transfer function to this file, for transfer=FILE.yaml.").unit("new file");
  s("opacity", p.opacity,
    "Piecewise linear opacity as ascending position:opacity points: 0:0,0.3:0.1,1:0.8. A position is a fraction of the range, or a value "
    "written with @: @-500:0,@200:0.4. Two points at one position make a step. Per 'unit' of length.");
  s("colors", p.colors, "Colours as position:colour stops instead of a map: 0:#000000,0.4:#aa3311,1:white, or @-500:black,@300:ivory.");
  s("opacity_by", p.opacity_by, "Field whose values determine opacity, while 'field' determines the colours.");
  s("color_by", p.color_by, "Field whose values determine the colours, while 'field' determines opacity.");
  s("second", p.second,
    "Second axis of the transfer function: none, gradient (magnitude), second_derivative (along the gradient), curvature (mean curvature "
    "of the level set), or a field.");
  s("second_opacity", p.second_opacity,
    "Factor on opacity over the second axis, written like opacity: 0:0,0.2:1. Positions 0 to 1 run from 0 to the largest gradient, from "
    "minus to plus the largest second derivative or curvature, or over the range of the field.");
  s("widgets", p.widgets,
    "Regions of the (value, second) plane to draw, instead of opacity: 'triangle LO HI BASE TOP OPACITY COLOR; rectangle LO HI LOW HIGH "
    "OPACITY COLOR; ellipse LO HI LOW HIGH OPACITY COLOR; paint RADIUS:RADIUS VALUE,SECOND VALUE,SECOND OPACITY COLOR'. Positions as in "
    "opacity; paint is a soft round brush drawn along a line of any number of points, its radii shares of the ranges of value and second, "
    "or with @ lengths on them. second defaults to gradient.");
  s("unit", p.unit, "World length to which opacity refers; 0: a hundredth of the diagonal.").at_least(0);
  s("method", p.method, "Rendering algorithm; ray is the reference.");
  s("mode", p.mode, what_a_ray_collects());
  s("levels", p.levels,
    "Values for first_hit, distance and accumulate (one) and isosurface (any number); default: the strongest material boundary.")
      .unit("@field");
  s("shaded", p.shaded, "Light the volume by the gradient of the field.");
  describe(s, p.material);
  describe(s, p.varying);
  describe(s, p.picture);
  describe(s, p.sampling);
  describe(s, p.light);
  describe(s, p.scattering);
  s("clip", p.clip,
    "Clip the volume: planes 'nx,ny,nz,offset; ...' keep the side where n.x <= offset, 'box x0,x1,y0,y1,z0,z1' keeps its inside.");
}

namespace {

// Whether there are positions as well as @values, so that only data can decide which comes first.
bool mixes_places(const std::string& points) {
  int values = 0, positions = 0;
  for (const std::string_view part : split(points, ','))
    if (part.find(':') != part.npos) ++(part.starts_with('@') ? values : positions);
  return values > 0 && positions > 0;
}

}  // namespace

void check(const VolumeShow& p) {
  std::string problems;
  const auto each = [&](auto&& f) {
    try {
      f();
    } catch (const Error& e) {
      problems += (problems.empty() ? "" : "; ") + std::string(e.what());
    }
  };
  ColorScale axis;  // any will do
  if (p.coloring.scale == ScaleKind::log) axis.kind = ScaleKind::log, axis.lo = 1e-300, axis.hi = 1;
  each([&] {
    std::vector<double> numbers{p.unit, p.sampling.step};
    numbers.insert(numbers.end(), p.levels.begin(), p.levels.end());
    for (const double v : numbers)
      if (!std::isfinite(v))
        fail_usage(fmt::format("{} is not a finite number", exact_number(v)), "volume", "unit, step and levels must be finite");
  });
  if (p.opacity && !mixes_places(*p.opacity)) each([&] { parse_opacity(*p.opacity, axis); });
  if (p.second_opacity && !mixes_places(*p.second_opacity)) each([&] { parse_opacity(*p.second_opacity, ColorScale{}, "second_opacity"); });
  if (!p.colors.empty() && !mixes_places(p.colors))
    each([&] {
      ColorScale scale = axis;
      parse_color_stops(p.colors, scale, false);
    });
  if (!p.widgets.empty())
    each([&] {
      if (!mixes_ends(p.widgets)) parse_widgets(p.widgets, axis, ColorScale{});
      if (p.opacity) fail_usage("both opacity and widgets are given", "widgets", "the widgets determine opacity; leave out one of the two");
    });
  if (!p.clip.empty()) each([&] { parse_clip(p.clip); });
  each([&] {
    if (!value_of_word<TransferChoice>(p.transfer)) {
      std::vector<std::string> names;
      for (const Word<TransferChoice>& w : enum_words(TransferChoice())) names.emplace_back(w.word);
      fail_usage(fmt::format("'{}' is not a way to choose a transfer function", p.transfer), "transfer",
                 unknown_name_hint(p.transfer, names) + "; files end in .yaml");
    }
    const int by = !p.opacity_by.empty() + !p.color_by.empty();
    if (by == 2) fail_usage("both opacity_by and color_by are given", "opacity_by", "give one of them, and the other field as field=");
    const bool second = value_of_word<SecondAxis>(p.second) != SecondAxis::none;
    if (by == 1 && second)
      fail_usage("the second field already is the second axis", "second", "leave out second=, or opacity_by and color_by");
    if (by == 1 && (info_of(p.mode).collects() || p.mode == RayFunction::average || p.mode == RayFunction::maximum_difference))
      fail_usage(fmt::format("what mode={} collects has no colour of another field", info_of(p.mode).name), "color_by",
                 "use mode=composite, maximum, minimum, first_hit or isosurface, or leave out color_by and opacity_by");
    if (p.mode != RayFunction::isosurface) {
      if (p.material.any() || p.varying.any())
        fail_usage("materials are of surfaces", "material", "use mode=isosurface with material= and its parameters, or leave them out");
      if (p.picture.any() || p.picture.any_other())
        fail_usage("pictures are on surfaces", "picture", "use mode=isosurface with picture=, or leave it out");
    }
    check(p.picture);
    if (!second && p.second_opacity && p.widgets.empty() && by == 0)
      fail_usage("there is no second axis", "second_opacity", "give one, e.g. second=gradient");
  });
  if (!problems.empty()) fail_usage(problems);
}

std::vector<ClipPlane> parse_clip(const std::string& text) {
  const char* form = "write planes as nx,ny,nz,offset separated by ';', or box x0,x1,y0,y1,z0,z1";
  std::vector<ClipPlane> planes;
  for (std::string_view part : split(text, ';')) {
    if (part.empty()) continue;
    const bool box = part.starts_with("box");
    const auto words = split(trim(box ? part.substr(3) : part), ',');
    std::vector<double> v;
    for (const std::string_view w : words) {
      const auto x = parse_double(w);
      if (!x || !std::isfinite(*x)) fail_usage(fmt::format("'{}' in '{}' is not a number", w, part), "clip", form);
      v.push_back(*x);
    }
    if (v.size() != (box ? 6u : 4u)) fail_usage(fmt::format("'{}' has {} numbers", part, v.size()), "clip", form);
    if (box) {
      for (size_t a = 0; a < 3; ++a) {
        if (!(v[2 * a] < v[2 * a + 1]))
          fail_usage(fmt::format("the box '{}' is empty", part), "clip", "write the lower end of each axis first");
        Vec3 n{a == 0 ? 1.0 : 0.0, a == 1 ? 1.0 : 0.0, a == 2 ? 1.0 : 0.0};
        planes.push_back({-n, -v[2 * a]});
        planes.push_back({n, v[2 * a + 1]});
      }
      continue;
    }
    const Vec3 n{v[0], v[1], v[2]};
    if (!(length(n) > 0)) fail_usage(fmt::format("the plane '{}' has no direction", part), "clip", form);
    planes.push_back({n, v[3]});
  }
  if (planes.empty()) fail_usage("there are no planes", "clip", form);
  return planes;
}

}  // namespace sg
