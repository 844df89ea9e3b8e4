// SPDX-License-Identifier: Apache-2.0
// The light that comes from all around, as a user states it: "sky elevation=20", "even brightness=0.5", "hall.hdr rotate=90".
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "base/schema/schema.h"

namespace sg {

/// Darkness.
struct NoEnvironmentParams {};
struct EvenEnvironmentParams {
  std::string color = "white";  ///< sRGB
  double brightness = 1;        ///< of a white surface in it
  bool background = false;
};
struct SkyEnvironmentParams {
  std::optional<double> elevation, azimuth;  ///< degrees, as of SunLightParams; empty = those of a sun light, else its defaults
  double brightness = 1;                     ///< of a white surface that faces the sun, or lies level when that has set
  double haze = 1;
  std::optional<bool> sun;  ///< the sun itself; empty = unless a sun light is stated
  bool background = true;
};
struct PictureEnvironmentParams {
  std::string file;
  double strength = 1;  ///< factor
  double rotate = 0;    ///< degrees
  bool background = true;
};
void describe(Schema& s, NoEnvironmentParams& p);
void describe(Schema& s, EvenEnvironmentParams& p);
void describe(Schema& s, SkyEnvironmentParams& p);
void describe(Schema& s, PictureEnvironmentParams& p);

using EnvironmentParams = std::variant<NoEnvironmentParams, EvenEnvironmentParams, SkyEnvironmentParams, PictureEnvironmentParams>;

/// For all doors.
struct EnvironmentKind {
  std::string_view name, sentence;
  ParamSet (*make_params)() = nullptr;
  EnvironmentParams (*take)(const ParamSet& params) = nullptr;
};
std::span<const EnvironmentKind> environment_kinds();

/// A kind and its words; a first word that is the name of a file means a picture. "" = nothing is stated. Throws Error(usage) for unknown
/// kinds and words, colours that are none, and numbers out of range.
std::optional<EnvironmentParams> parse_environment(const std::string& text);

/// The file that such text names; "" = none. Throws nothing.
std::string environment_file(const std::string& text);
/// The same text with another name in its place.
std::string with_environment_file(const std::string& text, const std::string& file);

}  // namespace sg
