// SPDX-License-Identifier: Apache-2.0
// A volume's look as words.
#include <fmt/core.h>

#include "base/schema/schema.h"
#include "base/text/text.h"
#include "color/parse_color.h"
#include "color/transfer_text.h"
#include "color/widgets/widgets_text.h"
#include "scene/show/volume.h"

namespace sg {

namespace {

// The colours of a scale, and their positions.
void add_colors(const ColorScale& s, std::vector<std::string>& words) {
  if (s.labels.empty()) words.push_back("colors=" + color_stops_text(s));
  else words.push_back("map=" + s.map.name);
  if (s.kind != ScaleKind::linear) words.push_back(fmt::format("scale={}", word_of(s.kind)));
  if (s.kind == ScaleKind::symlog && s.linear_threshold > 0) words.push_back("linear_threshold=" + exact_number(s.linear_threshold));
  if (s.below) words.push_back("below=" + color_text(*s.below));
  if (s.above) words.push_back("above=" + color_text(*s.above));
  if (s.nan != ColorScale{}.nan) words.push_back("nan=" + color_text(s.nan));
  if (!s.clamp) words.push_back("clamp=false");
}

}  // namespace

std::vector<std::string> transfer_words(const VolumeItem& item) {
  std::vector<std::string> words;
  const TransferDetail& d = item.detail;
  if (d.color_by_second) words.push_back("color_by=" + d.second_field);
  add_colors(d.color_by_second ? d.second_color : item.color, words);
  if (d.widgets.empty()) words.push_back("opacity=" + opacity_text(item.opacity));
  if (d.second != SecondAxis::none && !d.color_by_second) {
    constexpr std::string_view names[] = {"none", "gradient", "second_derivative", "curvature"};
    words.push_back("second=" + (d.second == SecondAxis::field ? d.second_field : std::string(names[size_t(d.second)])));
    if (d.widgets.empty()) words.push_back("second_opacity=" + opacity_text(d.second_factor));
    else words.push_back("widgets=" + widgets_text(d.widgets));
  }
  words.push_back("unit=" + exact_number(item.unit_distance));
  words.push_back(fmt::format("mode={}", word_of(item.mode)));
  if (!item.levels.empty()) {
    std::string levels;
    for (const double v : item.levels) levels += (levels.empty() ? "" : ",") + exact_number(v);
    words.push_back("levels=" + levels);
  }
  words.push_back(std::string("shaded=") + (item.shaded ? "true" : "false"));
  for (const ParamSet& rest : {param_set_of(item.sampling), param_set_of(item.light), param_set_of(item.scattering)})
    for (std::string& word : changed_words(rest)) words.push_back(std::move(word));
  return words;
}

}  // namespace sg
