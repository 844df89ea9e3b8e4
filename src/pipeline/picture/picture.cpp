// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "base/all_ranks.h"
#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "base/text/time_text.h"
#include "color/parse_color.h"
#include "data/ranks/over_all.h"
#include "pipeline/file/read_part.h"
#include "pipeline/file/transfer_file.h"
#include "pipeline/film/film_params.h"
#include "pipeline/offline/page_params.h"
#include "pipeline/picture/picture_cost.h"
#include "pipeline/picture/picture_notes.h"
#include "pipeline/picture/picture_parts.h"
#include "pipeline/picture/settle_choices.h"
#include "scene/choose/coloring.h"
#include "scene/show/show.h"
#include "scene/show/volume.h"

namespace sg {

void describe(Schema& s, PictureParams& p) {
  s("size", p.size, "Width and height in pixels, e.g. 1920x1080; HD is that, 4K 3840x2160, 8K 7680x4320.");
  s("background", p.background, "Background colour, two colours bottom/top for a gradient, or 'transparent'.");
  s("title", p.title,
    "Title above the picture; {t} is the time of the data, {t:.2f} with two decimals, in a series {n} the number of the picture and "
    "{count} that of all.");
  s("legend", p.legend, "Draw the colour legends.");
  s("axes", p.axes, "Draw the bounding box with numbers.");
  s("stretch", p.stretch,
    "Factors by which x, y and z are drawn longer than they are, negative ones the other way round; numbers at the axes stay those of the "
    "data. Default: 1,1,1, but for maps in degrees (longitudes as long as at the middle latitude, heights 0.3 times the map's "
    "width), depths and pressures, which grow downwards. The camera's position and target are where things are drawn.");
  s("x_title", p.x_title, "Title of the x axis; default: what the data says of it, else x.");
  s("y_title", p.y_title, "Title of the y axis.");
  s("z_title", p.z_title, "Title of the z axis.");
  s("frame", p.frame,
    "The box that the picture is of: x0,x1,y0,y1,z0,z1 in the data's coordinates. Axes and camera are those of the box; what lies outside "
    "of it "
    "is drawn where it comes into view. Default: all of the data, or of a volume shown without options the part in which something is "
    "seen.");
  s("layout", p.layout,
    "Several panels in one picture, with one legend: columns x rows as 2x1, or 'auto'. Each input has its own, or each of 'views'.");
  s("views", p.views, "Named views of the same data side by side, e.g. front,left,top,iso; layout 'auto' where none is stated.");
  s("scale_bar", p.scale_bar, "Draw a bar of a round length, as long as it is at the middle of the data.");
  s("caption", p.caption, "Text at the lower edge of the picture; {t} as in the title.");
  s("note", p.note,
    "Texts in the picture with their places, apart by semicolons: 'Inlet @ 0.1,0.9; Outlet @ top-right size=1.5 color=red'. A place is the "
    "middle of the text in shares of the picture's width and height from the top left, or top-left, top, top-right, left, center, right, "
    "bottom-left, bottom or bottom-right; {t} as in the title.");
  s("triad", p.triad, "Draw the orientation axes.");
  s("letters", p.letters,
    "Draw at the edges of a scan's picture where they lie in the patient: right, left, anterior, posterior, inferior, superior.");
  s("samples", p.samples, "Samples per pixel and axis; 0 chooses 2 for surfaces, 1 for volumes.").range(0, 4);
  s("adaptive", p.adaptive,
    "Above 0: take all samples only where neighbouring pixels differ by more than this share of full scale; 0: take all of them "
    "everywhere.")
      .range(0, 1);
  s("text", p.text, "Scale factor of all text.").range(0.2, 10);
}

void parse_size(const std::string& words, int& width, int& height) {
  const std::string name = to_lower(words);
  const std::string text = name == "4k" || name == "uhd" ? "3840x2160" : name == "8k" ? "7680x4320" : name == "hd" ? "1920x1080" : words;
  const auto parts = split(text, 'x');
  const auto w = parts.size() == 2 ? parse_int(parts[0]) : std::nullopt, h = parts.size() == 2 ? parse_int(parts[1]) : std::nullopt;
  if (!w || !h || *w < 1 || *h < 1 || *w > 32768 || *h > 32768)
    fail_usage(fmt::format("'{}' is not a size", text), "size", "write width x height from 1 to 32768, e.g. 1280x720, or HD, 4K or 8K");
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
  PageParams page;
  add(schema_of(page));
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
  s.notes = parse_notes(s.picture.note);
  if (const std::vector<double>& f = s.picture.frame; !f.empty() && !(f.size() == 6 && f[0] <= f[1] && f[2] <= f[3] && f[4] <= f[5]))
    fail_usage("frame needs the lower and the upper end along x, y and z", "frame", "like frame=0,1,0,1,0,0.5");
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

// {t} in a title is the time of what is shown.
std::string title_of(std::string title, const std::vector<Data>& results, const Context& context) {
  if (const std::string mark = unknown_mark(title); !mark.empty())
    context.warn(
        fmt::format("nothing stands for {} in a text of the picture, which shows it as it is; {{t}} is the time, also {{t:.2f}}", mark));
  if (!has_time_mark(title)) return title;
  std::optional<double> time;
  for (const Data& data : results)
    for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
      if (!time) time = d->time();
    });
  if (!time) {
    context.warn("a text of the picture asks for the time {t}, but the data has none");
    return title;
  }
  return with_time(std::move(title), *time);
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

Annotation annotation_of(const StatedPicture& stated, const Shown& shown, const Look& look) {
  Annotation a;
  a.legends = shown.legends;
  a.title = stated.picture.title, a.caption = stated.picture.caption, a.notes = stated.notes;
  a.scale_bar = stated.picture.scale_bar;
  a.triad = stated.picture.triad && shown.any_points && !look.camera.parallel;  // a map needs none: its axes are named
  a.scale = stated.picture.text;
  const double brightness = 0.2126 * stated.bottom.x + 0.7152 * stated.bottom.y + 0.0722 * stated.bottom.z;
  a.dark_background = !stated.transparent && brightness < 0.45;
  a.show_nan_in_legend = has_nan(shown.scene);
  if ((stated.picture.axes || a.scale_bar) && !shown.box.empty()) a.box = shown.box;
  a.axes = stated.picture.axes;
  std::copy_n(shown.axis_titles, 3, a.axis_titles);
  a.length_unit = shown.length_unit;
  a.stretch = shown.stretch;
  a.patient_letters = stated.picture.letters && shown.patient;
  return a;
}

// A point, or a line along an axis, tells its place only inside a box that is wider than itself.
Box3 with_room(Box3 b) {
  if (b.empty()) return b;
  const Vec3 size = b.size(), middle = b.center();
  const double longest = std::max({size.x, size.y, size.z}), far = std::max({std::abs(middle.x), std::abs(middle.y), std::abs(middle.z)});
  const auto is_flat = [&](int a) { return !(size[a] > 1e-9 * longest); };
  if (is_flat(0) + is_flat(1) + is_flat(2) < 2) return b;
  const double room = longest > 0 ? 0.08 * longest : far > 0 ? 0.1 * far : 0.5;
  for (int a = 0; a < 3; ++a)
    if (is_flat(a)) b.lo[a] -= room, b.hi[a] += room;
  return b;
}

// A projection of all values, such as the maximum along each ray, covers the edges behind it but for their ends.
bool fills_its_box(const Scene& scene) {
  return std::any_of(scene.items.begin(), scene.items.end(), [](const Item& item) {
    const auto* volume = std::get_if<VolumeItem>(&item);
    return volume && !info_of(volume->mode).absorbs && !info_of(volume->mode).needs_level;
  });
}

// Ready to be drawn at the size that is stated.
Panel panel_of(const Shown& shown, const Look& look, const StatedPicture& stated, const CameraParams& camera) {
  Panel p;
  p.scene = shown.scene;
  p.scene.background = stated.bottom, p.scene.background_top = stated.top, p.scene.transparent = stated.transparent;
  p.annotation = annotation_of(stated, shown, look);
  if (in_panels(stated.picture)) p.annotation.legends.clear();  // they stand beside the panels
  const Rect area = picture_beside_legends(p.annotation, stated);
  const double aspect = std::max(1.0, area.width) / std::max(1.0, area.height);
  p.around = look.camera, p.margin = stated.picture.axes ? 0.11 : 0.05;
  p.camera = make_camera(camera, shown.box, aspect, look.camera, p.margin);
  Box3 all = scene_bounds(p.scene);  // glyphs reach beyond the data
  all.add(shown.box);
  fit_planes(p.camera, all);
  if (stated.picture.axes && !shown.outlined && !shown.box.empty() && !fills_its_box(p.scene)) {
    p.scene.items.emplace_back(back_edges(shown.box, p.camera));
    p.box_behind = shown.box;
  }
  return p;
}

// By which field the stated ways to show colour, where that is left to the data.
void note_colors(const std::vector<StatedShow>& shows, const std::vector<Data>& results, std::vector<std::string>& notes) {
  for (size_t i = 0; i < shows.size(); ++i) {
    const auto& [kind, params] = shows[i];
    const ColoringParams* coloring = kind->coloring ? kind->coloring(params) : nullptr;
    if (!coloring || !coloring->field.name.empty() || !coloring->color.empty()) continue;
    const Field* field = nullptr;
    for_each_dataset(results[i], [&](const std::string&, const DatasetPtr& d) {
      if (!field) field = shown_field(*kind, params, *d);
    });
    if (!field) continue;
    const std::string note = fmt::format("{}: coloured by '{}'", kind->name, field->name);
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  }
}

}  // namespace

Picture make_picture(PipelineFile& file, const PictureOptions& options, Context& context) {
  StatedPicture stated = stated_in(file);
  load_transfer_files(file);
  stated_shows(file);  // mistakes are reported before anything runs
  const auto cache = options.cache ? options.cache : std::make_shared<Cache>(0);
  std::vector<Data> held;
  Picture picture;
  Context computing(context, 0, 0.5), drawing(context, 0.5, 1);
  std::optional<HeadPose> pose;  // of a CT that is contoured, or shown as a volume
  const auto take_pose = [&](const Data& data) {
    for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
      if (!pose && !context.communicator) pose = unstated_pose(*d);  // pieces of a head would turn each its own way
    });
  };
  GraphOptions graph_options;
  graph_options.cache = cache;
  if (!stated.camera.up && has_contour(file))
    graph_options.read = [&](const std::string& path, const ReadOptions& read, const Request& request, Context& c) {
      Data data = read_part(path, read, request, c);
      take_pose(data);
      return data;
    };
  show_what_is_labelled(file, picture.notes);
  settle_choices(file, {}, graph_options, options.results, held, computing);
  Look look = choose_looks(file, options, graph_options, held, picture.notes, computing);
  show_planes_as_measured(file);
  stated = stated_in(file);  // with what was chosen of it
  const std::vector<StatedShow> shows = stated_shows(file);

  const PipelineGraph built = build_graph(file, graph_options, options.results);
  std::vector<Target> targets;
  for (NodeId node : built.show) targets.push_back({node, {}});
  std::vector<Data> results = built.graph.evaluate(targets, computing);
  leave_out_sets(file, shows, results, picture.notes, computing);
  held.clear();
  if (look.shows.empty()) note_colors(shows, results, picture.notes);
  for (size_t i = 0; i < results.size() && look.shows.empty() && !stated.camera.up; ++i)
    if (shows[i].kind->is<VolumeShow>()) take_pose(results[i]);
  for (std::string* text : {&stated.picture.title, &stated.picture.caption}) *text = title_of(*text, results, context);
  for (PictureNote& n : stated.notes) n.text = title_of(n.text, results, context);

  // What the notes already say, or several parts say alike, is given once.
  Context once(context, 0, 1);
  std::vector<std::string> said = picture.notes;
  once.on_log = [&](LogLevel level, std::string_view text) {
    if (std::any_of(said.begin(), said.end(), [&](const std::string& s) { return s.find(text) != s.npos; })) return;
    said.emplace_back(text);
    context.log(level, text);
  };
  std::vector<Shown> shown = collect(file, shows, results, panels_of(file, stated.picture), stated.picture, once);
  for (Shown& s : shown) {
    s.box = over_all(s.box, context);
    s.any_points = all_most(int(s.any_points), context.communicator) > 0;
    s.patient = all_most(int(s.patient), context.communicator) > 0;
  }
  for (const Shown& s : shown)
    if (const std::string note = note_of_long_drawing(s.scene, double(stated.width) * double(stated.height)); !note.empty())
      once.info(note);
  if (std::none_of(shown.begin(), shown.end(), [](const Shown& s) { return s.any_points; }))
    context.warn("the picture is empty: there are no points to show");
  if (!file.show.empty()) {
    const std::string& first = shown_step(file, 0);
    if (look.shows.empty()) {
      const std::string extension = extension_of_origin(file, first);
      look.camera = choose_view(shown[0].box, extension, shown[0].patient);
      std::vector<DatasetPtr> parts;
      for_each_dataset(results[0], [&](const std::string&, const DatasetPtr& d) { parts.push_back(d); });
      const std::string up = is_shape_of_file(file, first) ? stand_upright(parts, extension, look.camera) : "";
      if (!up.empty() && !stated.camera.up) picture.notes.push_back(up);
    }
    if (pose) picture.notes.push_back(face_unstated(*pose, look.camera));
    face_cut(file, first, look.camera);
    face_slab(file, first, shown[0].box, look.camera);
  }
  picture.legends = shown[0].legends;
  for (Shown& s : shown) s.box = with_room(s.box);  // after the choice of a view, which tells by the box what is flat
  if (!in_panels(stated.picture)) {
    const Panel panel = panel_of(shown[0], look, stated, stated.camera);
    if (options.on_panel && !options.on_panel(panel, stated)) {
      context.progress(1, "done");
      return picture;
    }
    draw_drafts(panel.scene, panel.camera, stated, panel.annotation, options, picture, drawing);
    context.progress(1, "done");
    return picture;
  }
  if (options.on_panel)
    fail_usage("a page shows one picture, not several panels", "layout", "leave out layout and views: its buttons turn to every side");
  const std::vector<std::string>& views = stated.picture.views;
  const size_t count = views.empty() ? shown.size() : views.size();
  Annotation around = annotation_of(stated, shown[0], look);
  // The panels share the legends: one with places without a value has them tell of it.
  around.show_nan_in_legend = std::any_of(shown.begin(), shown.end(), [](const Shown& s) { return has_nan(s.scene); });
  const StatedPicture inside = inside_layout(stated, around, count);
  std::vector<NamedPanel> panels;
  for (size_t i = 0; i < count; ++i) {
    CameraParams camera = stated.camera;
    if (!views.empty()) camera.view = view_named(views[i]);
    // Straight on nothing is nearer: what is seen lies between the numbers of its axes, whose names tell their directions.
    const bool straight = !views.empty() && camera.view != NamedView::iso && !camera.projection;
    if (straight) camera.projection = ProjectionKind::parallel;
    panels.push_back({views.empty() ? panel_title(file, i) : views[i], panel_of(shown[views.empty() ? i : 0], look, inside, camera)});
    if (straight) panels.back().panel.annotation.triad = false;
  }
  DrawnPicture drawn = draw_layout(panels, stated, inside, around, drawing);
  picture.image = std::move(drawn.image), picture.seen = std::move(drawn.seen);
  context.progress(1, "done");
  return picture;
}

}  // namespace sg
