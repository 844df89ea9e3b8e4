// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/bidirectional/whole_picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "data/memory/memory_budget.h"
#include "render/trace/integrators/bidirectional/picture_integrator.h"
#include "render/trace/integrators/first_met.h"
#include "render/trace/integrators/integrator.h"
#include "render/trace/progress/pixel_noise.h"

namespace sg::trace {

namespace {

constexpr int least_passes = 4;

/// Of a pixel, over all passes.
struct Gathered {
  Vec3 own, splats;  // sums; splats before the factor
  double passed = 0;
  double square = 0, sum = 0;  // of the passes' mean luminance, by their paths
};

double brightness_of(Vec3 c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

std::unique_ptr<PictureIntegrator> make(const PathScene& scene, const LightOptions& options) {
  switch (options.integrator) {
    case IntegratorKind::light: return light_integrator(scene, options);
    case IntegratorKind::bdpt: return bidirectional_integrator(scene, options);
    case IntegratorKind::metropolis: return metropolis_integrator(scene, options);
    default: fail_internal("an integrator that does not light whole pictures");
  }
}

class Gathering {
 public:
  Gathering(int width, int height) : film_(width, height), pixels_(size_t(width) * size_t(height)), width_(size_t(width)) {}

  PassFilm& film() { return film_; }

  /// Takes a pass of n paths a pixel, and clears the film.
  void take(double n, double factor) {
    paths_ += n, passes_ += 1;
    parallel_for(pixels_.size(), width_, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        Gathered& g = pixels_[i];
        const Vec3 splats = film_.splats.sum(i);
        const double mean = brightness_of(film_.own[i] + splats * factor) / n;
        g.own += film_.own[i], g.splats += splats, g.passed += double(film_.passed[i]);
        g.sum += n * mean, g.square += n * mean * mean;
        film_.splats.clear(i), film_.own[i] = {}, film_.passed[i] = 0;
      }
    });
  }

  /// Of the displayed variance.
  struct Variance {
    double of_all = 0, of_seen = 0;  // means over all pixels, and over those in which something is seen
  };
  Variance variance(double factor_error) const {
    if (passes_ < 2) return {};
    struct Part {
      double sum = 0, seen = 0;
    };
    const Part all = parallel_reduce(
        pixels_.size(), width_, Part{},
        [&](size_t begin, size_t end) {
          Part part;
          for (size_t i = begin; i < end; ++i) {
            if (!shows(i)) continue;
            part.sum += displayed_variance(pixels_[i].sum / paths_, variance(i, factor_error)), part.seen += 1;
          }
          return part;
        },
        [](Part a, const Part& b) {
          return Part{a.sum + b.sum, a.seen + b.seen};
        });
    return {all.sum / double(pixels_.size()), all.seen > 0 ? all.sum / all.seen : 0};
  }

  void develop(double factor, double factor_error, Frame& frame, Plane<float>& variances, Plane<float>& errors) const {
    parallel_for(pixels_.size(), width_, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const Vec3 light = pixels_[i].own + pixels_[i].splats * factor;
        for (int c = 0; c < 3; ++c) frame.rgba[4 * i + size_t(c)] = float(light[c] / paths_);
        frame.rgba[4 * i + 3] = float(1 - pixels_[i].passed / paths_);
        const double v = passes_ < 2 || !shows(i) ? 0 : variance(i, factor_error);
        variances[i] = float(v), errors[i] = float(std::sqrt(displayed_variance(pixels_[i].sum / paths_, v)));
      }
    });
  }
  double paths() const { return paths_; }
  double passes() const { return passes_; }

 private:
  bool shows(size_t i) const { return pixels_[i].sum > 0 || pixels_[i].passed < paths_; }
  // Of the luminance of the mean of all passes.
  double variance(size_t i, double factor_error) const {
    const Gathered& g = pixels_[i];
    const double mean = g.sum / paths_, off = mean * factor_error;
    return std::max(0.0, g.square - g.sum * mean) / ((passes_ - 1) * paths_) + off * off;
  }

  PassFilm film_;
  std::vector<Gathered> pixels_;
  size_t width_;
  double paths_ = 0, passes_ = 0;
};

void depths_and_ids(const World& world, const PictureCamera& camera, Frame& frame) {
  parallel_for(size_t(frame.height), 1, [&](size_t y, size_t) {
    const Media::Borrowed media = world.borrow_media();
    see_first_met(world, camera, media.get(), {0, int(y), frame.width, 1}, frame);
  });
}

}  // namespace

bool lights_whole_picture(IntegratorKind kind) {
  return kind == IntegratorKind::light || kind == IntegratorKind::bdpt || kind == IntegratorKind::metropolis;
}

void draw_whole_picture(const World& world, const PictureCamera& camera, const LightOptions& options, Sweeps& sweeps, Frame& frame,
                        Plane<float>& variances, TraceReport& report, Context& context) {
  const Emission emission(world.lights(), world.bounds());
  const int turns = world.has_media() ? options.bounces * (1 + matter_turns) : options.bounces;
  const PathScene scene{world, emission, camera, options.bounces, true, turns};
  const double pixels = camera.pixels();
  need_memory(pixels * double(sizeof(Gathered) + 2 * sizeof(Vec3) + sizeof(float)),
              fmt::format("{}x{} pixels lit as a whole", frame.width, frame.height), "render", "make a smaller picture: --size");
  const auto integrator = make(scene, options);
  Gathering gathering(frame.width, frame.height);
  const auto develop = [&] { gathering.develop(integrator->factor(), integrator->factor_error(), frame, variances, report.planes.error); };
  const auto most = uint32_t(options.stop > 0 ? std::min(options.stop, options.paths) : options.paths);
  const auto size = uint32_t(integrator->pass_size());
  report.reached = false;
  depths_and_ids(world, camera, frame);
  uint32_t n = 0;
  for (bool watched = true; watched && n < most && !report.reached;) {
    // The spread of fewer than two passes tells no error.
    const uint32_t swept = sweeps.next(gathering.passes() < 2 ? 0 : n, size, pixels);
    const uint32_t end = std::min(n + swept, most);
    if (swept == 0) break;
    while (n < end && !report.reached) {
      context.progress(double(n) / double(most), "following light");
      const uint32_t to = std::min(n + size, end);
      integrator->pass(n, to, gathering.film(), context);
      gathering.take(double(to - n), integrator->factor());
      n = to;
      const Gathering::Variance variance = gathering.variance(integrator->factor_error());
      report.paths = gathering.paths(), report.noise = std::sqrt(variance.of_all);
      report.reached = gathering.passes() >= least_passes && std::sqrt(variance.of_seen) <= options.noise;
    }
    sweeps.done();
    if (report.reached || n >= most || !sweeps.wanted()) continue;
    develop();
    watched = sweeps.show(frame, report);
  }
  if (!report.reached && n < most) report.stopped = int(n);
  develop();
}

WholePicture draw_whole_picture(const World& world, const Projection& projection, const LightOptions& options, Context& context) {
  const PictureCamera camera(projection, world.geometry().placement());
  const LightWatch nobody;
  Sweeps sweeps(options, nobody);
  WholePicture picture;
  picture.frame = Frame(projection.width, projection.height);
  TraceReport report;
  report.planes.error.assign(picture.frame.pixels(), 0);
  Plane<float> variances;
  variances.assign(picture.frame.pixels(), 0);
  draw_whole_picture(world, camera, options, sweeps, picture.frame, variances, report, context);
  picture.paths = report.paths, picture.noise = report.noise, picture.reached = report.reached;
  return picture;
}

}  // namespace sg::trace
