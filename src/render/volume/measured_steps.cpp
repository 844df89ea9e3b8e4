// SPDX-License-Identifier: Apache-2.0
#include "render/volume/measured_steps.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "data/lattice.h"
#include "render/volume/effects/effects.h"
#include "render/volume/sources/lattice/lattice_volume.h"
#include "scene/camera.h"

namespace sg {

namespace {

constexpr int side = 80;           // pixels of the small picture
constexpr double many_turns = 60;  // of its rays on average: from about ten microseconds on
constexpr double near_enough = 8;  // times the tolerance

template <class Items>
auto only_volume(Items& items) {
  decltype(std::get_if<VolumeItem>(&items[0])) only = nullptr;
  for (auto& item : items)
    if (auto* v = std::get_if<VolumeItem>(&item)) {
      if (only) return decltype(only)();
      only = v;
    }
  return only;
}

bool is_left_to_us(const VolumeItem& v) {
  const VolumeSampling& s = v.sampling;
  return !s.tolerance && s.step == 0 && s.classify == VolumeClassify::post && !s.jitter && s.kernel == Kernel::linear &&
         s.gradient == GradientKind::central && s.antialias == VolumeAntialias::none && v.method == VolumeMethod::ray &&
         v.mode == RayFunction::composite && v.shaded && v.detail.plain() && v.light.style == LightStyle::none && v.light.ink == 0 &&
         v.color.labels.empty() && v.group == 0 && !volume::scatters_by_map(v) && v.data && v.data->as<UniformGrid>() && !v.data->bricks();
}

Frame small_picture(const Scene& scene, const Camera& camera, std::atomic<uint64_t>* turns, Context& context) {
  Frame frame(side, side);
  volume::Knobs knobs;
  knobs.turns = turns;
  volume::composite_volumes(scene, make_projection(camera, side, side), {}, frame, context, knobs);
  return frame;
}

std::vector<size_t> pixels_with_something(const Frame& frame) {
  std::vector<size_t> found;
  for (size_t i = 0; i < frame.pixels(); ++i)
    if (frame.rgba[4 * i + 3] > 0) found.push_back(i);
  return found;
}

/// Of some pixels, in ascending order.
std::vector<float> errors(const Frame& truth, const Frame& frame, const std::vector<size_t>& pixels) {
  std::vector<float> found;
  for (const size_t i : pixels) {
    float most = 0;
    for (size_t c = 0; c < 4; ++c) most = std::max(most, std::abs(truth.rgba[4 * i + c] - frame.rgba[4 * i + c]));
    found.push_back(most);
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

std::string MeasuredSteps::text() const {
  const double tolerance = VolumeSampling::usual_tolerance;
  if (step == 0)
    return fmt::format(
        "rough data in light: to keep every ray within {:.2g} of its true light takes long, and no fixed step comes near enough; "
        "tolerance={:.2g} takes about half of it, a smaller --size less",
        tolerance, 5 * tolerance);
  return fmt::format(
      "rough data in light: rays take steps of 1/{} of the distance of samples; of {} rays that were measured 99 in 100 are within {:.2g} "
      "of their true light, all within {:.2g}; tolerance={:.2g} keeps all within that and takes many times as long",
      parts, rays, usual, largest, tolerance);
}

bool steps_may_be_measured(const Scene& scene, const Context& context) {
  const VolumeItem* v = only_volume(scene.items);
  return v && !context.communicator && is_left_to_us(*v) && shortest_spacing(*v->data->as<UniformGrid>()) > 0;
}

std::optional<MeasuredSteps> measure_steps(const Scene& given, Context& outer) {
  if (!steps_may_be_measured(given, outer)) return {};
  Scene scene = given;
  scene.items = {*only_volume(scene.items)};
  auto& drawn = std::get<VolumeItem>(scene.items[0]);
  drawn.light.shadows = drawn.light.occlusion = drawn.light.depth_cue = 0;
  const double spacing = shortest_spacing(*drawn.data->as<UniformGrid>());
  const Camera camera = fit_camera(drawn.data->bounds(), {1, -2, 1}, {0, 0, 1}, 1, 0.02);
  Context context(outer, 0, 1);
  context.on_log = nullptr, context.on_progress = nullptr;

  MeasuredSteps m;
  std::atomic<uint64_t> turns = 0;
  const Frame truth = small_picture(scene, camera, &turns, context);
  const std::vector<size_t> pixels = pixels_with_something(truth);
  m.rays = pixels.size(), m.turns = double(turns) / (side * side);
  outer.log(LogLevel::debug, fmt::format("rays within the tolerance go on {:.0f} times on average", m.turns));
  if (m.turns < many_turns || m.rays == 0) return {};
  for (const int parts : {2, 4, 8}) {
    drawn.sampling.step = spacing / parts;
    const std::vector<float> off = errors(truth, small_picture(scene, camera, nullptr, context), pixels);
    m.usual = double(off[off.size() * 99 / 100]), m.largest = double(off.back());
    outer.log(LogLevel::debug,
              fmt::format("steps of 1/{}: 99 in 100 rays are within {:.4f}, all within {:.4f}", parts, m.usual, m.largest));
    if (m.usual > near_enough * VolumeSampling::usual_tolerance) continue;
    m.step = drawn.sampling.step, m.parts = parts;
    break;
  }
  return m;
}

Scene in_steps(Scene scene, const MeasuredSteps& measured) {
  only_volume(scene.items)->sampling.step = measured.step;
  return scene;
}

}  // namespace sg
