// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/scene/picture_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "image/image.h"
#include "io/file_series.h"
#include "io/lent_series.h"
#include "io/options.h"
#include "io/scene/file_scene.h"

namespace sg {

namespace {

FileScene scene_of_files(const PipelineFile& file, Context& context) {
  FileScene all;
  for (const PipelineFile::Step& step : file.steps) {
    if (!step.reads()) continue;
    ReadParams params;
    Schema schema = schema_of(params);
    set_params(schema, step.words, "read");
    if (is_lent(params.path)) continue;
    const std::string path = series_beside(file.origin, params.path);
    if (names_series(path) || is_folder(path)) continue;
    FileScene one = scene_in_file(path, params.options, context);
    all.cameras.insert(all.cameras.end(), one.cameras.begin(), one.cameras.end());
    all.lights.insert(all.lights.end(), one.lights.begin(), one.lights.end());
  }
  return all;
}

template <class T>
std::vector<std::string> names_of(const std::vector<T>& all) {
  std::vector<std::string> names;
  for (const T& one : all) names.push_back(one.name);
  return names;
}

const FileCamera& camera_named(const std::vector<FileCamera>& cameras, const std::string& name) {
  constexpr const char* where = "camera file";
  if (cameras.empty()) fail_usage("the file that is shown has no cameras", where, "state position and target, or a view");
  for (const FileCamera& c : cameras)
    if (c.name == name) return c;
  if (const auto number = parse_int(name)) {
    if (*number >= 1 && size_t(*number) <= cameras.size()) return cameras[size_t(*number) - 1];
    fail_usage(fmt::format("there is no camera {}", *number), where, fmt::format("the file has {}", cameras.size()));
  }
  fail_usage(fmt::format("there is no camera '{}'", name), where, unknown_name_hint(name, names_of(cameras)));
}

void take_camera(const FileCamera& c, const Box3& box, CameraParams& p) {
  if (p.view || p.direction) return;
  const Vec3 middle = box.center();
  // It turns and zooms about the depth of the data.
  const double depth = box.empty() ? 0 : dot(middle - c.position, c.forward);
  if (!p.position) p.position = c.position;
  if (!p.target) p.target = c.position + c.forward * (depth > 0 ? depth : std::max(box.empty() ? 0.0 : box.diagonal(), 1.0));
  if (!p.up) p.up = c.up;
  if (!p.projection) p.projection = c.parallel ? ProjectionKind::parallel : ProjectionKind::perspective;
  if (c.parallel && !p.height) p.height = c.height;
  if (!c.parallel && !p.view_angle) p.view_angle = std::clamp(c.view_angle, 1.0, 170.0);
}

// Of a surface at the middle of the data that faces it, in lux.
double illuminance(const FileLight& l, Vec3 middle, double diagonal) {
  const double luminance = 0.2126 * double(l.color.x) + 0.7152 * double(l.color.y) + 0.0722 * double(l.color.z);
  if (l.shape == FileLight::Shape::directional) return l.intensity * luminance;
  const double d = std::max(length(l.position - middle), 1e-3 * diagonal);  // as place_lights()
  return l.intensity * luminance / (d * d);
}

// Colours of light are of luminance 1 here, so that its strength is the brightness.
std::string color_text(Vec3f c) {
  const float most = std::max({c.x, c.y, c.z});
  const auto part = [&](float v) { return exact_number(double(srgb_encode(v / most))); };
  return part(c.x) + "," + part(c.y) + "," + part(c.z);
}

LightParams light_of(const FileLight& l, double brightness, Vec3 middle) {
  const auto place = [&](auto params, Vec3 target) {
    params.place.position = l.position, params.place.target = target;
    params.strength.color = color_text(l.color), params.strength.brightness = brightness;
    return params;
  };
  switch (l.shape) {
    case FileLight::Shape::directional: {
      DirectionalLightParams p;
      p.direction = -l.forward, p.angle = 0, p.color = color_text(l.color), p.brightness = brightness;
      return p;
    }
    case FileLight::Shape::spot: {
      SpotLightParams s;
      s.angle = 2 * std::min(l.outer, 90.0), s.inner = 2 * std::min(l.inner, 90.0);
      const double d = length(l.position - middle);
      return place(s, l.position + l.forward * (d > 0 ? d : 1));
    }
    case FileLight::Shape::point: break;
  }
  return place(PointLightParams(), middle);
}

void take_lights(const std::vector<FileLight>& all, const Box3& box, std::vector<LightParams>& lights, std::vector<std::string>& notes) {
  const Vec3 middle = box.center();
  const double diagonal = box.empty() || !(box.diagonal() > 0) ? 1 : box.diagonal();
  std::vector<LightParams> taken;
  for (const LightParams& light : lights) {
    const auto* wish = std::get_if<FileLightParams>(&light);
    if (!wish) {
      taken.push_back(light);
      continue;
    }
    for (const std::string& name : wish->names)
      if (std::none_of(all.begin(), all.end(), [&](const FileLight& l) { return l.name == name; }))
        fail_usage(fmt::format("there is no light '{}'", name), "light file", unknown_name_hint(name, names_of(all)));
    std::vector<const FileLight*> some;
    double sum = 0;
    for (const FileLight& l : all) {
      const bool named = wish->names.empty() || std::find(wish->names.begin(), wish->names.end(), l.name) != wish->names.end();
      const double lux = illuminance(l, middle, diagonal);
      if (named && lux > 0 && std::isfinite(lux)) some.push_back(&l), sum += lux;
    }
    if (some.empty())
      fail_usage("the file that is shown has no lights that shine", "light file", "state others, e.g. --light 'sphere from=left'");
    const double white = wish->lux ? *wish->lux : sum / wish->brightness;  // lux
    std::vector<std::string> names;
    for (const FileLight* l : some) {
      const float most = std::max({l->color.x, l->color.y, l->color.z});
      // By its colour at full strength, which its luminance is a share of.
      const double share = illuminance({l->name, l->shape, l->position, l->forward, {most, most, most}, l->intensity}, middle, diagonal);
      taken.push_back(light_of(*l, share / white, middle)), names.push_back(l->name);
    }
    notes.push_back(fmt::format("lights of the file: {}; white is what gets {} lux", fmt::join(names, ", "), short_number(white)));
  }
  lights = std::move(taken);
}

}  // namespace

void take_from_files(const PipelineFile& file, const Box3& box, StatedPicture& stated, std::vector<std::string>& notes, Context& context) {
  std::vector<LightParams>& lights = stated.lighting.lights;
  const bool lit =
      std::any_of(lights.begin(), lights.end(), [](const LightParams& l) { return std::holds_alternative<FileLightParams>(l); });
  if (stated.camera.file.empty() && !lit) return;
  const FileScene scene = scene_of_files(file, context);
  if (!stated.camera.file.empty()) {
    const FileCamera& c = camera_named(scene.cameras, stated.camera.file);
    take_camera(c, box, stated.camera);
    if (scene.cameras.size() > 1) notes.push_back(fmt::format("camera '{}' of the file's {}", c.name, scene.cameras.size()));
    stated.camera.file.clear();
  }
  if (lit) take_lights(scene.lights, box, lights, notes);
}

std::string note_of_file_scene(const std::vector<Data>& results, const PipelineFile& file) {
  std::string cameras, lights;
  for (const Data& data : results)
    for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
      for (const auto& [key, value] : d->notes())
        if (key == cameras_note && cameras.empty()) cameras = value;
        else if (key == lights_note && lights.empty()) lights = value;
    });
  const bool views = word_value(file.picture, "camera") || !words_under(file.picture, "camera").empty();
  std::string note;
  if (!cameras.empty() && !views) note = fmt::format("the file has cameras ({}): --camera file", cameras);
  if (!lights.empty() && !word_value(file.picture, "lights"))
    note += fmt::format("{} lights ({}): --light file", note.empty() ? "the file has" : ", and", lights);
  return note;
}

}  // namespace sg
