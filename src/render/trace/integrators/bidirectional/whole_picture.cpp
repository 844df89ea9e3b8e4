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

  /// The variance of a pixel, as displayed: by the slope of sRGB's curve there, at least that of a dark grey.
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
            const Gathered& g = pixels_[i];
            if (!(g.sum > 0) && g.passed >= paths_) continue;
            const double mean = g.sum / paths_, off = mean * factor_error;
            const double spread = std::max(0.0, g.square - g.sum * mean) / ((passes_ - 1) * paths_) + off * off;
            constexpr float step = 0.01f;
            const float y = std::clamp(float(mean), 2 * step, 1.f);
            const double slope = double(srgb_encode(y + step) - srgb_encode(y - step)) / (2 * double(step));
            part.sum += spread * slope * slope, part.seen += 1;
          }
          return part;
        },
        [](Part a, const Part& b) {
          return Part{a.sum + b.sum, a.seen + b.seen};
        });
    return {all.sum / double(pixels_.size()), all.seen > 0 ? all.sum / all.seen : 0};
  }

  void develop(double factor, Frame& frame) const {
    parallel_for(pixels_.size(), width_, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const Vec3 light = pixels_[i].own + pixels_[i].splats * factor;
        for (int c = 0; c < 3; ++c) frame.rgba[4 * i + size_t(c)] = float(light[c] / paths_);
        frame.rgba[4 * i + 3] = float(1 - pixels_[i].passed / paths_);
      }
    });
  }
  double paths() const { return paths_; }
  double passes() const { return passes_; }

 private:
  PassFilm film_;
  std::vector<Gathered> pixels_;
  size_t width_;
  double paths_ = 0, passes_ = 0;
};

// What the middle of each pixel sees.
void depths_and_ids(const World& world, const PictureCamera& camera, Frame& frame) {
  parallel_for(frame.pixels(), size_t(frame.width), [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec2f middle{float(i % size_t(frame.width)) + 0.5f, float(i / size_t(frame.width)) + 0.5f};
      Hit hit;
      if (!world.geometry().nearest(camera.ray(middle), hit)) continue;
      frame.depth[i] = float(camera.depth(middle, hit.t));
      frame.ids[i] = world.id(hit);
    }
  });
}

}  // namespace

bool lights_whole_picture(IntegratorKind kind) {
  return kind == IntegratorKind::light || kind == IntegratorKind::bdpt || kind == IntegratorKind::metropolis;
}

WholePicture draw_whole_picture(const World& world, const Projection& projection, const LightOptions& options, Context& context) {
  const PictureCamera camera(projection, world.geometry().placement());
  const Emission emission(world.lights(), world.geometry().bounds());
  const PathScene scene{world, emission, camera, options.bounces, true};
  const double pixels = camera.pixels();
  need_memory(pixels * double(sizeof(Gathered) + 2 * sizeof(Vec3) + sizeof(float)),
              fmt::format("{}x{} pixels lit as a whole", projection.width, projection.height), "render", "make a smaller picture: --size");
  const auto integrator = make(scene, options);
  Gathering gathering(projection.width, projection.height);
  WholePicture picture;
  picture.frame = Frame(projection.width, projection.height);
  const auto most = uint32_t(options.paths);
  for (uint32_t n = 0; n < most && !picture.reached;) {
    context.progress(double(n) / double(most), "following light");
    const uint32_t to = std::min(n + uint32_t(integrator->pass_size()), most);
    integrator->pass(n, to, gathering.film(), context);
    gathering.take(double(to - n), integrator->factor());
    n = to;
    const Gathering::Variance variance = gathering.variance(integrator->factor_error());
    picture.noise = std::sqrt(variance.of_all);
    picture.reached = gathering.passes() >= least_passes && std::sqrt(variance.of_seen) <= options.noise;
  }
  picture.paths = gathering.paths();
  gathering.develop(integrator->factor(), picture.frame);
  depths_and_ids(world, camera, picture.frame);
  return picture;
}

}  // namespace sg::trace
