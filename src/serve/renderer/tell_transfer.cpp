// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/tell_transfer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "scene/choose/histogram.h"
#include "serve/renderer/tell.h"

namespace sg::serve {

namespace {

constexpr int color_samples = 256, lightness_samples = 64;
constexpr size_t bins = 256;

std::string hex(Vec3f c) {
  const auto byte = [](float v) { return int(255 * std::clamp(v, 0.0f, 1.0f) + 0.5f); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(c.x), byte(c.y), byte(c.z));
}

struct Coloring {
  const Dataset* data;
  std::string field;
  Association association;
  int component;
  const ColorScale* scale;
  const VolumeItem* volume;
};

// Of an item that is coloured by a field.
std::optional<Coloring> coloring_of(const Item& item) {
  if (const auto* v = std::get_if<VolumeItem>(&item)) return Coloring{v->data.get(), v->field, v->association, v->component, &v->color, v};
  return std::visit(
      [](const auto& i) -> std::optional<Coloring> {
        if constexpr (requires { i.color_by; }) {
          if (!i.color_by || i.color_by->direct) return std::nullopt;
          return Coloring{i.data.get(), i.color_by->field, i.color_by->association, i.color_by->component, &i.color_by->scale, nullptr};
        }
        return std::nullopt;
      },
      item);
}

Json histogram_json(const Coloring& c, Context& context) {
  const Field* field = c.data->fields().find(c.field, c.association);
  if (!field) return {};
  const Range range = c.data->range(*field, c.component);
  if (range.empty() || !(range.lo < range.hi)) return {};
  std::vector<Json> counts;
  for (const size_t n : histogram(*c.data, *field, c.component, range.lo, range.hi, bins, context)) counts.emplace_back(uint64_t(n));
  return Json(Json::Members{{"range", numbers({range.lo, range.hi})}, {"counts", Json(std::move(counts))}});
}

Json transfer_json(const Coloring& c, Context& context) {
  const ColorScale& scale = *c.scale;
  std::vector<Json> colors, lightness;
  for (int i = 0; i < color_samples; ++i) {
    const Vec4f v = scale.color_at(i / double(color_samples - 1));
    colors.push_back(text(hex({v.x, v.y, v.z})));
  }
  for (const double l : lightness_report(scale.map, lightness_samples).lightness) lightness.push_back(number(l / 100));
  const Field* field = c.data->fields().find(c.field, c.association);
  Json::Members t{{"field", text(c.field)},
                  {"unit", text(field ? field->unit : "")},
                  {"range", numbers({scale.lo, scale.hi})},
                  {"scale", text(std::string(word_of(scale.kind)))},
                  {"map", text(scale.map.name)},
                  {"colors", Json(std::move(colors))},
                  {"lightness", Json(std::move(lightness))},
                  {"histogram", histogram_json(c, context)}};
  if (c.volume) {
    std::vector<Json> points;
    for (const Vec2& p : c.volume->opacity.points) points.push_back(numbers({p.x, p.y}));
    t.emplace_back("opacity", Json(std::move(points)));
    t.emplace_back("opacity_unit", number(c.volume->unit_distance));
  }
  return Json(std::move(t));
}

}  // namespace

Json tell_transfer(const PreparedPicture& prepared, uint32_t show, Context& context) {
  for (const Shown& s : prepared.shown)
    for (size_t i = 0; i < s.scene.items.size() && i < s.scene.shows.size(); ++i) {
      if (s.scene.shows[i] != show) continue;
      if (const auto coloring = coloring_of(s.scene.items[i])) return transfer_json(*coloring, context);
    }
  return {};
}

}  // namespace sg::serve
