// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/scene/shutter.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <type_traits>
#include <variant>

#include "base/error.h"
#include "base/text/text.h"
#include "scene/graph/node_params.h"

namespace sg {

namespace {

double time_of_node(const PipelineFile::Node& n) {
  if (const auto stated = word_value(n.words, "time"))
    if (const auto time = parse_double(*stated)) return *time;
  KeyParams first;
  Schema schema = schema_of(first);
  set_params(schema, n.keys.front(), "node keys");
  return first.time;
}

/// Whether the result of a step is another one at another time, which it states as a number.
std::optional<double> time_of_step(const PipelineFile::Step& s) {
  const auto stated = word_value(s.words, "time");
  return stated ? parse_double(*stated) : std::nullopt;
}

/// Colours mean the same at all moments.
void keep_colors(const Scene& from, Scene& to) {
  for (size_t i = 0; i < from.items.size() && i < to.items.size(); ++i) {
    if (from.items[i].index() != to.items[i].index()) continue;
    std::visit(
        [&](auto& item) {
          using T = std::decay_t<decltype(item)>;
          const T& first = std::get<T>(from.items[i]);
          if constexpr (std::is_same_v<T, VolumeItem>) item.color = first.color, item.opacity = first.opacity;
          else if (item.color_by && first.color_by && item.color_by->field == first.color_by->field)
            item.color_by->scale = first.color_by->scale;
        },
        to.items[i]);
  }
}

bool has_alpha(const Image& image) { return image.channels == 2 || image.channels == 4; }

}  // namespace

std::vector<PipelineFile> moments_of(const PipelineFile& file, const CameraParams& camera) {
  std::vector<PipelineFile> moments;
  const bool moves = std::any_of(file.scene.begin(), file.scene.end(), [](const auto& n) { return !n.keys.empty(); }) ||
                     std::any_of(file.steps.begin(), file.steps.end(), [](const auto& s) { return time_of_step(s).has_value(); });
  if (!(camera.shutter > 0) || !moves) return moments;
  for (int k = 0; k < camera.moments; ++k) {
    PipelineFile& one = moments.emplace_back(file);
    const double off = camera.shutter * ((k + 0.5) / camera.moments - 0.5);
    for (PipelineFile::Node& n : one.scene)
      if (!n.keys.empty()) n.words.push_back("time=" + exact_number(time_of_node(n) + off));  // the last one counts
    for (PipelineFile::Step& s : one.steps)
      if (const auto time = time_of_step(s)) s.words.push_back("time=" + exact_number(*time + off));
  }
  return moments;
}

Picture draw_moments(const std::vector<PipelineFile>& moments, const PreparedPicture& prepared, const PictureOptions& options,
                     Context& context) {
  Picture picture;
  MeanImage mean;
  PictureOptions each = options;
  each.on_draft = nullptr;
  PreparedPicture moment = prepared;
  // Each moment has its own noise, and what time makes of the first one all others get.
  PictureParams& drawn = moment.stated.picture;
  double seconds = drawn.light.seconds;
  if (options.until) {
    const double left = std::chrono::duration<double>(*options.until - std::chrono::steady_clock::now()).count();
    seconds = seconds > 0 ? std::min(seconds, left) : left;
    each.until.reset();
    seconds = std::max(seconds, 1e-3);
  }
  drawn.light.seconds = seconds / double(moments.size());
  int stopped = 0;
  for (size_t k = 0; k < moments.size(); ++k) {
    Context part(context, double(k) / double(moments.size()), double(k + 1) / double(moments.size()));
    if (k > 0) part.on_log = nullptr;  // all say the same
    PipelineFile file = moments[k];
    const PreparedPicture there = prepare_picture(file, each, part);
    for (size_t i = 0; i < moment.shown.size() && i < there.shown.size(); ++i) {
      moment.shown[i].scene = there.shown[i].scene;
      keep_colors(prepared.shown[i].scene, moment.shown[i].scene);
    }
    picture = draw_prepared(moment, moment.stated, each, part);
    if (picture.image.pixels.empty()) return picture;
    if (k == 0) {
      stopped = picture.stopped, drawn.light.seconds = 0;
      if (stopped > 0) drawn.light.stop = stopped;
    }
    ++drawn.seed;
    mean.add(picture.image);
  }
  picture.image = mean.mean(), picture.stopped = stopped;
  return picture;
}

void MeanImage::add(const Image& image) {
  if (count_ == 0) like_ = image, sums_.assign(size_t(image.width) * size_t(image.height) * 4, 0);
  if (image.width != like_.width || image.height != like_.height || image.channels != like_.channels)
    fail_internal("moments of different sizes");
  ++count_;
  const int colors = has_alpha(image) ? image.channels - 1 : image.channels;
  const size_t pixels = size_t(image.width) * size_t(image.height);
  double linear[256];
  for (int v = 0; v < 256; ++v) linear[v] = double(srgb_decode(float(v) / 255));
  for (size_t i = 0; i < pixels; ++i) {
    const uint8_t* p = &image.pixels[i * size_t(image.channels)];
    const double alpha = has_alpha(image) ? p[colors] / 255.0 : 1;
    for (int c = 0; c < colors; ++c) sums_[4 * i + size_t(c)] += linear[p[c]] * alpha;
    sums_[4 * i + 3] += alpha;
  }
}

Image MeanImage::mean() const {
  Image r = like_;
  const int colors = has_alpha(r) ? r.channels - 1 : r.channels;
  const auto byte = [](double v) { return uint8_t(std::clamp(v * 255 + 0.5, 0.0, 255.0)); };
  for (size_t i = 0; i < size_t(r.width) * size_t(r.height); ++i) {
    uint8_t* p = &r.pixels[i * size_t(r.channels)];
    const double alpha = sums_[4 * i + 3];
    for (int c = 0; c < colors; ++c) p[c] = alpha > 0 ? byte(double(srgb_encode(float(sums_[4 * i + size_t(c)] / alpha)))) : 0;
    if (has_alpha(r)) p[colors] = byte(alpha / double(count_));
  }
  return r;
}

}  // namespace sg
