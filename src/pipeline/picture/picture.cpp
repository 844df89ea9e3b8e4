// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/picture.h"

#include <fmt/core.h>

#include "base/all_ranks.h"
#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "color/parse_color.h"
#include "data/ranks/over_all.h"
#include "pipeline/file/transfer_file.h"
#include "pipeline/film/film_params.h"
#include "pipeline/picture/picture_parts.h"
#include "scene/show/outline.h"
#include "scene/show/parts.h"
#include "scene/show/volume.h"

namespace sg {

void describe(Schema& s, PictureParams& p) {
  s("size", p.size, "Width and height in pixels, e.g. 1920x1080.");
  s("background", p.background, "Background colour, two colours bottom/top for a gradient, or 'transparent'.");
  s("title", p.title, "Title above the picture.");
  s("legend", p.legend, "Draw the colour legends.");
  s("axes", p.axes, "Draw the bounding box with numbers.");
  s("triad", p.triad, "Draw the orientation axes.");
  s("samples", p.samples, "Samples per pixel and axis; 0 chooses 2 for surfaces, 1 for volumes.").range(0, 4);
  s("adaptive", p.adaptive,
    "Above 0: take all samples only where neighbouring pixels differ by more than this share of full scale; 0: take all of them "
    "everywhere.")
      .range(0, 1);
  s("text", p.text, "Scale factor of all text.").range(0.2, 10);
}

void parse_size(const std::string& text, int& width, int& height) {
  const auto parts = split(text, 'x');
  const auto w = parts.size() == 2 ? parse_int(parts[0]) : std::nullopt, h = parts.size() == 2 ? parse_int(parts[1]) : std::nullopt;
  if (!w || !h || *w < 1 || *h < 1 || *w > 32768 || *h > 32768)
    fail_usage(fmt::format("'{}' is not a size", text), "size", "write width x height from 1 to 32768, e.g. 1280x720");
  width = int(*w), height = int(*h);
}

PipelineVocabulary picture_vocabulary() {
  PipelineVocabulary v;
  v.show = {std::string(auto_show)};
  for (const ShowKind& k : show_kinds()) v.show.emplace_back(k.name);
  v.picture = {"camera"};
  const auto add = [&](const Schema& schema) {
    for (const ParamDecl& d : schema.decls()) v.picture.push_back(d.name);
  };
  FilmParams film;
  add(schema_of(film));
  PictureParams p;
  add(schema_of(p));
  return v;
}

StatedPicture stated_in(const PipelineFile& file) {
  StatedPicture s;
  std::vector<std::string> words;
  for (const std::string& w : file.picture)
    if (!w.starts_with("camera.") && !w.starts_with("camera=") && !is_film_word(w)) words.push_back(w);
  Schema schema = schema_of(s.picture);
  set_params(schema, words, "picture");
  Schema camera = schema_of(s.camera);
  std::vector<std::string> camera_list = words_under(file.picture, "camera");
  if (const auto whole = word_value(file.picture, "camera")) camera_list = quoted_words(*whole);
  set_params(camera, camera_words(camera_list), "camera");
  parse_size(s.picture.size, s.width, s.height);
  if (s.picture.background == "transparent") {
    s.transparent = true;
  } else {
    const auto parts = split(s.picture.background, '/');
    if (parts.empty() || parts.size() > 2)
      fail_usage(fmt::format("'{}' is not a background", s.picture.background), "background", "write e.g. white, or white/skyblue");
    s.bottom = parse_color(parts[0], "background");
    if (parts.size() == 2) s.top = parse_color(parts[1], "background");
  }
  return s;
}

namespace {

// One entry under `show`, with its parameters.
struct StatedShow {
  const ShowKind* kind;
  ParamSet params;
};

// All mistakes at once, each with its line.
std::vector<StatedShow> stated_shows(const PipelineFile& file) {
  std::vector<StatedShow> shows;
  std::string problems;
  for (const auto& s : file.show) {
    if (s.kind == auto_show) continue;
    try {
      const ShowKind& kind = find_show(s.kind);
      shows.push_back({&kind, show_params(kind, s.words)});
    } catch (const Error& e) {
      problems += (problems.empty() ? "" : "; ") + std::string(s.line > 0 ? fmt::format("{}:{}: ", file.origin, s.line) : "") + e.what();
    }
  }
  if (!problems.empty()) fail_usage(problems);
  return shows;
}

bool has_nan(const Scene& scene) {
  for (const Item& item : scene.items) {
    const bool nan = std::visit(
        [](const auto& i) {
          using T = std::remove_cvref_t<decltype(i)>;
          const Field* f = nullptr;
          if constexpr (std::is_same_v<T, VolumeItem>) return false;  // seen through, not painted
          else {
            if (i.color_by && !i.color_by->direct) f = i.data->fields().find(i.color_by->field, i.color_by->association);
            return f && i.data->stats(*f).nan > 0;
          }
        },
        item);
    if (nan) return true;
  }
  return false;
}

// The combined results of all shows.
struct Shown {
  Scene scene;
  std::vector<Legend> legends;  // each once
  Box3 box;
  bool outlined = false, any_points = false;
};

Shown collect(const PipelineFile& file, const std::vector<StatedShow>& shows, const std::vector<Data>& results, bool legends,
              Context& context) {
  Shown s;
  for (size_t i = 0; i < results.size(); ++i) {
    const auto& [kind, params] = shows[i];
    s.outlined = s.outlined || kind->is<OutlineShow>();
    if (std::holds_alternative<TablePtr>(results[i]))
      fail_no_mesh(results[i], file_name_of(origin_of(file, file.show[i].of.empty() ? file.steps.back().name : file.show[i].of)));
    std::vector<DatasetPtr> parts;
    for_each_dataset(results[i], [&](const std::string&, const DatasetPtr& d) {
      parts.push_back(d);
      s.any_points = s.any_points || d->point_count() > 0;
      s.box.add(d->bounds());
    });
    const size_t first = s.scene.items.size();
    for (const Legend& legend : show_parts(s.scene, parts, *kind, params, uint32_t(i + 1), context)) {
      if (!legends) continue;
      const auto have = std::find_if(s.legends.begin(), s.legends.end(), [&](const Legend& l) { return same_legend(l, legend); });
      if (have == s.legends.end()) s.legends.push_back(legend);
      else if (legend.glyph && (!have->glyph || have->glyph->most < legend.glyph->most)) have->glyph = legend.glyph;
    }
    if (!kind->is<VolumeShow>() || s.scene.items.size() == first) continue;
    if (const std::string& path = params.as<VolumeShow>().save; !path.empty())
      save_transfer_file(path_beside(file.origin, path), std::get<VolumeItem>(s.scene.items.back()));
  }
  return s;
}

Annotation annotation_of(const StatedPicture& stated, const Shown& shown, const Look& look) {
  Annotation a;
  a.legends = shown.legends;
  a.title = stated.picture.title;
  a.triad = stated.picture.triad && shown.any_points && !look.parallel;  // a map needs none: its axes are named
  a.scale = stated.picture.text;
  const double brightness = 0.2126 * stated.bottom.x + 0.7152 * stated.bottom.y + 0.0722 * stated.bottom.z;
  a.dark_background = !stated.transparent && brightness < 0.45;
  a.show_nan_in_legend = has_nan(shown.scene);
  if (stated.picture.axes && !shown.box.empty()) a.box = shown.box;
  return a;
}

}  // namespace

Picture make_picture(PipelineFile& file, const PictureOptions& options, Context& context) {
  const StatedPicture stated = stated_in(file);
  load_transfer_files(file);
  stated_shows(file);  // mistakes are reported before anything runs
  const auto cache = options.cache ? options.cache : std::make_shared<Cache>(0);
  std::vector<Data> held;
  Picture picture;
  Look look = choose_looks(file, options, cache, held, picture.notes, context);
  const std::vector<StatedShow> shows = stated_shows(file);

  GraphOptions graph_options;
  graph_options.cache = cache;
  const PipelineGraph built = build_graph(file, graph_options, options.results);
  std::vector<Target> targets;
  for (NodeId node : built.show) targets.push_back({node, {}});
  const std::vector<Data> results = built.graph.evaluate(targets, context);
  held.clear();

  // What the notes already say, or several parts say alike, is given once.
  Context once(context, 0, 1);
  std::vector<std::string> said = picture.notes;
  once.on_log = [&](LogLevel level, std::string_view text) {
    if (std::any_of(said.begin(), said.end(), [&](const std::string& s) { return s.find(text) != s.npos; })) return;
    said.emplace_back(text);
    context.log(level, text);
  };
  Shown shown = collect(file, shows, results, stated.picture.legend, once);
  const Box3 box = over_all(shown.box, context);
  shown.any_points = all_most(int(shown.any_points), context.communicator) > 0;
  if (!shown.any_points) context.warn("the picture is empty: there are no points to show");
  if (!file.show.empty() && look.shows.empty())
    choose_view(box, extension_of(origin_of(file, file.show[0].of.empty() ? file.steps.back().name : file.show[0].of)), look);
  Scene& scene = shown.scene;
  scene.background = stated.bottom, scene.background_top = stated.top, scene.transparent = stated.transparent;
  const Annotation annotation = annotation_of(stated, shown, look);
  const double aspect = double(std::max(1, width_beside_legends(annotation, stated))) / stated.height;
  Camera camera = make_camera(stated.camera, box, aspect, look.direction, look.up, look.parallel, stated.picture.axes ? 0.11 : 0.05);
  Box3 all = scene_bounds(scene);  // glyphs reach beyond the data
  all.add(box);
  fit_planes(camera, all);
  if (stated.picture.axes && !shown.outlined && !box.empty()) scene.items.emplace_back(back_edges(box, camera));
  draw_drafts(scene, camera, stated, annotation, options, picture, context);
  return picture;
}

}  // namespace sg
