// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/picture_cost.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/text/text.h"
#include "render/volume/measured_steps.h"
#include "scene/show/volume.h"

namespace sg {

namespace {

// Seconds of one thread, measured: a pixel with its legend and its writing, a byte of a surface, and a step of a lit ray.
constexpr double per_pixel = 1e-7, per_byte = 1e-9, per_step = 3e-7;

double surface_seconds(double bytes, double pixels) { return pixels * per_pixel + bytes * per_byte; }
// Of five times the tolerance half the steps are taken.
double volume_seconds(double bytes, double pixels, double tolerance = VolumeSampling::usual_tolerance) {
  const double samples_along = std::cbrt(bytes / 4), usual = VolumeSampling::usual_tolerance;
  const double less = tolerance > 0 ? std::pow(tolerance / usual, -std::log(2) / std::log(5)) : 1;
  return pixels * (per_pixel + samples_along * per_step * less);
}
std::string rounded(double seconds) { return seconds < 0.1 ? "below 0.1 s" : "about " + short_number(seconds, 2) + " s"; }

}  // namespace

std::string explain_drawing(const PipelineFile& file, const PipelineGraph& built) {
  std::vector<Target> targets;
  for (const NodeId n : built.show) targets.push_back({n, {}});
  if (targets.empty()) targets.push_back({built.last, {}});
  const std::vector<PlannedStep> plan = built.graph.plan(targets);
  const auto bytes_of = [&](NodeId n) {
    const auto at = std::find_if(plan.begin(), plan.end(), [&](const PlannedStep& s) { return s.node == n; });
    return at == plan.end() ? 0.0 : double(at->bytes);
  };
  const StatedPicture stated = stated_in(file);
  const double pixels = double(stated.width) * double(stated.height), threads = thread_count();
  std::string text = fmt::format("drawing {} x {} pixels adds ", stated.width, stated.height);
  if (file.show.empty()) {
    const double bytes = bytes_of(built.last);
    return text + fmt::format("{} for surfaces, {} where a volume suits the data\n", rounded(surface_seconds(bytes, pixels) / threads),
                              rounded(volume_seconds(bytes, pixels) / threads));
  }
  double seconds = 0;
  for (size_t i = 0; i < file.show.size(); ++i) {
    const double bytes = bytes_of(built.show[i]);
    const bool volume = file.show[i].kind == auto_show || find_show(file.show[i].kind).is<VolumeShow>();
    seconds += volume ? volume_seconds(bytes, pixels) : surface_seconds(bytes, pixels);
  }
  return text + rounded(seconds / threads) + "\n";
}

std::string note_of_long_drawing(const Scene& scene, double pixels, const Context& context) {
  if (steps_may_be_measured(scene, context)) return "";  // told when that is known
  constexpr double is_long = 15;                         // seconds of processor time
  double seconds = 0, tolerance = 0;
  for (const Item& item : scene.items) {
    const auto* volume = std::get_if<VolumeItem>(&item);
    if (!volume || !volume->shaded || volume->mode != RayFunction::composite || volume->sampling.step > 0) continue;
    tolerance = volume->sampling.within();
    seconds += volume_seconds(4 * double(volume->data->point_count()), pixels, tolerance);
  }
  if (seconds < is_long) return "";
  return fmt::format(
      "drawing {:.3g} million rays through a lit volume, each within {:.2g} of its true light, may take {} s of processor time where few "
      "of them end early; tolerance={:.2g} takes about half of it, a smaller --size less",
      pixels * 1e-6, tolerance, short_number(seconds, 2), 5 * tolerance);
}

}  // namespace sg
