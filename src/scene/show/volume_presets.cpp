// SPDX-License-Identifier: Apache-2.0
#include "scene/show/volume_presets.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/text/text.h"
#include "color/parse_color.h"
#include "data/ranks/over_all.h"
#include "scene/choose/histogram.h"
#include "scene/choose/volume/look.h"

namespace sg {

namespace {

// A place on a preset's axis and what is there.
struct Stop {
  double at, opacity;
};
struct ColorStop {
  double at;
  std::string_view color;
};
struct Look {
  VolumePreset preset;
  enum class Axis { hounsfield, foreground } axis;  // foreground: 0 where the background ends, 1 at the largest values
  std::vector<Stop> opacity;
  std::vector<ColorStop> colors;
  void (*rest)(VolumeShow&);
  bool foreground_is_vessels = false;  // in scans without Hounsfield units: what is not background holds contrast agent
};

const std::vector<Look>& looks() {
  using enum Look::Axis;
  static const std::vector<Look> all{
      {{"ct_bone", "CT: bone only"},
       hounsfield,
       {{180, 0}, {260, 0.25}, {450, 0.6}, {1000, 0.85}, {3000, 0.95}},
       {{100, "#b5651d"}, {250, "#d9a066"}, {450, "#efdcb8"}, {1000, "#fbf6e8"}, {1800, "#ffffff"}},
       [](VolumeShow& p) { p.light.specular = 0.3, p.light.power = 40; }},
      {{"ct_skin", "CT: the skin"},
       hounsfield,
       {{-650, 0}, {-450, 0.1}, {-250, 0.6}, {0, 0.85}, {3000, 0.95}},
       {{-700, "#8a4f3a"}, {-350, "#d89b7c"}, {0, "#ecbfa3"}, {300, "#f2d3bd"}},
       [](VolumeShow& p) { p.light.specular = 0.12, p.light.power = 16; }},
      {{"ct_vessels", "CT angiography: vessels red, bone ivory"},
       hounsfield,
       {{120, 0}, {180, 0.08}, {260, 0.45}, {400, 0.6}, {600, 0.35}, {3000, 0.5}},
       {{100, "#5c0a0a"}, {220, "#b3201a"}, {380, "#e05a3a"}, {600, "#e8c9a0"}, {1200, "#fbf6e8"}},
       [](VolumeShow& p) { p.light.specular = 0.35, p.light.power = 48; },
       true},
      {{"mr", "tissue by its brightness, with emphasised boundaries"},
       foreground,
       {{0, 0}, {0.15, 0.02}, {0.45, 0.10}, {0.75, 0.35}, {1, 0.6}},
       {{0, "#2a1512"}, {0.3, "#8a4a3c"}, {0.55, "#c98b72"}, {0.8, "#ecd2bd"}, {1, "#fffaf2"}},
       [](VolumeShow& p) { p.light.specular = 0.1, p.second = "gradient", p.second_opacity = "0:0.1,0.15:0.5,0.4:1"; }},
      {{"xray", "the integral along each ray, in grey"},
       foreground,
       {},
       {},
       [](VolumeShow& p) { p.mode = RayFunction::sum, p.coloring.map = "gray", p.shaded = false; }},
      {{"mip_angiography", "the maximum along each ray, in grey"},
       foreground,
       {{0, 1}, {1, 1}},
       {},
       [](VolumeShow& p) { p.mode = RayFunction::maximum, p.coloring.map = "gray", p.shaded = false; }},
      {{"combustion", "hot regions glow, cold ones are transparent"},
       foreground,
       {{0, 0}, {0.1, 0.006}, {0.35, 0.06}, {0.7, 0.25}, {1, 0.7}},
       {{0, "#2b0b06"}, {0.3, "#8f1d0a"}, {0.55, "#e0560f"}, {0.8, "#fbb526"}, {1, "#fff6c8"}},
       [](VolumeShow& p) { p.shaded = false; }},
      {{"density", "opacity increases linearly with the value"},
       foreground,
       {{0, 0}, {1, 0.35}},
       {},
       [](VolumeShow& p) { p.coloring.map = "sight", p.shaded = false; }},
  };
  return all;
}

const Look& look_of(std::string_view name) {
  std::vector<std::string> names;
  for (const Look& l : looks()) {
    if (l.preset.name == name) return l;
    names.emplace_back(l.preset.name);
  }
  fail_usage(fmt::format("unknown preset '{}'", name), "preset", unknown_name_hint(name, names));
}

// To three digits: numbers for people to read.
Range rounded_foreground(const Field& field, int component, const Range& r, const Context& context) {
  const Range f = foreground(field, component, r.lo, r.hi, context);
  const Range short_one{*parse_double(short_number(f.lo, 3)), *parse_double(short_number(f.hi, 3))};
  return short_one.lo < short_one.hi ? short_one : f;
}

}  // namespace

std::span<const VolumePreset> volume_presets() {
  static const std::vector<VolumePreset> presets = [] {
    std::vector<VolumePreset> r;
    for (const Look& l : looks()) r.push_back(l.preset);
    return r;
  }();
  return presets;
}

VolumeShow volume_of_preset(std::string_view name, const Dataset& data, const Field& field, int component, std::string& reason,
                            const Context& context) {
  const Look& look = look_of(name);
  Range r = range_over_all(data, field, field.components() > 1 ? component : 0, context);
  if (r.empty()) r = {0, 1};
  if (r.lo == r.hi) r.hi = r.lo + std::max(1.0, 0.01 * std::abs(r.lo));
  double zero = r.lo, per = r.hi - r.lo;  // value = zero + per * place
  if (look.axis == Look::Axis::hounsfield) {
    double offset = 0;
    if (looks_like_ct(data, field, &offset, context) || (r.lo <= -500 && r.hi >= 500)) {
      zero = offset, per = 1;
      reason = fmt::format("preset {}: values are Hounsfield units{}", name, offset != 0 ? fmt::format(" + {}", short_number(offset)) : "");
    } else if (look.foreground_is_vessels) {
      constexpr double faint = 120, bright = 500;
      const Range f = rounded_foreground(field, component, r, context);
      per = (f.hi - f.lo) / (bright - faint), zero = f.lo - faint * per;
      reason = fmt::format("preset {}: '{}' does not look like CT in Hounsfield units; its foreground {} to {} is taken as vessels", name,
                           field.name, short_number(f.lo), short_number(f.hi));
    } else {
      // Nobody knows: as if the data went from air to dense bone.
      constexpr double air = -1000, bone = 2000;
      per = (r.hi - r.lo) / (bone - air), zero = r.lo - air * per;
      reason = fmt::format("preset {}: '{}' does not look like CT in Hounsfield units; its range {} to {} is taken as -1000 to 2000", name,
                           field.name, short_number(r.lo), short_number(r.hi));
    }
  } else {
    const Range f = rounded_foreground(field, component, r, context);
    zero = f.lo, per = f.hi - f.lo;
    reason = fmt::format("preset {}: the foreground of '{}' ranges from {} to {}", name, field.name, short_number(f.lo, 3),
                         short_number(f.hi, 3));
  }
  VolumeShow show;
  look.rest(show);
  std::string opacity, colors;
  const auto value = [&](double at) { return short_number(zero + per * at, 8); };
  for (const Stop& s : look.opacity) opacity += fmt::format("{}@{}:{}", opacity.empty() ? "" : ",", value(s.at), exact_number(s.opacity));
  // No farther than the data goes: legends show no values that are not there.
  const auto add_color = [&](double v, Vec3f c) {
    colors += fmt::format("{}@{}:{}", colors.empty() ? "" : ",", short_number(v, 8), color_text(c));
  };
  const double first = look.colors.empty() ? 0 : zero + per * look.colors.front().at,
               last = look.colors.empty() ? 0 : zero + per * look.colors.back().at;
  const bool overlap = std::max(first, r.lo) < std::min(last, r.hi);
  const double lo = overlap ? std::max(first, r.lo) : first, hi = overlap ? std::min(last, r.hi) : last;
  for (size_t i = 0; i < look.colors.size(); ++i) {
    const double v = zero + per * look.colors[i].at;
    const Vec3f c = parse_color(look.colors[i].color, "preset");
    if (i > 0) {
      const double u = zero + per * look.colors[i - 1].at;
      const Vec3f b = parse_color(look.colors[i - 1].color, "preset");
      for (const double end : {lo, hi})
        if (end > u && end < v) add_color(end, lerp(b, c, float((end - u) / (v - u))));
    }
    if (v >= lo && v <= hi) add_color(v, c);
  }
  if (!opacity.empty()) show.opacity = opacity;
  if (!colors.empty()) show.colors = colors;
  else if (!opacity.empty()) show.coloring.range = {*parse_double(value(0)), *parse_double(value(1))};
  return show;
}

}  // namespace sg
