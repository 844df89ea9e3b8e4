// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture.h"

#include "base/file.h"
#include "base/text.h"
#include "color/parse_color.h"
#include "render/annotate/annotate.h"
#include "render/render.h"
#include "scene/camera_params.h"
#include "scene/look.h"

namespace sg {

void describe(Schema& s, PictureParams& p) {
  s("size", p.size, "Width and height in pixels, like 1920x1080.");
  s("background", p.background, "Colour behind everything, two colours bottom/top for a gradient, or 'transparent'.");
  s("title", p.title, "Text above the picture.");
  s("legend", p.legend, "Draw the legends of colours.");
  s("axes", p.axes, "Draw the bounding box with numbers.");
  s("triad", p.triad, "Draw the orientation axes.");
  s("samples", p.samples, "Samples per pixel and axis; 0 chooses 2 for surfaces, 1 for volumes.").range(0, 4);
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
  v.picture = {"camera", "output"};
  PictureParams p;
  const Schema schema = schema_of(p);
  for (const ParamDecl& d : schema.decls()) v.picture.push_back(d.name);
  return v;
}

namespace {

// What the words under `picture` say.
struct Stated {
  PictureParams picture;
  CameraParams camera;
  int width = 0, height = 0;
  Vec3f bottom{1, 1, 1};
  std::optional<Vec3f> top;
  bool transparent = false;
};

Stated stated_in(const PipelineFile& file) {
  Stated s;
  std::vector<std::string> words;
  for (const std::string& w : file.picture)
    if (!w.starts_with("camera.") && !w.starts_with("output=") && !w.starts_with("camera=")) words.push_back(w);
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

// The file a step's data comes from, for hints by extension; "" for sources.
std::string origin_of(const PipelineFile& file, std::string step) {
  for (int hops = 0; hops < 1000; ++hops) {
    size_t at = file.steps.size();
    for (size_t i = 0; i < file.steps.size(); ++i)
      if (file.steps[i].name == step) at = i;
    if (at == file.steps.size()) return "";
    const auto& s = file.steps[at];
    if (s.operation == "read") return word_value(s.words, "path").value_or("");
    if (!s.from.empty()) step = s.from[0];
    else if (at > 0) step = file.steps[at - 1].name;
    else return "";
  }
  return "";
}

// The steps that nobody takes as input: what is to be seen when nothing is said.
std::vector<std::string> open_ends(const PipelineFile& file) {
  std::vector<std::string> used, ends;
  for (size_t i = 0; i < file.steps.size(); ++i) {
    const auto& s = file.steps[i];
    if (!s.from.empty()) used.insert(used.end(), s.from.begin(), s.from.end());
    else if (i > 0 && s.operation != "read") {
      const auto names = operations();
      const auto op = std::find_if(names.begin(), names.end(), [&](const Operation& o) { return o.name == s.operation; });
      if (op == names.end() || op->kind == OperationKind::filter) used.push_back(file.steps[i - 1].name);
    }
  }
  for (const auto& s : file.steps)
    if (std::find(used.begin(), used.end(), s.name) == used.end()) ends.push_back(s.name);
  return ends;
}

std::string free_name(const PipelineFile& file, const std::string& wanted) {
  for (int n = 0;; ++n) {
    const std::string name = n ? fmt::format("{}_{}", wanted, n + 1) : wanted;
    if (std::none_of(file.steps.begin(), file.steps.end(), [&](const auto& s) { return s.name == name; })) return name;
  }
}

bool colors_by_field(std::string_view kind) { return kind != "outline"; }

// Chooses how to show every open end, adding steps and shows to the file. Returns the view of the first. `held` keeps what
// was looked at, so that the cache finds it again and nothing is computed twice.
Look choose_looks(PipelineFile& file, const PictureOptions& options, const std::shared_ptr<Cache>& cache, std::vector<Data>& held,
                  std::vector<std::string>& notes, Context& context) {
  GraphOptions graph_options;
  graph_options.cache = cache;
  const PipelineGraph built = build_graph(file, graph_options);
  const std::string field = word_value(options.coloring, "field").value_or("");
  Look first;
  bool have = false;
  for (const std::string& end : open_ends(file)) {
    NodeId node = built.last;
    for (const auto& [name, id] : built.nodes)
      if (name == end) node = id;
    const Data data = held.emplace_back(built.graph.evaluate(node, {}, context));
    DatasetPtr largest;
    for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
      if (!largest || d->point_count() > largest->point_count()) largest = d;
    });
    if (!largest) fail_usage("there is no mesh to show", end);
    if (!field.empty()) largest->fields().require(field);
    const Look look = choose_look(*largest, field, extension_of(origin_of(file, end)));
    notes.push_back(look.reason);
    std::string result = end;
    if (!look.filter.empty()) {
      result = free_name(file, look.filter[0]);
      file.steps.push_back({result, look.filter[0], {look.filter.begin() + 1, look.filter.end()}, {end}, 0});
    }
    for (const Look::Show& s : look.shows) {
      std::vector<std::string> words = s.words;
      if (colors_by_field(s.kind)) words.insert(words.end(), options.coloring.begin(), options.coloring.end());
      file.show.push_back({s.kind, words, s.of_input ? end : result, 0});
    }
    if (!have) first = look;
    have = true;
  }
  return first;
}

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

bool same_legend(const ColorScale& a, const ColorScale& b) {
  return a.title == b.title && a.map.name == b.map.name && a.lo == b.lo && a.hi == b.hi && a.kind == b.kind && a.labels == b.labels;
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

// The edges of the box that do not lie in front of the data: those with a face turned away from the camera.
LinesItem back_edges(const Box3& box, const Camera& camera) {
  // turned_away[axis][end]: does the face at that end look away from the camera?
  bool turned_away[3][2];
  const Vec3 towards = camera.position - camera.target;
  for (int a = 0; a < 3; ++a) {
    turned_away[a][0] = camera.parallel ? towards[a] >= 0 : camera.position[a] >= box.lo[a];
    turned_away[a][1] = camera.parallel ? towards[a] <= 0 : camera.position[a] <= box.hi[a];
  }
  SurfaceMesh mesh;
  mesh.points.origin = box.center();
  std::vector<float> xyz;
  std::vector<int32_t> ends;
  for (int c = 0; c < 8; ++c)
    for (int a = 0; a < 3; ++a) xyz.push_back(float((c >> a & 1 ? box.hi[a] : box.lo[a]) - mesh.points.origin[a]));
  for (int c = 0; c < 8; ++c)
    for (int a = 0; a < 3; ++a) {
      const int u = (a + 1) % 3, v = (a + 2) % 3;
      if ((c >> a & 1) || !(box.size()[a] > 0)) continue;
      if (turned_away[u][c >> u & 1] || turned_away[v][c >> v & 1]) ends.insert(ends.end(), {c, c | 1 << a});
    }
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.lines.fixed = 2;
  mesh.lines.connectivity = Array::from_vector(std::move(ends));
  LinesItem item;
  item.data = make_dataset(std::move(mesh));
  item.color = {0.69f, 0.69f, 0.71f};
  item.width = 1;
  return item;
}

// Where a picture narrowed by its legends lies in the whole one: at the left, the rest is background.
void place_left(const Frame& part, Frame& whole) {
  for (int y = 0; y < part.height; ++y) {
    const size_t from = size_t(y) * size_t(part.width), to = size_t(y) * size_t(whole.width);
    std::copy_n(&part.rgba[4 * from], 4 * size_t(part.width), &whole.rgba[4 * to]);
    // The background goes on to the right.
    for (int x = part.width; x < whole.width; ++x)
      std::copy_n(&part.rgba[4 * (from + size_t(part.width) - 1)], 4, &whole.rgba[4 * (to + size_t(x))]);
  }
}

Image draw(const Scene& scene, const Camera& camera, const Stated& s, Annotation annotation, Context& context) {
  int legends = legend_width(annotation, s.width, s.height);
  if (legends * 2 > s.width) legends = 0;  // too narrow a picture: legends go over it
  RenderOptions options;
  options.width = s.width - legends, options.height = s.height, options.samples = s.picture.samples;
  Frame frame = render(scene, camera, options, context);
  const Projection projection = make_projection(camera, options.width, options.height);
  if (legends > 0) {
    Frame whole(s.width, s.height);
    // The last column may hold data; take the background's own colour there.
    Scene empty;
    empty.background = scene.background, empty.background_top = scene.background_top, empty.transparent = scene.transparent;
    RenderOptions column = options;
    column.width = 1, column.samples = 1;
    const Frame background = render(empty, camera, column, context);
    place_left(frame, whole);
    for (int y = 0; y < s.height; ++y)
      for (int x = options.width; x < s.width; ++x)
        std::copy_n(&background.rgba[4 * size_t(y)], 4, &whole.rgba[4 * (size_t(y) * size_t(s.width) + size_t(x))]);
    frame = std::move(whole);
  }
  Image image = to_image(frame, scene.transparent);
  annotate(image, annotation, projection);
  return image;
}

}  // namespace

Picture make_picture(PipelineFile& file, const PictureOptions& options, Context& context) {
  const Stated stated = stated_in(file);
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

  Scene scene;
  Annotation annotation;
  bool outlined = false, any_points = false;
  Box3 box;
  for (size_t i = 0; i < results.size(); ++i) {
    const auto& show = file.show[i];
    outlined = outlined || show.kind == "outline";
    for_each_dataset(results[i], [&](const std::string&, const DatasetPtr& d) {
      any_points = any_points || d->point_count() > 0;
      box.add(d->bounds());
      const auto legend = find_show(show.kind).add(scene, d, show.words, context);
      if (!legend || !stated.picture.legend) return;
      for (const ColorScale& have : annotation.legends)
        if (same_legend(have, *legend)) return;
      annotation.legends.push_back(*legend);
    });
  }
  if (!any_points) context.warn("the picture is empty: there are no points to show");
  if (!file.show.empty() && look.shows.empty())
    choose_view(box, extension_of(origin_of(file, file.show[0].of.empty() ? file.steps.back().name : file.show[0].of)), look);
  scene.background = stated.bottom, scene.background_top = stated.top, scene.transparent = stated.transparent;

  const double brightness = 0.2126 * stated.bottom.x + 0.7152 * stated.bottom.y + 0.0722 * stated.bottom.z;
  annotation.title = stated.picture.title;
  annotation.triad = stated.picture.triad && any_points && !look.parallel;  // a map needs none: its axes are named
  annotation.scale = stated.picture.text;
  annotation.dark_background = !stated.transparent && brightness < 0.45;
  annotation.show_nan_in_legend = has_nan(scene);
  if (stated.picture.axes && !box.empty()) annotation.box = box;

  const int legends = legend_width(annotation, stated.width, stated.height);
  const double aspect = double(std::max(1, legends * 2 > stated.width ? stated.width : stated.width - legends)) / stated.height;
  const Camera camera = make_camera(stated.camera, box, aspect, look.direction, look.up, look.parallel, stated.picture.axes ? 0.11 : 0.05);
  if (stated.picture.axes && !outlined && !box.empty()) scene.items.emplace_back(back_edges(box, camera));
  picture.image = draw(scene, camera, stated, std::move(annotation), context);
  return picture;
}

}  // namespace sg
