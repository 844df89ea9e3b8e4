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
  PictureOptions each = options;
  each.on_draft = nullptr;
  std::vector<MeanFrame> means;  // of the panels
  size_t panel = 0;
  each.on_light = [&](Frame& frame) {
    if (panel == means.size()) means.emplace_back();
    means[panel++].add(frame);
  };
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
    // The middle one is the last.
    PipelineFile file = moments[(k + moments.size() / 2 + 1) % moments.size()];
    const PreparedPicture there = prepare_picture(file, each, part);
    for (size_t i = 0; i < moment.shown.size() && i < there.shown.size(); ++i) {
      moment.shown[i].scene = there.shown[i].scene;
      keep_colors(prepared.shown[i].scene, moment.shown[i].scene);
    }
    panel = 0;
    picture = draw_prepared(moment, moment.stated, each, part);
    if (picture.image.pixels.empty()) return picture;
    if (k == 0) {
      stopped = picture.stopped, drawn.light.seconds = 0;
      if (stopped > 0) drawn.light.stop = stopped;
    }
    ++drawn.seed;
  }
  picture.stopped = stopped;
  return picture;
}

void MeanFrame::add(Frame& frame) {
  if (count_++ == 0) sums_.assign(frame.rgba.size(), 0);
  if (frame.rgba.size() != sums_.size()) fail_internal("moments of different sizes");
  for (size_t i = 0; i < sums_.size(); ++i) {
    sums_[i] += double(frame.rgba[i]);
    frame.rgba[i] = float(sums_[i] / double(count_));
  }
}

}  // namespace sg
