// SPDX-License-Identifier: Apache-2.0
#include "base/schema/other_words.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"

namespace sg {

namespace {

// Words of one meaning, the likelier ones here first.
constexpr std::string_view meanings[] = {
    "values value isovalue isovalues isosurfaces levels level contours thresholds",
    "count n number num numberofcontours nlevels levels resolution npoints",
    "field scalars scalar array variable var colorby coloring vectors by name",
    "map cmap colormap colourmap lut palette lookuptable",
    "range clim limits vmin vmax scalarrange crange",
    "opacity alpha transparency",
    "color colour c facecolor",
    "edges showedges edgevisibility mesh",
    "width linewidth thickness radius",
    "size pointsize windowsize resolution dims",
    "scale factor scalefactor magnification",
    "normal direction axis n",
    "origin point center centre at",
    "min lower lo low minimum from above greater greaterthan atleast lowerthreshold",
    "max upper hi high maximum to below less lessthan atmost upperthreshold",
    "maximum max mip",
    "minimum min minip mini",
    "average mean avg",
    "sum additive total",
    "step stepsize dt stepsizes",
    "seeds seed source sources startpositions",
    "duration time length integrationtime maxtime",
    "background bg backgroundcolor",
    "view cameraposition cpos direction",
    "legend scalarbar colorbar colourbar",
    "scale log logscale norm",
    "shaded shade lighting lit",
    "method algorithm mode",
};

std::string plain(std::string_view name) {
  std::string text = to_lower(std::string(name));
  std::erase_if(text, [](char c) { return c == '_' || c == '-' || c == ' '; });
  return text;
}

}  // namespace

std::string same_word(std::string_view name, std::span<const std::string> candidates) {
  const std::string wanted = plain(name);
  for (const std::string_view meaning : meanings) {
    const auto all = words(meaning);
    if (std::find(all.begin(), all.end(), wanted) == all.end()) continue;
    for (const std::string_view word : all)
      for (const std::string& candidate : candidates)
        if (plain(candidate) == word) return candidate;
  }
  return "";
}

std::string other_word_hint(std::string_view name, std::span<const std::string> candidates) {
  const std::string same = same_word(name, candidates);
  if (same.empty() || !nearest_name(name, candidates).empty()) return unknown_name_hint(name, candidates);
  return fmt::format("here it is '{}'; {}", same, unknown_name_hint(name, candidates));
}

}  // namespace sg
