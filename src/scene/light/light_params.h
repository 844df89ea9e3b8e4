// SPDX-License-Identifier: Apache-2.0
// The lights of a picture as a user states them: a kind and words, "sphere from=left-above size=0.4".
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/schema/schema.h"

namespace sg {

/// Where a light stands as the viewer sees it.
enum class LightSide {
  front,
  left,
  right,
  above,
  below,
  behind,
  left_above,
  right_above,
  left_below,
  right_below,
  left_behind,
  right_behind
};
constexpr auto enum_words(LightSide) {
  using enum LightSide;
  return std::array{Word{"front", front},
                    Word{"left", left},
                    Word{"right", right},
                    Word{"above", above},
                    Word{"below", below},
                    Word{"behind", behind},
                    Word{"left-above", left_above},
                    Word{"right-above", right_above},
                    Word{"left-below", left_below},
                    Word{"right-below", right_below},
                    Word{"left-behind", left_behind},
                    Word{"right-behind", right_behind}};
}

/// What azimuth and elevation are counted from.
enum class LightFrame {
  camera,  ///< the viewer, who has the light in the back at 0, to the right at 90
  data,    ///< north of the data, clockwise seen from above
};
constexpr auto enum_words(LightFrame) { return std::array{Word{"camera", LightFrame::camera}, Word{"data", LightFrame::data}}; }

/// The direction from the target towards a light.
struct LightWay {
  std::optional<LightSide> from;
  std::optional<double> azimuth, elevation;  ///< degrees
  LightFrame frame = LightFrame::camera;
};
/// Where a light of this world stands.
struct LightPlace {
  std::optional<Vec3> position;
  LightWay way;
  double distance = 2.5;       ///< from the target, in diagonals of the data
  std::optional<Vec3> target;  ///< empty = the middle of the data
};
struct LightStrength {
  std::string color = "white";  ///< sRGB
  double brightness = 1;        ///< of a white surface at the target that faces the light
  std::optional<double> power;  ///< instead of that: of all that it gives off, in squares of the data's lengths
};

struct PointLightParams {
  LightPlace place;
  LightStrength strength;
};
struct SpotLightParams {
  LightPlace place;
  LightStrength strength;
  double angle = 45;
  std::optional<double> inner;
};
struct DirectionalLightParams {
  LightWay way;
  std::optional<Vec3> direction;
  double angle = 1;
  std::string color = "white";
  double brightness = 1;
};
struct SphereLightParams {
  LightPlace place;
  LightStrength strength;
  double size = 0.8;  ///< diameter in diagonals of the data
  std::optional<double> radius;
};
struct DiscLightParams {
  LightPlace place;
  LightStrength strength;
  double size = 1;
  std::optional<double> radius;
};
struct RectangleLightParams {
  LightPlace place;
  LightStrength strength;
  std::vector<double> size{1};
  std::optional<double> width, height;
};
struct SunLightParams {
  double elevation = 40;
  std::optional<double> azimuth;  ///< empty = over the viewer's left shoulder
  double brightness = 1;
  double haze = 1;
};
/// The lights of a file that is shown: they are put in the place of this one when the picture is made (picture_file.h), and nothing shines
/// before.
struct FileLightParams {
  std::vector<std::string> names;
  double brightness = 1;
  std::optional<double> lux;
};
void describe(Schema& s, PointLightParams& p);
void describe(Schema& s, SpotLightParams& p);
void describe(Schema& s, DirectionalLightParams& p);
void describe(Schema& s, SphereLightParams& p);
void describe(Schema& s, DiscLightParams& p);
void describe(Schema& s, RectangleLightParams& p);
void describe(Schema& s, SunLightParams& p);
void describe(Schema& s, FileLightParams& p);

using LightParams = std::variant<PointLightParams, SpotLightParams, DirectionalLightParams, SphereLightParams, DiscLightParams,
                                 RectangleLightParams, SunLightParams, FileLightParams>;

/// For all doors.
struct LightKind {
  std::string_view name, sentence;
  ParamSet (*make_params)() = nullptr;
  LightParams (*take)(const ParamSet& params) = nullptr;
};
std::span<const LightKind> light_kinds();

/// "sphere from=left-above; sun elevation=20": lights apart by semicolons. Throws Error(usage) for unknown kinds and words, for colours
/// that are none, for numbers out of range, for places stated twice, and for more than 1000 lights.
std::vector<LightParams> parse_lights(const std::string& text);

/// Throws Error(usage) for text that is no colour; linear RGB.
Vec3f light_color(const std::string& text);

}  // namespace sg
