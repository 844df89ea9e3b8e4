// SPDX-License-Identifier: Apache-2.0
#include "color/maps/maps_elsewhere.h"

#include <algorithm>

#include "base/text/text.h"

namespace sg {

namespace {

// Names of Matplotlib, Crameri's scientific maps, cmocean, colorcet, ParaView and MATLAB.
constexpr MapElsewhere elsewhere[] = {
    {"parula", "sight"},
    {"haline imola bgyw", "viridis"},
    {"fire blackbody blackbodyradiation heat lajolla kindlmann extendedblackbody", "inferno"},
    {"solar tempo lava", "inferno"},
    {"thermal gnuplot bmy hawaii", "plasma"},
    {"ocean oslo deep devon abyss kbc", "ice"},
    {"davos lapaz nuuk navia batlowk batloww bamako tokyo turku buda glasgow", "batlow"},
    {"acton bilbao", "magma"},
    {"grey grayscale greyscale grayc gistgray gistyarg linear", "gray"},
    {"binary xray", "Greys"},
    {"pink winter summer autumn spring cool wistia", "hot"},
    {"amp", "Reds"},
    {"matter", "RdPu"},
    {"dense", "PuBu"},
    {"rain", "Blues"},
    {"speed algae", "YlGn"},
    {"turbid", "YlOrBr"},
    {"cooltowarm cooltowarmextended warmcool smoothcoolwarm fast diff", "coolwarm"},
    {"berlin tofino lisbon vanimo managua redblueblack", "vik"},
    {"roma cork balance broc bam delta curl tarn", "vik"},
    {"redtoblue bluetored rdbudiverging", "RdBu"},
    {"tofinogreen prgreen", "PRGn"},
    {"romao viko broco corko bamo twilightshifted cyclic colorwheel huecircle", "twilight"},
    {"tab20b tab20c category20 d3category20", "tab20"},
    {"category10 d3category10 tableau10 vega10", "tab10"},
    {"glasbey glasbeylight glasbeydark categorical qualitative", "labels"},
    {"gistrainbow bluetoredrainbow rainbowdesaturated rainbowuniform nipyspectral gistncar spectrum sinebow brg prism flag", "turbo"},
    {"gistearth topo etopo oleron fes bukavu demcmap elevation", "terrain"},
};

}  // namespace

std::span<const MapElsewhere> maps_elsewhere() { return elsewhere; }

std::string nearest_map(std::string_view name) {
  std::string plain = to_lower(name);
  if (plain.size() > 2 && plain.ends_with("_r")) plain.resize(plain.size() - 2);
  for (const std::string_view prefix : {"cmocean.", "cmo.", "cmc.", "cet_", "crameri."})
    if (plain.starts_with(prefix)) plain.erase(0, prefix.size());
  std::erase_if(plain, [](char c) { return c == '_' || c == '-' || c == ' '; });
  for (const MapElsewhere& m : elsewhere)
    for (const std::string_view word : words(m.words))
      if (word == plain) return std::string(m.here);
  return "";
}

}  // namespace sg
