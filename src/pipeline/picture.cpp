// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture.h"

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"
#include "color/parse_color.h"
#include "filter/glyph/choose.h"
#include "pipeline/picture_parts.h"
#include "pipeline/transfer_file.h"
#include "scene/field_habits.h"
#include "scene/glyph_parts.h"
#include "scene/volume_parts.h"

namespace sg {

void describe(Schema& s, PictureParams& p) {
  s("size", p.size, "Width and height in pixels, like 1920x1080.");
  s("background", p.background, "Colour behind everything, two colours bottom/top for a gradient, or 'transparent'.");
  s("title", p.title, "Text above the picture.");
  s("legend", p.legend, "Draw the legends of colours.");
  s("axes", p.axes, "Draw the bounding box with numbers.");
  s("triad", p.triad, "Draw the orientation axes.");
  s("samples", p.samples, "Samples per pixel and axis; 0 chooses 2 for surfaces, 1 for volumes.").range(0, 4);
  s("adaptive", p.adaptive,
    "Above 0: all samples only where neighbouring pixels differ by more than this share of full scale; 0 takes all of them everywhere.")
      .range(0, 1);
  s("text", p.text, "Size factor of all text.").range(0.2, 10);
}

void parse_size(const std::string& text, int& width, int& height) {
  const auto parts = split(text, 'x');
  const auto w = parts.size() == 2 ? parse_int(parts[0]) : std::nullopt, h = parts.size() == 2 ? parse_int(parts[1]) : std::nullopt;
  if (!w || !h || *w < 1 || *h < 1 || *w > 32768 || *h > 32768)
    fail_usage(fmt::format("'{}' is not a size", text), "size", "write width x height from 1 to 32768, like 1280x720");
  width = int(*w), height = int(*h);
}

PipelineVocabulary picture_vocabulary() {
  PipelineVocabulary v;
  v.show.clear();
  for (const ShowKind& k : show_kinds()) v.show.emplace_back(k.name);
  v.picture = {"camera", "output", "times", "fps"};
  PictureParams p;
  const Schema schema = schema_of(p);
  for (const ParamDecl& d : schema.decls()) v.picture.push_back(d.name);
  return v;
}

StatedPicture stated_in(const PipelineFile& file) {
  constexpr std::string_view elsewhere[] = {"camera.", "camera=", "output=", "times=", "fps="};
  StatedPicture s;
  std::vector<std::string> words;
  for (const std::string& w : file.picture)
    if (std::none_of(std::begin(elsewhere), std::end(elsewhere), [&](std::string_view e) { return w.starts_with(e); })) words.push_back(w);
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
      fail_usage(fmt::format("'{}' is not a background", s.picture.background), "background", "like white, or white/skyblue");
    s.bottom = parse_color(parts[0], "background");
    if (parts.size() == 2) s.top = parse_color(parts[1], "background");
  }
  return s;
}

namespace {

void check_shows(const PipelineFile& file) {
  std::string problems;
  for (const auto& s : file.show) {
    try {
      find_show(s.kind).check(s.words);
    } catch (const Error& e) {
      problems += (problems.empty() ? "" : "; ") + std::string(s.line > 0 ? fmt::format("{}:{}: ", file.origin, s.line) : "") + e.what();
    }
  }
  if (!problems.empty()) fail_usage(problems);
}

bool same_legend(const Legend& a, const Legend& b) {
  return a.title == b.title && a.map.name == b.map.name && a.lo == b.lo && a.hi == b.hi && a.kind == b.kind && a.labels == b.labels &&
         a.limits == b.limits && (!a.glyph || !b.glyph || a.glyph->length == b.glyph->length);
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

// What the results of all shows come to.
struct Shown {
  Scene scene;
  std::vector<Legend> legends;  // each once
  Box3 box;
  bool outlined = false, any_points = false;
};

// The parts of a collection are one picture: the same field, over the range of all parts. Parts without the field take one colour.
std::vector<std::vector<std::string>> words_of_parts(const std::vector<DatasetPtr>& parts, const PipelineFile::Show& show) {
  std::vector<std::vector<std::string>> words(parts.size(), show.words);
  if (parts.size() < 2 || !colors_by_field(show.kind) || word_value(show.words, "color")) return words;
  std::string name = word_value(show.words, "field").value_or("");
  if (name == "none") return words;
  const bool by_vectors = show.kind == "glyphs" && name.empty();  // they choose their field themselves: here the range alone
  if (by_vectors && word_value(show.words, "shape").value_or("") == "barbs") return words;
  if (by_vectors) name = word_value(show.words, "vectors").value_or("");
  std::vector<size_t> by_size(parts.size());
  std::iota(by_size.begin(), by_size.end(), size_t(0));
  std::stable_sort(by_size.begin(), by_size.end(), [&](size_t a, size_t b) { return parts[a]->point_count() > parts[b]->point_count(); });
  for (const bool labels : {false, true})  // a mask or a numbering of the largest part says less than values of another
    for (const size_t i : by_size)
      if (name.empty())
        if (const Field* f = by_vectors ? automatic_vectors(*parts[i]) : automatic_field(*parts[i]);
            f && (labels || f->role != Role::labels))
          name = f->name;
  if (name.empty()) return words;
  if (name == "band" && is_banded(*parts[by_size[0]])) name = "band low";  // bands of parts differ; their values can be compared
  const int component = int(parse_int(word_value(show.words, "component").value_or("-1")).value_or(-1));
  Range all;
  bool same = true;
  std::vector<FieldOf> fields;
  for (const DatasetPtr& d : parts)
    if (const Field* f = d->fields().find(name); f && f->association != Association::whole) {
      const Range r = d->range(*f, f->components() > 1 ? component : 0);
      same = same && (fields.empty() || r == all);
      all.add(r), fields.push_back({d.get(), f});
    }
  if (fields.empty()) return words;  // the show says what there is instead
  // What choose_scale() does for one mesh, decided once for all.
  const std::string scale = word_value(show.words, "scale").value_or("linear");
  const bool automatic = word_value(show.words, "map").value_or("auto") == "auto" && scale != "log";
  const bool is_signed = two_sided(*fields[0].field, all);
  const std::string map = is_signed ? "coolwarm" : "sight";
  ShownRange shown{all};
  if (automatic && scale == "linear") shown = shown_range(fields, component, is_signed);
  else if (automatic && is_signed) shown.range.hi = std::max(-all.lo, all.hi), shown.range.lo = -shown.range.hi;
  const auto triangle = [&](std::vector<std::string>& w, std::string_view word, double at) {  // in the legend
    if (!word_value(show.words, word)) w.push_back(fmt::format("{}={}", word, color_text(find_colormap(map).at(at))));
  };
  for (size_t i = 0; i < parts.size(); ++i) {
    const Field* f = parts[i]->fields().find(name);
    if (!by_vectors) {
      std::erase_if(words[i], [](const std::string& w) { return w.starts_with("field="); });
      words[i].push_back("field=" + (f ? name : std::string("none")));
    }
    const bool cut = shown.cut_low || shown.cut_high;
    if (!f || (same && !cut) || !(all.lo < all.hi)) continue;
    if (automatic) words[i].push_back("map=" + map);
    if (word_value(show.words, "range")) continue;
    words[i].push_back(fmt::format("range={},{}", exact_number(shown.range.lo), exact_number(shown.range.hi)));
    if (shown.cut_low) triangle(words[i], "below", 0);
    if (shown.cut_high) triangle(words[i], "above", 1);
  }
  return words;
}

Shown collect(const PipelineFile& file, const std::vector<Data>& results, const StatedPicture& stated, Context& context) {
  Shown s;
  for (size_t i = 0; i < results.size(); ++i) {
    const auto& show = file.show[i];
    s.outlined = s.outlined || show.kind == "outline";
    if (std::holds_alternative<TablePtr>(results[i]))
      fail_no_mesh(results[i], file_name_of(origin_of(file, show.of.empty() ? file.steps.back().name : show.of)));
    std::vector<DatasetPtr> parts;
    for_each_dataset(results[i], [&](const std::string&, const DatasetPtr& d) { parts.push_back(d); });
    auto words = words_of_parts(parts, show);
    if (show.kind == "glyphs" && parts.size() > 1) take_one_glyph_scale(parts, words);
    const size_t first = s.scene.items.size();
    const bool joined = show.kind == "volume" && parts.size() > 1;  // one look for all parts, that of the largest
    size_t largest = 0, most = 0;
    std::optional<Legend> legend_of_all;
    for (size_t k = 0; k < parts.size(); ++k) {
      const DatasetPtr& d = parts[k];
      s.any_points = s.any_points || d->point_count() > 0;
      s.box.add(d->bounds());
      if (parts.size() > 1 && d->point_count() == 0) continue;                                             // what a filter left nothing of
      if (parts.size() > 1 && show.kind == "volume" && word_value(words[k], "field") == "none") continue;  // nothing to see through
      const auto legend = find_show(show.kind).add(s.scene, d, words[k], context);
      if (const auto path = show.kind == "volume" ? word_value(words[k], "save") : std::nullopt; path && !path->empty())
        save_transfer_file(path_beside(file.origin, *path), std::get<VolumeItem>(s.scene.items.back()));
      if (joined && (s.scene.items.size() == first + 1 || d->point_count() > most))
        largest = s.scene.items.size() - 1, most = d->point_count(), legend_of_all = legend;
      if (!legend || !stated.picture.legend || joined) continue;
      const auto have = std::find_if(s.legends.begin(), s.legends.end(), [&](const Legend& l) { return same_legend(l, *legend); });
      if (have == s.legends.end()) s.legends.push_back(*legend);
      else if (legend->glyph && (!have->glyph || have->glyph->most < legend->glyph->most)) have->glyph = legend->glyph;
    }
    if (!joined || s.scene.items.size() == first) continue;
    const VolumeItem model = std::get<VolumeItem>(s.scene.items[largest]);
    join_volumes(std::span(s.scene.items).subspan(first), model, uint32_t(i + 1));
    if (legend_of_all && stated.picture.legend) {
      if (!legend_of_all->volume) static_cast<ColorScale&>(*legend_of_all) = std::get<VolumeItem>(s.scene.items[largest]).color;
      s.legends.push_back(*legend_of_all);
    }
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
  check_shows(file);
  const auto cache = options.cache ? options.cache : std::make_shared<Cache>(0);
  std::vector<Data> held;
  Picture picture;
  Look look;
  if (file.show.empty()) {
    look = choose_looks(file, options, cache, held, picture.notes, context);
  } else {
    for (auto& s : file.show)
      if (colors_by_field(s.kind)) s.words.insert(s.words.end(), options.coloring.begin(), options.coloring.end());
    check_shows(file);
  }

  GraphOptions graph_options;
  graph_options.cache = cache;
  const PipelineGraph built = build_graph(file, graph_options);
  std::vector<Target> targets;
  for (NodeId node : built.show) targets.push_back({node, {}});
  const std::vector<Data> results = built.graph.evaluate(targets, context);
  held.clear();

  // What the notes say already, and what several parts say alike, is said once.
  Context once(context, 0, 1);
  std::vector<std::string> said = picture.notes;
  once.on_log = [&](LogLevel level, std::string_view text) {
    if (std::any_of(said.begin(), said.end(), [&](const std::string& s) { return s.find(text) != s.npos; })) return;
    said.emplace_back(text);
    context.log(level, text);
  };
  Shown shown = collect(file, results, stated, once);
  const Box3& box = shown.box;
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
