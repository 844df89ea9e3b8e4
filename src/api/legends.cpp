// SPDX-License-Identifier: Apache-2.0
// What the legends of a picture say, as numbers.
#include <algorithm>
#include <cmath>

#include "api/held.h"

namespace sightglass {

namespace {

std::array<uint8_t, 3> bytes_of(sg::Vec4f srgb) {
  const auto byte = [](float v) { return uint8_t(std::lround(std::clamp(v, 0.0f, 1.0f) * 255)); };
  return {byte(srgb.x), byte(srgb.y), byte(srgb.z)};
}

Legend told(const sg::Legend& of) {
  constexpr int samples = 256;
  Legend legend{of.title, of.unit, std::string(sg::word_of(of.kind)), of.lo, of.hi, {}, {}, {}};
  for (size_t i = 0; i < of.labels.size(); ++i)
    legend.entries.push_back({of.labels[i], i < of.label_names.size() ? of.label_names[i] : "", bytes_of(of.color(of.labels[i]))});
  for (int i = 0; i < samples && legend.entries.empty(); ++i) legend.colors.push_back(bytes_of(of.color_at(i / (samples - 1.0))));
  if (of.volume)
    for (const sg::Vec2& p : of.volume->opacity.points) legend.opacity.emplace_back(p.x, p.y);
  return legend;
}

}  // namespace

std::vector<Legend> told_legends(const std::vector<sg::Legend>& legends) {
  std::vector<Legend> all;
  for (const sg::Legend& l : legends) all.push_back(told(l));
  return all;
}

}  // namespace sightglass
