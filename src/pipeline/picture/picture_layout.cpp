// SPDX-License-Identifier: Apache-2.0
// Several panels in one picture, with one title and one legend.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "io/lent_series.h"
#include "pipeline/picture/picture_parts.h"
#include "render/render.h"

namespace sg {

namespace {

// What a layout may be but numbers.
enum class LayoutWord { automatic };
constexpr auto enum_words(LayoutWord) { return std::array{Word{"auto", LayoutWord::automatic}}; }

struct Layout {
  int columns, rows;
};

// With 'auto' the panels are as nearly square as they can be.
Layout layout_of(const PictureParams& p, size_t count, const Rect& area) {
  const auto n = int(count);
  if (p.layout.empty() || value_of_word<LayoutWord>(p.layout)) {
    Layout best{n, 1};
    double least = HUGE_VAL;
    for (int columns = 1; columns <= n; ++columns) {
      const int rows = (n + columns - 1) / columns;
      const double shape = std::abs(std::log((area.width / columns) / (area.height / rows))) + 0.3 * (columns * rows - n);
      if (shape < least) least = shape, best = {columns, rows};
    }
    return best;
  }
  const auto parts = split(p.layout, 'x');
  const auto columns = parts.size() == 2 ? parse_int(parts[0]) : std::nullopt,
             rows = parts.size() == 2 ? parse_int(parts[1]) : std::nullopt;
  if (!columns || !rows || *columns < 1 || *rows < 1 || *columns > 100 || *rows > 100)
    fail_usage(fmt::format("'{}' is not a layout", p.layout), "layout", "write columns x rows, e.g. 2x2, or auto");
  if (size_t(*columns * *rows) < count)
    fail_usage(fmt::format("{} has no place for {} panels", p.layout, count), "layout", "write auto, or more columns or rows");
  return {int(*columns), int(*rows)};
}

// The step that begins the chain of the i-th show.
std::string base_of(const PipelineFile& file, size_t i) { return steps_behind(file, shown_step(file, i)).back()->name; }

void paste(const Image& from, Image& to, int x0, int y0) {
  for (int y = 0; y < from.height; ++y) std::copy_n(from.at(0, y), size_t(from.width) * size_t(from.channels), to.at(x0, y0 + y));
}

}  // namespace

const std::string& shown_step(const PipelineFile& file, size_t i) {
  return file.show[i].of.empty() ? file.steps.back().name : file.show[i].of;
}

bool in_panels(const PictureParams& p) { return !p.layout.empty() || !p.views.empty(); }

std::vector<size_t> panels_of(const PipelineFile& file, const PictureParams& p) {
  std::vector<size_t> r(file.show.size(), 0);
  if (!in_panels(p) || !p.views.empty()) return r;
  std::vector<std::string> bases;
  for (size_t i = 0; i < r.size(); ++i) {
    const std::string base = base_of(file, i);
    const auto at = std::find(bases.begin(), bases.end(), base);
    r[i] = size_t(at - bases.begin());
    if (at == bases.end()) bases.push_back(base);
  }
  return r;
}

std::string panel_title(const PipelineFile& file, size_t panel) {
  PictureParams inputs;
  inputs.layout = "auto";
  const std::vector<size_t> panels = panels_of(file, inputs);
  const auto i = size_t(std::find(panels.begin(), panels.end(), panel) - panels.begin());
  const std::string origin = origin_of(file, shown_step(file, i));
  std::string time;  // tells panels of one series apart
  for (const PipelineFile::Step* step : steps_behind(file, shown_step(file, i)))
    if (const auto stated = word_value(step->words, "time"); stated && step->reads()) time = "t = " + *stated;
  const std::string name = is_lent(origin) ? "" : origin.empty() ? base_of(file, i) : file_name_of(origin);
  return name.empty() ? time : time.empty() ? name : name + ", " + time;
}

NamedView view_named(const std::string& word) {
  if (const auto view = value_of_word<NamedView>(word)) return *view;
  std::vector<std::string> known;
  for (const auto& w : enum_words(NamedView())) known.emplace_back(w.word);
  fail_usage(fmt::format("'{}' is not a view", word), "views", unknown_name_hint(word, known));
}

StatedPicture inside_layout(const StatedPicture& stated, const Annotation& around, size_t count) {
  const Rect area = area_beside(around, stated.width, stated.height);
  const Layout layout = layout_of(stated.picture, count, area);
  StatedPicture s = stated;
  s.width = std::max(1, int(area.width) / layout.columns), s.height = std::max(1, int(area.height) / layout.rows);
  s.picture.title.clear(), s.picture.caption.clear(), s.notes.clear();
  s.picture.light.seconds /= double(count);
  return s;
}

DrawnPicture draw_layout(const std::vector<NamedPanel>& panels, const StatedPicture& stated, const StatedPicture& inside,
                         const Annotation& around, const DrawHow& how, Context& context) {
  check_picture_memory(stated.width, stated.height, 2);
  const Rect area = area_beside(around, stated.width, stated.height);
  const int columns = std::max(1, int(area.width) / inside.width);
  // What lies around the panels: their background.
  RenderOptions options;
  options.width = stated.width, options.height = stated.height, options.samples = 1;
  Scene empty;
  empty.background = stated.bottom, empty.background_top = stated.top, empty.transparent = stated.transparent;
  Frame frame = render(empty, panels[0].panel.camera, options, context);
  Image whole = to_image(frame, stated.transparent);
  LightPlanes light;
  for (size_t i = 0; i < panels.size(); ++i) {
    Annotation annotation = panels[i].panel.annotation;
    annotation.title = panels[i].title;
    Context part(context, double(i) / double(panels.size()), double(i + 1) / double(panels.size()));
    const DrawnPicture drawn = draw_picture(panels[i].panel.scene, panels[i].panel.camera, inside, annotation, how, part);
    const int x0 = int(area.x) + int(i) % columns * inside.width, y0 = int(area.y) + int(i) / columns * inside.height;
    paste(drawn.image, whole, x0, y0);
    for (int y = 0; y < inside.height && y0 + y < stated.height && x0 + inside.width <= stated.width; ++y) {
      const size_t from = size_t(y) * size_t(inside.width), to = size_t(y0 + y) * size_t(stated.width) + size_t(x0);
      std::copy_n(&drawn.seen.depth[from], inside.width, &frame.depth[to]),
          std::copy_n(&drawn.seen.show[from], inside.width, &frame.ids[to]);
      if (drawn.seen.light.error.empty()) continue;
      if (light.error.empty()) light.error.assign(frame.pixels(), 0);
      std::copy_n(&drawn.seen.light.error[from], inside.width, &light.error[to]);
    }
  }
  Annotation rest;
  rest.title = around.title, rest.caption = around.caption, rest.notes = around.notes, rest.legends = around.legends,
  rest.show_nan_in_legend = around.show_nan_in_legend;
  rest.dark_background = around.dark_background, rest.scale = around.scale, rest.triad = false;
  annotate(whole, rest, make_projection(panels[0].panel.camera, stated.width, stated.height));
  return {std::move(whole), {std::move(frame.depth), std::move(frame.ids), std::move(light), {}}, {}};
}

}  // namespace sg
