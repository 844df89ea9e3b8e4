// SPDX-License-Identifier: Apache-2.0
#include "scene/light/environment_params.h"

#include <fmt/core.h>

#include <vector>

#include "base/error.h"
#include "base/schema/color_params.h"
#include "base/text/text.h"
#include "scene/light/light_params.h"
#include "scene/light/light_text.h"

namespace sg {

namespace {

template <class P>
constexpr EnvironmentKind environment_kind(std::string_view name, std::string_view sentence) {
  EnvironmentKind k;
  k.name = name, k.sentence = sentence;
  k.make_params = make_param_set<P>;
  k.take = [](const ParamSet& params) { return EnvironmentParams(params.as<P>()); };
  return k;
}

constexpr std::string_view background_doc = "Show it behind the data, in the place of the picture's background.";

const EnvironmentKind* kind_named(std::string_view name) {
  for (const EnvironmentKind& k : environment_kinds())
    if (equal_ignoring_case(k.name, name)) return &k;
  return nullptr;
}

}  // namespace

void describe(Schema&, NoEnvironmentParams&) {}
void describe(Schema& s, EvenEnvironmentParams& p) {
  s("color", p.color, "Colour of the light.").unit(color_unit);
  s("brightness", p.brightness, "How bright a white surface is in it: 1 is white.").range(0, 1e9).positive();
  s("background", p.background, std::string(background_doc));
}
void describe(Schema& s, SkyEnvironmentParams& p) {
  s("elevation", p.elevation, "Height of the sun above the horizon, below 0 in twilight; default: that of a light 'sun', else 40.")
      .unit("deg")
      .range(-8, 90);
  s("azimuth", p.azimuth,
    "Direction of the sun clockwise from north; default: that of a light 'sun', else over the viewer's left shoulder.")
      .unit("deg")
      .range(-360, 360);
  s("brightness", p.brightness,
    "How bright a white surface is that faces the sun: 1 is white; when that has set what lies level is a fifth of it. With a light 'sun' "
    "a "
    "factor to its sky.")
      .range(0, 1e9)
      .positive();
  s("haze", p.haze, "Dust and droplets in the air, as a factor to a clear day.").range(0, 20);
  s("sun", p.sun, "With the sun itself, a light of half a degree; default: unless a light 'sun' is stated.");
  s("background", p.background, std::string(background_doc));
}
void describe(Schema& s, PictureEnvironmentParams& p) {
  s("file", p.file,
    "Picture of all directions in equirectangular form (twice as wide as high, up at the top): .hdr, or .png, .jpg and others.")
      .unit("file")
      .required();
  s("strength", p.strength, "Factor to its light; at 1 a white surface is as bright as the picture is on average.")
      .range(0, 1e9)
      .positive();
  s("rotate", p.rotate, "Angle by which it is turned about the vertical, clockwise seen from above; at 0 its middle lies behind the data.")
      .unit("deg")
      .range(-360, 360);
  s("background", p.background, std::string(background_doc));
}

std::span<const EnvironmentKind> environment_kinds() {
  static constexpr EnvironmentKind kinds[] = {
      environment_kind<NoEnvironmentParams>("none", "Darkness around the lights."),
      environment_kind<EvenEnvironmentParams>("even", "The same light from everywhere."),
      environment_kind<SkyEnvironmentParams>("sky", "The sky of a sun at some height, computed from the air, with that sun."),
      environment_kind<PictureEnvironmentParams>(picture_environment,
                                                 "Light by a picture of all directions; the name of the file alone will do."),
  };
  return kinds;
}

std::optional<EnvironmentParams> parse_environment(const std::string& text) {
  const std::optional<LightText> all = environment_of_text(text);
  if (!all) return {};
  const EnvironmentKind* found = kind_named(all->kind);
  if (!found) {
    std::vector<std::string> names;
    for (const EnvironmentKind& k : environment_kinds()) names.emplace_back(k.name);
    fail_usage(fmt::format("unknown environment '{}'", all->kind), "environment",
               unknown_name_hint(all->kind, names) + ", or the name of a file");
  }
  const std::string owner = fmt::format("environment {}", found->name);
  ParamSet params = found->make_params();
  set_params(params.schema, all->words, owner);
  EnvironmentParams e = found->take(params);
  if (const auto* even = std::get_if<EvenEnvironmentParams>(&e)) light_color(even->color);
  if (const auto* picture = std::get_if<PictureEnvironmentParams>(&e); picture && picture->file.empty())
    fail_usage("no file is named", owner, "write e.g. environment='hall.hdr rotate=90'");
  return e;
}

namespace {

// As set_params() understands it.
bool names_file(const std::string& word) {
  const size_t sign = word.find('=');
  return sign != word.npos && equal_ignoring_case(trim(std::string_view(word).substr(0, sign)), "file");
}

}  // namespace

std::string environment_file(const std::string& text) {
  try {
    const std::optional<LightText> all = environment_of_text(text);
    if (!all || !equal_ignoring_case(all->kind, picture_environment)) return {};
    std::string file;
    for (const std::string& w : all->words)
      if (names_file(w)) file = w.substr(w.find('=') + 1);
    return file;
  } catch (const Error&) {  // a quote that is not closed: parse_environment() tells of it
    return {};
  }
}

std::string with_environment_file(const std::string& text, const std::string& file) {
  std::optional<LightText> all = environment_of_text(text);
  if (!all) return {};
  for (std::string& w : all->words)
    if (names_file(w)) w = "file=" + file;
  return text_of_light(*all);
}

}  // namespace sg
