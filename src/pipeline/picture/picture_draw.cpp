// SPDX-License-Identifier: Apache-2.0
// The picture without its legends, and the box behind the data.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include "pipeline/graph/step_report.h"
#include "pipeline/picture/picture_parts.h"
#include "pipeline/picture/report/picture_report.h"
#include "render/render.h"
#include "render/volume/measured_steps.h"

namespace sg {

namespace {

// The background behind some rows of the picture as that of a scene drawn there alone: even in sRGB from the lowest row to the highest.
void take_background_of(int first, int rows, int of, Scene& scene) {
  if (!scene.background_top || rows >= of || of < 2) return;
  const Vec3f bottom = scene.background, top = *scene.background_top;
  const auto at = [&](int row) { return lerp(top, bottom, float(row) / float(of - 1)); };
  scene.background = at(first + rows - 1), scene.background_top = at(first);
}

// A picture beside its legends in the whole one, all of the rest background.
Frame placed(const Frame& part, const Scene& scene, const Camera& camera, const RenderOptions& options, const Rect& at, int width,
             int height, Context& context) {
  Frame whole(width, height);
  Scene empty;
  empty.background = scene.background, empty.background_top = scene.background_top, empty.transparent = scene.transparent;
  RenderOptions column = options;
  column.width = 1, column.height = height, column.samples = 1, column.light.reset();
  const Frame background = render(empty, camera, column, context);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      std::copy_n(&background.rgba[4 * size_t(y)], 4, &whole.rgba[4 * (size_t(y) * size_t(width) + size_t(x))]);
  const size_t row = size_t(part.width);
  for (size_t y = 0; y < size_t(part.height); ++y) {
    const size_t to = (y + size_t(at.y)) * size_t(width) + size_t(at.x);
    std::copy_n(&part.rgba[4 * y * row], 4 * row, &whole.rgba[4 * to]);
    std::copy_n(&part.depth[y * row], row, &whole.depth[to]), std::copy_n(&part.ids[y * row], row, &whole.ids[to]);
  }
  return whole;
}

// The texts whose places are seen: nothing lies before them by more than a hair of the scene's size.
std::vector<TextItem> seen_texts(const Scene& scene, const Projection& p, const Frame& frame) {
  const double hair = scene.texts.empty() ? 0 : 0.005 * scene_bounds(scene).diagonal();
  std::vector<TextItem> seen;
  for (const TextItem& t : scene.texts) {
    const Vec3 at = p.to_pixel(t.at);
    if (!(at.z > p.near_plane && at.z < p.far_plane) || !(at.x >= 0 && at.x < frame.width && at.y >= 0 && at.y < frame.height)) continue;
    if (double(frame.depth[size_t(at.y) * size_t(frame.width) + size_t(at.x)]) >= at.z - hair) seen.push_back(t);
  }
  return seen;
}

}  // namespace

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
  item.width = 1, item.mark = true;
  return item;
}

Rect picture_beside_legends(const Annotation& annotation, const StatedPicture& s) {
  // In too small a picture legends go over it.
  LegendRoom room = legend_room(annotation, s.width, s.height);
  if ((room.left + room.right) * 2 > s.width) room.left = room.right = 0;
  if ((room.top + room.bottom) * 2 > s.height) room.top = room.bottom = 0;
  return {double(room.left), double(room.top), double(s.width - room.left - room.right), double(s.height - room.top - room.bottom)};
}

bool follows_light(const Scene& scene, const StatedPicture& s) { return s.picture.integrator || scatters_light(scene); }

namespace {

// What is asked of paths, if any are followed.
std::optional<LightOptions> light_of(const Scene& scene, const StatedPicture& s, const DrawHow& how) {
  if (!follows_light(scene, s)) return {};
  LightOptions light = s.picture.light;
  light.integrator = s.picture.integrator.value_or(trace::IntegratorKind::path);
  light.seed = uint64_t(s.picture.seed), light.features = how.layers;
  if (how.until) {
    const double left = std::max(1e-3, std::chrono::duration<double>(*how.until - std::chrono::steady_clock::now()).count());
    light.seconds = light.seconds > 0 ? std::min(light.seconds, left) : left;
  }
  return light;
}

// Numbers of a part of a picture, in the whole one.
Plane<float> placed(const Plane<float>& part, size_t each, const Rect& at, int width, int height) {
  Plane<float> whole;
  if (part.empty()) return whole;
  whole.assign(each * size_t(width) * size_t(height), 0);
  const size_t row = each * size_t(at.width);
  for (size_t y = 0; y < size_t(at.height); ++y)
    std::copy_n(&part[y * row], row, &whole[each * ((y + size_t(at.y)) * size_t(width) + size_t(at.x))]);
  return whole;
}

}  // namespace

DrawnPicture draw_picture(const Scene& stated, const Camera& camera, const StatedPicture& s, const Annotation& annotation,
                          const DrawHow& how, Context& context) {
  const Rect area = picture_beside_legends(annotation, s);
  RenderOptions options;
  options.width = int(area.width), options.height = int(area.height), options.samples = s.picture.samples;
  options.adaptive = s.picture.adaptive, options.coarser = how.coarser;
  options.light = light_of(stated, s, how);
  const std::optional<MeasuredSteps> measured = options.light ? std::nullopt : measure_steps(stated, context);
  if (measured) context.info(measured->text());
  const Scene scene = measured ? in_steps(stated, *measured) : stated;
  const bool beside = options.width < s.width || options.height < s.height;
  // The frame, one of single samples, and one of all pixels if a legend is next to it.
  check_picture_memory(s.width, s.height, 1 + (beside || options.adaptive > 0 ? 1 : 0));
  const Projection projection = make_projection(camera, options.width, options.height);
  const auto finish = [&](Frame frame, TraceReport light) {
    Annotation with_texts = annotation;
    with_texts.texts = seen_texts(scene, projection, frame);
    for (Legend& l : with_texts.legends)
      if (l.glyph && annotation.box) {
        const double depth = projection.to_eye(annotation.box->center()).z;
        l.glyph->pixels = l.glyph->in_pixels    ? l.glyph->length
                          : projection.parallel ? l.glyph->length * projection.scale
                          : depth > 0           ? l.glyph->length * projection.scale / depth
                                                : 0;
      }
    LightPlanes planes = std::move(light.planes);
    light.planes = {};
    if (beside) {
      frame = placed(frame, scene, camera, options, area, s.width, s.height, context);
      planes = {placed(planes.error, 1, area, s.width, s.height), placed(planes.albedo, 3, area, s.width, s.height),
                placed(planes.normal, 3, area, s.width, s.height)};
    }
    Image image = to_image(frame, scene.transparent);
    annotate(image, with_texts, projection, int(area.x), int(area.y));
    for (uint32_t& id : frame.ids) id = id > 0 && id <= scene.shows.size() ? scene.shows[id - 1] : 0;
    Seen seen{std::move(frame.depth), std::move(frame.ids), std::move(planes), {}};
    if (how.layers) seen.rgba = std::move(frame.rgba);
    return DrawnPicture{std::move(image), std::move(seen), std::move(light), measured ? measured->text() : ""};
  };
  if (how.on_finer)
    options.watch = {[&](const Frame& frame, const TraceReport& light) { return how.on_finer(finish(frame, light)); }, how.every,
                     how.so_far};
  Frame frame;
  TraceReport light;
  const StopWatch drawing;
  if (scene.background_top && options.height < s.height) {
    Scene part = scene;
    take_background_of(int(area.y), options.height, s.height, part);
    frame = render(part, camera, options, context, &light);
  } else {
    frame = render(scene, camera, options, context, &light);
  }
  if (how.on_light) how.on_light(frame);
  context.log(LogLevel::debug,
              fmt::format("drawing {}x{}: {}: {}", options.width, options.height, drawing.text(), drawn_text(scene, options)));
  const StopWatch annotating;
  DrawnPicture drawn = finish(std::move(frame), std::move(light));
  context.log(LogLevel::debug, fmt::format("legends, axes and texts: {}", annotating.text()));
  return drawn;
}

}  // namespace sg
