// SPDX-License-Identifier: Apache-2.0
#include "scene/show/glyphs.h"

#include <fmt/core.h>

#include "base/text/text.h"
#include "color/parse_color.h"
#include "scene/choose/scale.h"

namespace sg {

namespace {

// The field that colours the glyphs, in the input; null for one colour.
const Field* color_field(const Dataset& input, const GlyphsShow& p, const ChosenGlyphs& c) {
  if (!p.coloring.color.empty() || p.coloring.field.none()) return nullptr;
  if (!p.coloring.field.empty()) {
    const Field& f = input.fields().require(p.coloring.field.name);
    if (f.association == Association::whole)
      fail_usage(fmt::format("field '{}' belongs to the whole dataset, not to points or cells", f.name), "field");
    return &f;
  }
  if (c.barbs) return nullptr;
  if (!c.vectors.empty()) return input.fields().find(c.vectors);
  if (c.rule.size == GlyphRule::Size::field) return input.fields().find(c.rule.size_field);
  return automatic_field(input);
}

// Mostly: black on it is harder to see than white.
bool is_dark(const Colormap& map) {
  float sum = 0;
  for (int k = 0; k <= 16; ++k) {
    const Vec3f q = map.at(double(k) / 16);
    sum += 0.3f * q.x + 0.59f * q.y + 0.11f * q.z;
  }
  return sum / 17 < 0.5f;
}

// The colours end where the values at the glyphs do; a peak between them is told.
void tell_range(const Dataset& input, const Field& f, int component, const ColorScale& s, const Context& context) {
  const Range all = input.range(f, component);
  const double slack = 0.02 * (all.hi - all.lo);
  if (all.empty() || !s.labels.empty() || (s.lo <= all.lo + slack && s.hi >= all.hi - slack)) return;
  context.info(fmt::format("glyphs: the colours are of {} to {}, the values at the glyphs; '{}' goes from {} to {} (range= takes others)",
                           short_number(s.lo, 3), short_number(s.hi, 3), f.name, short_number(all.lo, 3), short_number(all.hi, 3)));
}

}  // namespace

void describe(Schema& s, GlyphsShow& p) {
  describe(s, p.glyphs);
  describe(s, p.coloring);
  s("opacity", p.opacity, "Opacity: 1 is opaque, 0 invisible.").range(0, 1);
  s("width", p.width, "Line width of barbs and of shape=line.").unit("pixels").positive();
  s("lit", p.lit, "Light the shapes; false shows unlit colours.");
  s("pixels", p.pixels, "Sizes are in pixels, the same at any distance; always so for barbs.");
  describe(s, p.material);
}

const Field* automatic_field(const GlyphsShow& p, const Dataset& d) {
  if (p.material.has_color() || known_shape(p.glyphs.shape) == GlyphShape::barbs) return nullptr;
  return p.glyphs.vectors.empty() ? automatic_vectors(d) : d.fields().find(p.glyphs.vectors.name);
}

std::optional<Legend> add(Scene& scene, const DatasetPtr& input, const GlyphsShow& p, Context& context) {
  const bool in_pixels = p.pixels || (known_shape(p.glyphs.shape) == GlyphShape::barbs && p.glyphs.factor == 0);
  ChosenGlyphs c = choose_glyphs(input, p.glyphs, in_pixels, context);
  context.info(c.note);
  GlyphsItem item;
  item.data = c.data, item.shapes = c.shapes, item.rule = c.rule, item.in_pixels = in_pixels;
  item.opacity = p.opacity, item.line_width = p.width;
  item.material.lit = p.lit && !c.flat;
  item.color = c.flat ? Vec3f{0.13f, 0.14f, 0.18f} : item.color;
  take(p.material, *input, item);
  if (!p.coloring.color.empty()) item.color = parse_color(p.coloring.color, "color");
  std::optional<Legend> legend;
  // Flat ones on a coloured surface are read by their shape: a second scale on the first would hide them.
  const ColorScale* beneath = nullptr;
  for (const Item& i : scene.items)
    if (const auto* s = std::get_if<SurfaceItem>(&i); s && s->color_by && !s->color_by->direct) beneath = &s->color_by->scale;
  const bool no_field = p.coloring.field.empty(), of_matter = p.material.has_color();
  const bool on_colors = beneath && c.flat && no_field && !of_matter, one_color = on_colors || (of_matter && no_field);
  if (on_colors && p.coloring.color.empty() && is_dark(beneath->map)) item.color = {1, 1, 1};
  if (const Field* f = one_color ? nullptr : color_field(*input, p, c)) {
    FieldColor color;
    color.field = f->name, color.component = p.coloring.component;
    color.direct = is_direct_color(*f) && !p.coloring.map && p.coloring.component < 0;
    if (!color.direct) {
      // The range of what is drawn: a peak between the places would leave all of them in one colour.
      const Field* drawn = c.data->fields().find(f->name, Association::point);
      color.scale = drawn ? choose_scale(*c.data, *drawn, p.coloring, context) : choose_scale(*input, *f, p.coloring, context);
      if (drawn && p.coloring.range.empty()) tell_range(*input, *f, p.coloring.component, color.scale, context);
      legend = color.scale;
      if (c.of > 0) {
        const bool by_length = c.rule.size == GlyphRule::Size::length;
        const Field* by = c.data->fields().find(by_length ? c.rule.vectors : c.rule.size_field);
        legend->glyph = GlyphLegend{c.longest / c.of, in_pixels, by_length, c.of, by ? by->unit : "", 0};
      }
    }
    item.color_by = std::move(color);
  }
  scene.items.emplace_back(std::move(item));
  return legend;
}

}  // namespace sg
