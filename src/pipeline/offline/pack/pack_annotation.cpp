// SPDX-License-Identifier: Apache-2.0
#include "pipeline/offline/pack/pack_annotation.h"

#include "pipeline/offline/pack/json_text.h"
#include "render/annotate/annotation_plan.h"

namespace sg::offline {

namespace {

constexpr int most_ticks = 7;  // of an axis: the page takes as many as have room

Json rect(const Rect& r) { return numbers({r.x, r.y, r.width, r.height}); }

Json pack_ticks(const std::vector<LegendLayout::Tick>& ticks, const ColorScale& s) {
  std::vector<Json> list;
  for (const auto& t : ticks)
    list.emplace_back(Json::Members{{"value", number(t.value)},
                                    {"text", text(t.text)},
                                    {"at", Json(double(t.row))},
                                    {"position", number(s.limits.empty() ? s.position(t.value) : -1)}});
  return Json(std::move(list));
}

// sRGB bytes, alpha 0 where nothing is drawn.
Json shown_color(Vec4f c) {
  std::vector<double> rgba;
  for (int k = 0; k < 3; ++k) rgba.push_back(double(uint8_t(255 * c[k] + 0.5f)));
  rgba.push_back(c.w > 0 ? 255 : 0);
  return numbers(rgba);
}

// The bar's colours, a pixel each, as the picture has them.
Json bar_colors(const ColorScale& s, const LegendLayout& l) {
  const int n = int(l.lies() ? l.bar.width : l.bar.height), first = int(l.lies() ? l.bar.x : l.bar.y);
  std::vector<double> rgba;
  for (int i = 0; i < n; ++i) {
    double value = s.value_at(n < 2 ? 0.5 : l.lies() ? double(i) / (n - 1) : 1 - double(i) / (n - 1));
    for (const auto& t : l.ticks)
      if (t.row == first + i && s.limits.empty()) value = t.value;
    const Vec4f c = s.color(value);
    for (int k = 0; k < 3; ++k) rgba.push_back(double(uint8_t(255 * c[k] + 0.5f)));
    rgba.push_back(c.w > 0 ? 255 : 0);
  }
  return numbers(rgba);
}

Json pack_legend(const Legend& s, const LegendLayout& l, ScaleStore& scales) {
  std::vector<Json> swatches;
  for (size_t i = 0; i < l.swatches; ++i) swatches.push_back(shown_color(s.color(s.labels[i])));
  Json::Members m{{"place", text(word_of(l.place))},
                  {"font", Json(l.font)},
                  {"column", rect(l.column)},
                  {"title", text(l.title)},
                  {"title_size", Json(l.title_style.size)},
                  {"title_wrap", Json(l.title_style.wrap)},
                  {"title_centred", Json(l.title_style.centred)},
                  {"title_upwards", Json(l.title_upwards)},
                  {"title_at", numbers({l.title_at.x, l.title_at.y})},
                  {"title_extent", numbers({l.title_size.width, l.title_size.height})},
                  {"bar", rect(l.bar)},
                  {"ticks", pack_ticks(l.ticks, s)},
                  {"rows", texts(l.rows)},
                  {"row_height", Json(l.row_height)},
                  {"row_width", Json(l.row_width)},
                  {"across", Json(uint64_t(l.across))},
                  {"swatches", Json(std::move(swatches))},
                  {"nan", Json(l.nan)},
                  {"nan_at", numbers({l.nan_at.x, l.nan_at.y})},
                  {"nan_color", shown_color(s.color_at(NAN))}};
  if (l.above) m.emplace_back("above", shown_color(s.color_at(2)));
  if (l.below) m.emplace_back("below", shown_color(s.color_at(-1)));
  if (l.swatches == 0) m.emplace_back("colors", bar_colors(s, l)), m.emplace_back("scale", Json(scales.add(s)));
  if (l.panel.width > 0 && s.volume && s.volume->detail.plain()) {
    std::vector<Json> points;
    for (const Vec2& p : s.volume->opacity.points) points.push_back(numbers({p.x, p.y}));
    m.emplace_back("panel", rect(l.panel)), m.emplace_back("opacity", Json(std::move(points)));
    m.emplace_back("panel_texts", texts({l.panel_left, l.panel_right, l.panel_caption}));
  }
  if (l.glyph.width > 0 && s.glyph) {
    m.emplace_back("glyph", rect(l.glyph)), m.emplace_back("glyph_text", text(l.glyph_text));
    m.emplace_back("glyph_arrow", Json(s.glyph->points)),
        m.emplace_back("glyph_color", shown_color(s.color(l.glyph.width / s.glyph->pixels)));
  }
  return Json(std::move(m));
}

// Of each axis of the box the round numbers for every count that may have room.
Json pack_axes(const Annotation& a) {
  std::vector<Json> axes;
  for (int axis = 0; axis < 3; ++axis) {
    const double stretch = a.stretch[axis];
    const auto [lo, hi] = std::minmax({a.box->lo[axis] / stretch, a.box->hi[axis] / stretch});
    std::vector<Json> counts;
    for (int wanted = 1; wanted <= most_ticks; ++wanted) {
      std::vector<Json> ticks;
      for (const TickLabel& t : nice_ticks(lo, hi, wanted))
        ticks.emplace_back(Json::Members{{"at", Json(t.value * stretch)}, {"text", text(typeset_number(t.text))}});
      counts.emplace_back(std::move(ticks));
    }
    std::string name = a.axis_titles[axis].empty() ? a.axis_names[axis] : a.axis_titles[axis];
    if (a.axis_titles[axis].empty() && !a.length_unit.empty()) name += (name.empty() ? "[" : " [") + a.length_unit + "]";
    axes.emplace_back(Json::Members{{"name", text(name)}, {"letter", text(a.axis_names[axis])}, {"ticks", Json(std::move(counts))}});
  }
  return Json(std::move(axes));
}

Json pack_notes(const Annotation& a) {
  std::vector<Json> list;
  for (const PictureNote& n : a.notes) {
    Json::Members m{{"text", text(n.text)}, {"place", text(word_of(n.place))}, {"size", Json(n.size)}};
    if (n.at) m.emplace_back("at", numbers({n.at->x, n.at->y}));
    if (n.color) m.emplace_back("color", numbers(*n.color));
    list.emplace_back(std::move(m));
  }
  return Json(std::move(list));
}

Json pack_texts(const Scene& scene) {
  std::vector<Json> list;
  for (const TextItem& t : scene.texts) {
    Json::Members m{{"text", text(typeset_number(t.text))}, {"at", numbers(t.at)}, {"along", numbers(t.along)}, {"size", Json(t.size)}};
    if (t.color) m.emplace_back("color", numbers(*t.color));
    list.emplace_back(std::move(m));
  }
  return Json(std::move(list));
}

}  // namespace

Json pack_annotation(const Panel& panel, const StatedPicture& stated, ScaleStore& scales) {
  Annotation a = panel.annotation;
  const Rect area = picture_beside_legends(a, stated);
  const Projection projection = make_projection(panel.camera, int(area.width), int(area.height));
  for (Legend& l : a.legends)
    if (l.glyph && a.box) {
      const double depth = projection.to_eye(a.box->center()).z;
      l.glyph->pixels = l.glyph->in_pixels    ? l.glyph->length
                        : projection.parallel ? l.glyph->length * projection.scale
                        : depth > 0           ? l.glyph->length * projection.scale / depth
                                              : 0;
    }
  const Overlay measuring(1, 1, a.dark_background);
  const AnnotationPlan plan = plan_annotation(measuring, a, stated.width, stated.height);
  std::vector<Json> legends;
  for (size_t i = 0; i < plan.legends.size(); ++i) legends.push_back(pack_legend(a.legends[i], plan.legends[i], scales));
  Json::Members m{{"width", Json(double(stated.width))},
                  {"height", Json(double(stated.height))},
                  {"area", rect(area)},
                  {"font", Json(plan.font)},
                  {"title", text(a.title)},
                  {"title_size", Json(plan.title_style.size)},
                  {"title_box", rect(plan.title)},
                  {"caption", text(a.caption)},
                  {"caption_height", Json(plan.caption)},
                  {"axes", Json(a.axes)},
                  {"triad", Json(a.triad)},
                  {"letters", Json(a.patient_letters)},
                  {"scale_bar", Json(a.scale_bar)},
                  {"unit", text(a.length_unit)},
                  {"stretch", numbers(a.stretch)},
                  {"dark", Json(a.dark_background)},
                  {"legends", Json(std::move(legends))},
                  {"notes", pack_notes(a)},
                  {"texts", pack_texts(panel.scene)}};
  if (a.box)
    m.emplace_back("box", numbers({a.box->lo.x, a.box->lo.y, a.box->lo.z, a.box->hi.x, a.box->hi.y, a.box->hi.z})),
        m.emplace_back("axis", pack_axes(a));
  if (panel.box_behind) m.emplace_back("box_behind", Json(true));
  return Json(std::move(m));
}

Json pack_camera(const Camera& c) {
  return Json(Json::Members{{"position", numbers(c.position)},
                            {"target", numbers(c.target)},
                            {"up", numbers(c.up)},
                            {"angle", Json(c.view_angle)},
                            {"parallel", Json(c.parallel)},
                            {"height", Json(c.parallel_height)}});
}

Json pack_views(const Panel& panel) {
  Box3 box;
  box.add(Vec3{-1, -1, -1}), box.add(Vec3{1, 1, 1});
  Json::Members views;
  for (const auto& word : enum_words(NamedView())) {
    CameraParams params;
    params.view = word.value;
    const Camera c = make_camera(params, box, 1, panel.around, 0.1);
    views.emplace_back(std::string(word.word),
                       Json(Json::Members{{"direction", numbers(normalize(c.position - c.target))}, {"up", numbers(c.up)}}));
  }
  return Json(std::move(views));
}

}  // namespace sg::offline
