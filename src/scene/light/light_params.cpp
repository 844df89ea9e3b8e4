// SPDX-License-Identifier: Apache-2.0
#include "scene/light/light_params.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "base/schema/color_params.h"
#include "base/text/text.h"
#include "color/parse_color.h"
#include "image/image.h"
#include "scene/light/light_text.h"

namespace sg {

namespace {

void describe_way(Schema& s, LightWay& w) {
  s("from", w.from, "Where it stands as the viewer sees it; default: left-above, which is in front of the data, to the left and above.");
  s("azimuth", w.azimuth, "Instead of from: angle to the right of the viewer; with frame=data clockwise from north.")
      .unit("deg")
      .range(-360, 360);
  s("elevation", w.elevation, "Instead of from: angle above the viewer; with frame=data above the horizon.").unit("deg").range(-90, 90);
  s("frame", w.frame,
    "What azimuth and elevation are counted from: camera, so that lights turn with the viewer, or data, where north is +y and z is up (of "
    "graphics -z and y).");
}
void describe_place(Schema& s, LightPlace& p, bool faces) {
  s("position", p.position, "Place in the data's coordinates; default: by from or the angles, at a distance.");
  describe_way(s, p.way);
  s("distance", p.distance, "Without position: distance from the target, in diagonals of the data.").range(0, 1e6).positive();
  s("target", p.target,
    faces ? "Place that it faces; default: the middle of the data."
          : "Place that distance, angles and brightness refer to; default: the middle of the data.");
}
void describe_brightness(Schema& s, double& brightness) {
  s("brightness", brightness, "How bright a white surface at the target is that faces the light: 1 is white.").range(0, 1e9).positive();
}
void describe_strength(Schema& s, LightStrength& l) {
  s("color", l.color, "Colour of the light.").unit(color_unit);
  describe_brightness(s, l.brightness);
  s("power", l.power,
    "Instead of brightness: all the light that it gives off, whatever its size and distance; 4 pi^2 from a point makes white what is at a "
    "distance of 1.")
      .range(0, 1e30)
      .positive();
}

template <class P>
constexpr LightKind light_kind(std::string_view name, std::string_view sentence) {
  LightKind k;
  k.name = name, k.sentence = sentence;
  k.make_params = make_param_set<P>;
  k.take = [](const ParamSet& params) { return LightParams(params.as<P>()); };
  return k;
}

void check(const LightWay& w, bool placed, const std::string& owner) {
  const bool angles = w.azimuth || w.elevation;
  if (int(w.from.has_value()) + int(angles) + int(placed) > 1)
    fail_usage("its place is stated twice", owner, "give only one of position (or direction), from, and azimuth with elevation");
}
void check(const Vec3& v, const char* name, const std::string& owner) {
  if (!(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z))) fail_usage(fmt::format("{} is not finite", name), owner);
}

// What no single range tells.
void check(const LightParams& light, const ParamSet& params, const std::string& owner) {
  std::visit(
      [&](const auto& l) {
        if constexpr (requires { l.place; }) {
          check(l.place.way, l.place.position.has_value(), owner);
          if (l.place.position) check(*l.place.position, "position", owner);
          if (l.place.target) check(*l.place.target, "target", owner);
          if (l.place.position && l.place.target && *l.place.position == *l.place.target)
            fail_usage("position and target are the same place", owner, "move one of them");
          if (params.schema.stated("power") && params.schema.stated("brightness"))
            fail_usage("its brightness is stated twice", owner, "give brightness or power");
          light_color(l.strength.color);
        }
        if constexpr (requires { l.direction; }) {
          check(l.way, l.direction.has_value(), owner);
          if (l.direction) check(*l.direction, "direction", owner);
          if (l.direction && !(length(*l.direction) > 0)) fail_usage("direction must not be 0,0,0", owner);
          light_color(l.color);
        }
        if constexpr (requires { l.radius; })
          if (params.schema.stated("radius") && params.schema.stated("size"))
            fail_usage("its size is stated twice", owner, "give size, in diagonals of the data, or radius, in its coordinates");
        if constexpr (requires { l.lux; })
          if (params.schema.stated("lux") && params.schema.stated("brightness"))
            fail_usage("its brightness is stated twice", owner, "give brightness or lux");
        if constexpr (requires { l.inner; })
          if (l.inner && *l.inner > l.angle) fail_usage("inner is above angle", owner, "it is the part of the cone at full strength");
        if constexpr (requires { l.width; }) {
          if (l.width.has_value() != l.height.has_value()) fail_usage("width and height go together", owner, "give both");
          if (params.schema.stated("width") && params.schema.stated("size"))
            fail_usage("its size is stated twice", owner, "give size, in diagonals of the data, or width and height, in its coordinates");
        }
      },
      light);
}

}  // namespace

Vec3f light_color(const std::string& text) {
  const Vec3f c = parse_color(text, "color");
  if (c == Vec3f()) fail_usage(fmt::format("light of the colour '{}' is none", text), "color", "leave the light out");
  return {srgb_decode(c.x), srgb_decode(c.y), srgb_decode(c.z)};
}

void describe(Schema& s, PointLightParams& p) { describe_place(s, p.place, false), describe_strength(s, p.strength); }
void describe(Schema& s, SpotLightParams& p) {
  describe_place(s, p.place, true), describe_strength(s, p.strength);
  s("angle", p.angle, "Angle across its cone, beyond which it does not shine.").unit("deg").range(0, 180).positive();
  s("inner", p.inner, "Angle across the cone in which it is at full strength; default: 0.7 of angle.").unit("deg").range(0, 180);
}
void describe(Schema& s, FileLightParams& p) {
  s("names", p.names, "Those of these names; default: all.");
  s("brightness", p.brightness,
    "How bright a white surface at the middle of the data is that faces all of them; their ratios stay as they are stated.")
      .range(0, 1e9)
      .positive();
  s("lux", p.lux,
    "Instead of brightness: illuminance that makes a white surface white. glTF states candela and lux; pi takes its numbers as three.js "
    "shows them.")
      .range(0, 1e12)
      .positive();
}
void describe(Schema& s, DirectionalLightParams& p) {
  describe_way(s, p.way);
  s("direction", p.direction, "Instead of these: direction towards the light in the data's coordinates.");
  s("angle", p.angle, "Angle that it fills in the sky; shadows are the softer the larger it is, sharp at 0.").unit("deg").range(0, 170);
  s("color", p.color, "Colour of the light.").unit(color_unit);
  describe_brightness(s, p.brightness);
}
void describe(Schema& s, SphereLightParams& p) {
  describe_place(s, p.place, false), describe_strength(s, p.strength);
  s("size", p.size, "Its diameter in diagonals of the data: shadows are the softer the larger it is.").range(0, 1e6).positive();
  s("radius", p.radius, "Instead of size: its radius in the data's coordinates.").range(0, 1e30).positive();
}
void describe(Schema& s, DiscLightParams& p) {
  describe_place(s, p.place, true), describe_strength(s, p.strength);
  s("size", p.size, "Its diameter in diagonals of the data: shadows are the softer the larger it is.").range(0, 1e6).positive();
  s("radius", p.radius, "Instead of size: its radius in the data's coordinates.").range(0, 1e30).positive();
}
void describe(Schema& s, RectangleLightParams& p) {
  describe_place(s, p.place, true), describe_strength(s, p.strength);
  s("size", p.size, "Its width and height in diagonals of the data, one number for a square.").range(0, 1e6).positive().items(1, 2);
  s("width", p.width, "Instead of size: its width in the data's coordinates.").range(0, 1e30).positive();
  s("height", p.height, "And its height.").range(0, 1e30).positive();
}
void describe(Schema& s, SunLightParams& p) {
  s("elevation", p.elevation, "Height of the sun above the horizon.").unit("deg").range(0, 90);
  s("azimuth", p.azimuth,
    "Direction of the sun clockwise from north, which is +y where z is up (of graphics -z, y is up); default: over the viewer's left "
    "shoulder.")
      .unit("deg")
      .range(-360, 360);
  describe_brightness(s, p.brightness);
  s("haze", p.haze, "Dust and droplets in the air, as a factor to a clear day: more of them redden a low sun.").range(0, 20);
}

std::span<const LightKind> light_kinds() {
  static constexpr LightKind kinds[] = {
      light_kind<PointLightParams>("point", "Light from a point, with sharp shadows."),
      light_kind<SpotLightParams>("spot", "Light from a point into a cone, with sharp shadows."),
      light_kind<DirectionalLightParams>("directional", "Light from far away: from one direction, or a disc in the sky."),
      light_kind<SphereLightParams>("sphere", "A ball that shines."),
      light_kind<DiscLightParams>("disc", "A round lamp that shines to the side of its target."),
      light_kind<RectangleLightParams>("rectangle", "A window or a soft box, which shines to the side of its target."),
      light_kind<SunLightParams>("sun", "The sun, in the colour that the air leaves it at its height."),
      light_kind<FileLightParams>("file", "The lights that the file has which is shown (glTF)."),
  };
  return kinds;
}

std::vector<LightParams> parse_lights(const std::string& text) {
  constexpr size_t most = 1000;
  std::vector<LightParams> lights;
  for (const auto& [kind, words] : lights_of_text(text)) {
    std::vector<std::string> names;
    const LightKind* found = nullptr;
    for (const LightKind& k : light_kinds()) {
      names.emplace_back(k.name);
      if (equal_ignoring_case(k.name, kind)) found = &k;
    }
    if (!found)
      fail_usage(kind.find('=') == std::string::npos ? fmt::format("unknown kind of light '{}'", kind)
                                                     : fmt::format("'{}' stands where the kind of light should", kind),
                 "light", unknown_name_hint(kind.substr(0, kind.find('=')), names));
    const std::string owner = fmt::format("light {}", found->name);
    ParamSet params = found->make_params();
    set_params(params.schema, words, owner);
    lights.push_back(found->take(params));
    check(lights.back(), params, owner);
    if (lights.size() > most) fail_usage(fmt::format("more than {} lights", most), "light");
  }
  return lights;
}

}  // namespace sg
