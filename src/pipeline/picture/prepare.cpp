// SPDX-License-Identifier: Apache-2.0
// What a picture shows: steps run, looks chosen, scenes collected.
#include "pipeline/picture/prepare.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/all_ranks.h"
#include "base/error.h"
#include "base/file/file.h"
#include "base/text/time_text.h"
#include "data/ranks/over_all.h"
#include "pipeline/file/file_words.h"
#include "pipeline/file/read_part.h"
#include "pipeline/file/transfer_file.h"
#include "pipeline/picture/picture_cost.h"
#include "pipeline/picture/picture_lights.h"
#include "pipeline/picture/scene/grid_textures.h"
#include "pipeline/picture/scene/picture_files.h"
#include "pipeline/picture/scene/picture_scene.h"
#include "pipeline/picture/settle_choices.h"
#include "scene/choose/coloring.h"
#include "scene/show/surface.h"
#include "scene/show/volume.h"

namespace sg {

namespace {

// All mistakes at once, each with its line.
std::vector<StatedShow> stated_shows(const PipelineFile& file) {
  std::vector<StatedShow> shows;
  std::string problems;
  for (const auto& s : file.show) {
    if (s.kind == auto_show) continue;
    try {
      const ShowKind& kind = find_show(s.kind);
      shows.push_back({&kind, show_params(kind, words_beside(s.words, kind.make_params().schema, file.origin))});
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
    const VolumeShow* volume = kind->is<VolumeShow>() ? &params.as<VolumeShow>() : nullptr;
    const bool levels = volume && volume->mode == RayFunction::isosurface && volume->color_by.empty() && volume->opacity_by.empty();
    const std::string note = fmt::format("{}: {} '{}'", kind->name, levels ? "isosurfaces of" : "coloured by", field->name);
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  }
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

}  // namespace

PreparedPicture prepare_picture(PipelineFile& file, const PictureOptions& options, Context& context) {
  PreparedPicture picture;
  StatedPicture& stated = picture.stated;
  stated = stated_in(file);
  load_transfer_files(file);
  stated_shows(file);  // mistakes are reported before anything runs
  stated_scene(file);
  if (!file.scene.empty() && std::none_of(file.show.begin(), file.show.end(), [](const auto& s) { return s.node >= 0; }))
    context.warn("no node of the scene shows anything: give one show: [{surface: {}, of: STEP}]");
  const auto cache = options.cache ? options.cache : std::make_shared<Cache>(0);
  std::vector<Data> held;
  std::optional<HeadPose> pose;  // of a CT that is contoured, or shown as a volume
  const auto take_pose = [&](const Data& data) {
    for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
      if (!pose && !context.communicator) pose = unstated_pose(*d);  // pieces of a head would turn each its own way
    });
  };
  GraphOptions graph_options;
  graph_options.cache = cache, graph_options.on_ran = options.on_ran;
  if (!stated.camera.up && has_contour(file))
    graph_options.read = [&](const std::string& path, const ReadOptions& read, const Request& request, Context& c) {
      Data data = read_part(path, read, request, c);
      take_pose(data);
      return data;
    };
  show_what_is_labelled(file, picture.notes);
  settle_choices(file, {}, graph_options, options.results, held, context);
  Look look = choose_looks(file, options, graph_options, held, picture.notes, context);
  show_planes_as_measured(file);
  stated = stated_in(file);  // with what was chosen of it
  const std::vector<StatedShow> shows = stated_shows(file);
  for (const StatedShow& s : shows) {
    if (s.kind->is<SurfaceShow>()) read_grid_textures(s.params.as<SurfaceShow>().picture, s.params.as<SurfaceShow>().varying, context);
    if (s.kind->is<VolumeShow>()) read_grid_textures(s.params.as<VolumeShow>().picture, s.params.as<VolumeShow>().varying, context);
  }
  if (const auto* of_file = stated.lighting.environment ? std::get_if<PictureEnvironmentParams>(&*stated.lighting.environment) : nullptr)
    stated.lighting.picture = read_environment(path_beside(file.origin, of_file->file), context);

  const PipelineGraph built = build_graph(file, graph_options, options.results);
  std::vector<Target> targets;
  for (NodeId node : built.show) targets.push_back({node, {}});
  for (const Target& t : place_targets(built)) targets.push_back(t);
  std::vector<Data> results = built.graph.evaluate(targets, context);
  const std::vector<Data> places(results.begin() + ptrdiff_t(built.show.size()), results.end());
  results.resize(built.show.size());
  leave_out_sets(file, shows, results, picture.notes, context);
  Copies copies;
  results = placed(file, places, std::move(results), &copies, context);
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
  std::vector<Shown>& shown = picture.shown;
  shown = collect(file, shows, results, panels_of(file, stated.picture), stated.picture, copies, once);
  for (Shown& s : shown) {
    s.box = over_all(s.box, context);
    s.any_points = all_most(int(s.any_points), context.communicator) > 0;
    s.patient = all_most(int(s.patient), context.communicator) > 0;
  }
  for (const Shown& s : shown)
    if (const std::string note = note_of_long_drawing(s.scene, double(stated.width) * double(stated.height), context); !note.empty())
      once.info(note);
  for (const Shown& s : shown)
    for (const std::string& note : {note_of_lost_light(stated, s.scene), note_of_lit_matter(stated, s.scene, shown[0].legends)})
      if (!note.empty()) once.info(note);
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
    if (file.show[0].node < 0) {  // elsewhere the cut looks another way
      face_cut(file, first, look.camera);
      face_slab(file, first, shown[0].box, look.camera);
    }
  }
  take_from_files(file, shown[0].box, stated, picture.notes, context);
  if (const std::string note = note_of_file_scene(results, file); !note.empty()) picture.notes.push_back(note);
  for (Shown& s : shown) s.box = with_room(s.box);  // after the choice of a view, which tells by the box what is flat
  picture.camera = look.camera;
  if (in_panels(stated.picture) && stated.picture.views.empty())
    for (size_t i = 0; i < shown.size(); ++i) picture.panel_titles.push_back(panel_title(file, i));
  return picture;
}

}  // namespace sg
