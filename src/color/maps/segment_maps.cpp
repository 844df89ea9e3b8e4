// SPDX-License-Identifier: Apache-2.0
// The places are those at which the channels of the original bend: Matplotlib's LinearSegmentedColormap definitions of that name (after
// MATLAB for hot and copper, gnuplot for gnuplot2 and afmhot, GIST for gist_heat); CMRmap: Rappaport 2002; hsv: the six corners of the hue
// circle.
#include "color/maps/segment_maps.h"

namespace sg {

namespace {

constexpr ColorStop hot[] = {{0, {0.0416f, 0, 0}}, {0.365079f, {1, 0, 0}}, {0.746032f, {1, 1, 0}}, {1, {1, 1, 1}}};
constexpr ColorStop copper[] = {{0, {0, 0, 0}}, {0.809524f, {1, 0.809524f * 0.7812f, 0.809524f * 0.4975f}}, {1, {1, 0.7812f, 0.4975f}}};
constexpr ColorStop afmhot[] = {{0, {0, 0, 0}}, {0.25f, {0.5f, 0, 0}}, {0.5f, {1, 0.5f, 0}}, {0.75f, {1, 1, 0.5f}}, {1, {1, 1, 1}}};
constexpr ColorStop gist_heat[] = {
    {0, {0, 0, 0}}, {0.5f, {0.75f, 0, 0}}, {2 / 3.f, {1, 1 / 3.f, 0}}, {0.75f, {1, 0.5f, 0}}, {1, {1, 1, 1}}};
constexpr ColorStop gnuplot2[] = {{0, {0, 0, 0}},           {0.25f, {0, 0, 1}}, {0.42f, {0.53125f, 0, 1}},
                                  {0.57f, {1, 0.3f, 0.7f}}, {0.92f, {1, 1, 0}}, {1, {1, 1, 1}}};
constexpr ColorStop cmrmap[] = {{0, {0, 0, 0}},
                                {0.125f, {0.15f, 0.15f, 0.5f}},
                                {0.25f, {0.3f, 0.15f, 0.75f}},
                                {0.375f, {0.6f, 0.2f, 0.5f}},
                                {0.5f, {1, 0.25f, 0.15f}},
                                {0.625f, {0.9f, 0.5f, 0}},
                                {0.75f, {0.9f, 0.75f, 0.1f}},
                                {0.875f, {0.9f, 0.9f, 0.5f}},
                                {1, {1, 1, 1}}};
constexpr ColorStop bwr[] = {{0, {0, 0, 1}}, {0.5f, {1, 1, 1}}, {1, {1, 0, 0}}};
constexpr ColorStop seismic[] = {{0, {0, 0, 0.3f}}, {0.25f, {0, 0, 1}}, {0.5f, {1, 1, 1}}, {0.75f, {1, 0, 0}}, {1, {0.5f, 0, 0}}};
constexpr ColorStop hsv[] = {{0, {1, 0, 0}},       {1 / 6.f, {1, 1, 0}}, {2 / 6.f, {0, 1, 0}}, {3 / 6.f, {0, 1, 1}},
                             {4 / 6.f, {0, 0, 1}}, {5 / 6.f, {1, 0, 1}}, {1, {1, 0, 0}}};
constexpr ColorStop terrain[] = {{0, {0.2f, 0.2f, 0.6f}}, {0.15f, {0, 0.6f, 1}},         {0.25f, {0, 0.8f, 0.4f}},
                                 {0.5f, {1, 1, 0.6f}},    {0.75f, {0.5f, 0.36f, 0.33f}}, {1, {1, 1, 1}}};

constexpr SegmentMap segments[] = {
    {"hot", MapKind::sequential, "Black over red and yellow to white (Matplotlib, after MATLAB).", hot},
    {"copper", MapKind::sequential, "Black to light copper (Matplotlib, after MATLAB).", copper},
    {"afmhot", MapKind::sequential, "Black over brown and orange to white (Matplotlib, after gnuplot).", afmhot},
    {"gist_heat", MapKind::sequential, "Black over dark red and orange to white (Matplotlib, after GIST).", gist_heat},
    {"gnuplot2", MapKind::sequential, "Black over blue, pink and yellow to white (Matplotlib, after gnuplot).", gnuplot2},
    {"CMRmap", MapKind::sequential, "Black over blue, red and yellow to white, made to print in grey (Rappaport 2002).", cmrmap},
    {"bwr", MapKind::diverging, "Pure blue over white to pure red (Matplotlib).", bwr},
    {"seismic", MapKind::diverging, "Dark blue over white to dark red, for amplitudes about zero (Matplotlib).", seismic},
    {"hsv", MapKind::unsafe, "HSV hues once round from red to red: its lightness rises and falls; for angles, phase and twilight are even.",
     hsv},
    {"terrain", MapKind::unsafe, "Blue, green, yellow, brown, white as on maps of land (Matplotlib): its lightness rises and falls.",
     terrain},
};

}  // namespace

std::span<const SegmentMap> segment_maps() { return segments; }

Colormap colormap_of(const SegmentMap& map) {
  Colormap made{std::string(map.name), map.kind, std::string(map.about), {}, {}};
  bool even = true;
  for (size_t i = 0; i < map.stops.size(); ++i) {
    const ColorStop& stop = map.stops[i];
    made.colors.push_back(stop.color), made.positions.push_back(double(stop.position));
    even = even && std::abs(double(stop.position) - double(i) / double(map.stops.size() - 1)) < 1e-6;
  }
  if (even) made.positions.clear();
  return made;
}

}  // namespace sg
