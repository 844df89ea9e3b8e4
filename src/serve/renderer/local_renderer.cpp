// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/local_renderer.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/utf8.h"
#include "image/codec.h"
#include "image/enlarge.h"
#include "pipeline/catalog/catalog.h"
#include "render/render.h"
#include "serve/renderer/quality.h"
#include "serve/renderer/questions/over_time.h"
#include "serve/renderer/questions/questions.h"
#include "serve/renderer/same_picture.h"
#include "serve/renderer/tell.h"
#include "serve/renderer/wish.h"

namespace sg::serve {

namespace {

constexpr double drag_seconds = 0.032;  // for drawing, of the 50 ms from a drag to its picture

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::shared_ptr<const std::string> jpeg_of(const Image& image) { return std::make_shared<const std::string>(encode_jpeg(image, 85)); }
std::shared_ptr<const std::string> png_of(const Image& image) {
  const std::vector<uint8_t> bytes = encode_png(image);
  return std::make_shared<const std::string>(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

// The words of a picture with a camera and a size in place of theirs.
std::vector<std::string> with_view(const std::vector<std::string>& words, const DrawRequest& request) {
  std::vector<std::string> r;
  for (const std::string& w : words)
    if (!w.starts_with("size=") && !(request.camera && w.substr(0, w.find_first_of(".=")) == word_of(EntryKind::camera))) r.push_back(w);
  r.push_back("size=" + std::to_string(request.width) + "x" + std::to_string(request.height));
  if (request.camera)
    for (const std::string& w : camera_texts(*request.camera)) r.push_back("camera." + w);
  return r;
}

void set_area(const Rect& area, DrawnView& drawn) {
  drawn.area[0] = int(area.x), drawn.area[1] = int(area.y), drawn.area[2] = int(area.width), drawn.area[3] = int(area.height);
}

StatedPicture stated_for(const DrawRequest& request, const PreparedPicture& prepared) {
  StatedPicture s = prepared.stated;
  s.width = request.width, s.height = request.height;
  if (request.camera) s.camera = camera_params(*request.camera);
  return s;
}

}  // namespace

LocalRenderer::LocalRenderer(uint64_t cache_bytes, std::vector<std::string> coloring)
    : cache_(std::make_shared<Cache>(cache_bytes)),
      other_times_(std::make_shared<Cache>(cache_bytes / 8)),
      coloring_(std::move(coloring)),
      unfinished_(cache_bytes / 4) {}

std::shared_ptr<const LocalRenderer::Loaded> LocalRenderer::loaded() const {
  const std::lock_guard lock(mutex_);
  if (!loaded_) fail_usage("nothing is loaded");
  return loaded_;
}

PipelineFile LocalRenderer::load(const PipelineFile& pipeline, Context& context) {
  auto next = std::make_shared<Loaded>();
  next->file = pipeline;
  PictureOptions options;
  options.cache = cache_, options.coloring = coloring_;
  options.on_ran = [this](std::string_view name, double seconds) {
    const std::lock_guard lock(mutex_);
    seconds_[std::string(name)] = seconds;
  };
  next->prepared = prepare_picture(next->file, options, context);
  coloring_.clear();
  const std::lock_guard lock(mutex_);
  const bool same = loaded_ && make_same_picture(loaded_->file, next->file);
  next->picture = (loaded_ ? loaded_->picture : 0) + !same;
  if (!same) planes_.clear(), unfinished_.clear();
  loaded_ = next;
  return next->file;
}

Json::Members LocalRenderer::tell(Context& context) {
  const auto now = loaded();
  StepSeconds seconds;
  {
    const std::lock_guard lock(mutex_);
    seconds = seconds_;
  }
  return tell_state(now->file, now->prepared, seconds, cache_, context);
}

void LocalRenderer::forget(int view) {
  coarse_.erase(view), unfinished_.forget(view);
  const std::lock_guard lock(mutex_);
  planes_.erase(view);
}

namespace {

// Edges of the box behind a volume cover parts of pixels, and rays that meet such parts are slow: the volume is drawn over a picture of
// them.
Frame draw_over_edges(const Panel& panel, double coarse, const RenderOptions& options, Context& context) {
  Scene behind = panel.scene, before = rough(panel.scene, Quality::moving, coarse);
  behind.items.erase(behind.items.begin(), behind.items.end() - 1), behind.shows.clear();
  before.items.pop_back(), before.transparent = true;
  Frame frame = render(behind, panel.camera, options, context);
  const Frame volume = render(before, panel.camera, options, context);
  for (size_t i = 0; i < frame.rgba.size(); ++i) frame.rgba[i] = volume.rgba[i] + (1 - volume.rgba[i | 3]) * frame.rgba[i];
  return frame;
}

bool has_volume(const Scene& scene) {
  return std::any_of(scene.items.begin(), scene.items.end(), [](const Item& i) { return std::holds_alternative<VolumeItem>(i); });
}

// Title and legends, with nothing beside them. One column of the background is drawn: frames of all pixels, new with the first picture,
// would take longer than that picture.
Image draw_around(const Panel& panel, const StatedPicture& stated, const Rect& area, Context& context) {
  Scene empty;
  empty.background = panel.scene.background, empty.background_top = panel.scene.background_top;
  empty.transparent = panel.scene.transparent;
  RenderOptions column;
  column.width = 1, column.height = stated.height, column.samples = 1;
  const Image rows = to_image(render(empty, panel.camera, column, context), empty.transparent);
  Image image(stated.width, stated.height, rows.channels);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) std::copy_n(rows.at(0, y), rows.channels, image.at(x, y));
  Annotation texts = panel.annotation;
  texts.box.reset(), texts.texts.clear(), texts.axes = texts.triad = texts.scale_bar = false;
  annotate(image, texts, make_projection(panel.camera, int(area.width), int(area.height)), int(area.x), int(area.y));
  return image;
}

}  // namespace

// The picture beside the legends in fewer pixels.
DrawnView LocalRenderer::draw_moving(const PreparedPicture& prepared, const StatedPicture& stated, const DrawRequest& request,
                                     double& coarse, Context& context) {
  const Panel panel = panel_of(prepared, stated);
  const Rect area = picture_beside_legends(panel.annotation, stated);
  DrawnView drawn;
  const double pace = coarse > 0 ? coarse : pace_ > 0 ? pace_ : first_coarseness;
  drawn.coarse = std::min(pace, most_pixels_a_sample);
  RenderOptions options;
  options.width = std::max(1, int(std::ceil(area.width / drawn.coarse)));
  options.height = std::max(1, int(std::ceil(area.height / drawn.coarse)));
  options.samples = 1;
  const auto begin = std::chrono::steady_clock::now();
  const Frame frame = panel.box_behind && has_volume(panel.scene)
                          ? draw_over_edges(panel, pace, options, context)
                          : render(rough(panel.scene, Quality::moving, pace), panel.camera, options, context);
  coarse = next_coarseness(pace, seconds_since(begin), drag_seconds);
  constexpr double telling = 100000;  // pixels: smaller pictures say nothing of others
  if (area.width * area.height > telling) pace_ = coarse;
  Image image = to_image(frame, panel.scene.transparent);
  set_area(area, drawn);
  drawn.part = request.part == drawn.area;
  if (!drawn.part) {
    Image around = draw_around(panel, stated, area, context);
    paste_enlarged(image, int(area.x), int(area.y), int(area.width), int(area.height), around);
    image = std::move(around);
  }
  drawn.width = image.width, drawn.height = image.height;
  drawn.type = "image/jpeg", drawn.bytes = jpeg_of(image), drawn.camera = view_camera(panel.camera);
  return drawn;
}

// All pixels. Pictures by paths come as drafts with one path a pixel, then better and better to the exact one.
DrawnView LocalRenderer::draw_whole(const Loaded& now, const StatedPicture& stated, const DrawRequest& request, const OnFiner& on_finer,
                                    Context& context) {
  const auto begin = std::chrono::steady_clock::now();
  const Panel panel = panel_of(now.prepared, stated);
  StatedPicture how = stated;
  const bool exact = request.quality == Quality::exact, light = follows_light(panel.scene, stated);
  if (!exact) how.picture.samples = 1, how.picture.light.stop = 1, how.picture.light.denoise = false;
  const Rect area = picture_beside_legends(panel.annotation, stated);
  const auto view_of = [&](DrawnPicture& picture, bool final) {
    DrawnView drawn;
    drawn.width = stated.width, drawn.height = stated.height, drawn.camera = view_camera(panel.camera);
    drawn.type = final ? "image/png" : "image/jpeg", drawn.bytes = final ? png_of(picture.image) : jpeg_of(picture.image);
    drawn.told = light ? light_text(picture.light) : picture.told;
    set_area(area, drawn), drawn.seconds = seconds_since(begin);
    return drawn;
  };
  DrawHow drawing;
  LightSoFar so_far;
  if (exact && light && on_finer) {
    so_far = unfinished_.take(request, now.picture), drawing.so_far = &so_far;
    drawing.on_finer = [&](DrawnPicture picture) {
      context.check();
      on_finer(view_of(picture, false));
      return true;
    };
  }
  DrawnPicture picture;
  try {
    picture = draw_picture(rough(panel.scene, request.quality), panel.camera, how, panel.annotation, drawing, context);
  } catch (const Error&) {
    if (so_far.squares) unfinished_.keep(request, now.picture, std::move(so_far));
    throw;
  }
  DrawnView drawn = view_of(picture, exact);
  auto planes = std::make_shared<Planes>();
  planes->seen = std::move(picture.seen), planes->width = stated.width, planes->area = area;
  planes->projection = make_projection(panel.camera, int(area.width), int(area.height));
  const std::lock_guard lock(mutex_);
  if (loaded_.get() == &now) planes_[request.view] = planes;  // else something else was loaded meanwhile
  return drawn;
}

DrawnView LocalRenderer::draw(const DrawRequest& request, const OnFiner& on_finer, Context& context) {
  const auto begin = std::chrono::steady_clock::now();
  const auto now = loaded();
  const StatedPicture stated = stated_for(request, now->prepared);
  DrawnView drawn;
  drawn.width = stated.width, drawn.height = stated.height;
  if (in_panels(stated.picture)) {
    Picture picture = draw_prepared(now->prepared, stated, {}, context);
    drawn.type = "image/png", drawn.bytes = png_of(picture.image);
    if (request.camera) drawn.camera = *request.camera;
    set_area({0, 0, double(stated.width), double(stated.height)}, drawn);
  } else if (request.quality == Quality::moving) {
    drawn = draw_moving(now->prepared, stated, request, coarse_[request.view], context);
  } else {
    drawn = draw_whole(*now, stated, request, on_finer, context);
  }
  drawn.seconds = seconds_since(begin);
  return drawn;
}

std::string LocalRenderer::save(const DrawRequest& request, const std::string& name, Context& context) {
  PipelineFile file = loaded()->file;
  file.picture = with_view(file.picture, request);
  PictureOptions options;
  options.cache = cache_;
  Picture picture = make_picture(file, options, context);
  file.absolute = folder_of(name).empty();
  attach_recipe(picture.image, file, name);
  return encode_image(file_name_of(name), picture.image);
}

std::shared_ptr<const LocalRenderer::Planes> LocalRenderer::planes_of(int view) const {
  const std::lock_guard lock(mutex_);
  const auto found = planes_.find(view);
  return found == planes_.end() ? nullptr : found->second;
}

Json::Members LocalRenderer::answer(const Json& question, Context& context) {
  const auto wish = wish_of(question);
  if (wish == Wish::over_time) {
    const PipelineFile file =
        parse_pipeline(bytes_of_text(question["pipeline"].text()), bytes_of_text(question["origin"].text()), picture_vocabulary());
    return answer_at_a_time(question, file, other_times_, context);
  }
  const auto now = loaded();
  if (wish == Wish::probe) {
    const auto planes = planes_of(int(question["view"].whole()));
    if (!planes) return nothing_there();
    return probe_picture({planes->seen, planes->projection, planes->area, planes->width}, question["at"][0].number(),
                         question["at"][1].number(), now->file, now->prepared, cache_, context);
  }
  DrawnArea area;
  const auto planes = planes_of(int(question["among"]["view"].whole()));
  if (planes) {
    const Shown& shown = now->prepared.shown[0];
    area = {planes->projection, planes->area.x, planes->area.y, shown.stretch, shown.box};
  }
  return answer_about_steps(question, now->file, now->prepared, cache_, planes ? &area : nullptr, context);
}

}  // namespace sg::serve
