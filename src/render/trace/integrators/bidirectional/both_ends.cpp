// SPDX-License-Identifier: Apache-2.0
// light and bdpt: each sample of a pixel has a path from the camera through it and one from a light.
#include <algorithm>
#include <optional>

#include "base/parallel.h"
#include "render/trace/integrators/bidirectional/picture_integrator.h"
#include "render/trace/integrators/bidirectional/strategies.h"

namespace sg::trace {

namespace {

/// Vertices of a path from a light that each one of the camera's is joined with: those of paths through media are many.
constexpr int most_joined = 16;

/// What a sample needs, kept from one to the next.
struct Halves {
  SubPath camera, light;
  Strategies strategies;
};

class BothEnds : public PictureIntegrator {
 public:
  BothEnds(const PathScene& scene, const LightOptions& options, bool joins) : scene_(scene), options_(options), joins_(joins) {}

  int pass_size() const override { return std::clamp(options_.paths / 4, 1, 4); }

  void pass(uint32_t from, uint32_t to, PassFilm& film, Context& context) override {
    const int width = scene_.camera.width(), height = scene_.camera.height();
    parallel_for(
        size_t(height), 1,
        [&](size_t begin, size_t end) {
          Sampler sampler(options_.sampler, options_.seed, options_.paths);
          SamplerNumbers numbers(sampler);
          Halves halves{{}, {}, Strategies(scene_)};
          for (size_t y = begin; y < end; ++y)
            for (int x = 0; x < width; ++x)
              for (uint32_t k = from; k < to; ++k) {
                sampler.start(uint32_t(x), uint32_t(y), k);
                const Vec2f in_pixel = sampler.next2();
                // The camera alone sees what shines itself, and the background.
                MediaWalk* media = halves.strategies.media();
                walk_from_camera(scene_, media, {float(x) + in_pixel.x, float(y) + in_pixel.y}, joins_ ? scene_.turns + 1 : 1, numbers,
                                 halves.camera);
                walk_from_light(scene_, media, scene_.turns, numbers, halves.light);
                const size_t pixel = y * size_t(width) + size_t(x);
                film.own[pixel] += Vec3(halves.camera.straight) + (joins_ ? join(halves, numbers) : Vec3());
                film.passed[pixel] += halves.camera.passed;
                for (int i = 0; i < int(halves.light.vertices.size()); ++i)
                  if (const auto c = halves.strategies.onto_picture(halves.light, i, numbers))
                    film.splats.add(c->pixel, Vec3(c->value) * (joins_ ? halves.strategies.weight(*c) : 1));
              }
        },
        &context);
  }

 private:
  // Of all ways with two vertices or more from the camera.
  Vec3 join(Halves& h, Numbers& numbers) const {
    Vec3 sum;
    const auto add = [&](const std::optional<Contribution>& c, double times = 1) {
      if (c) sum += Vec3(c->value) * (h.strategies.weight(*c) * times);
    };
    for (const Stretch& stretch : h.camera.stretches)
      for (const MetLight& m : h.strategies.met_in(stretch)) add(h.strategies.met(h.camera, stretch, m));
    for (int j = 0; j < int(h.camera.vertices.size()); ++j) {
      const int level = h.camera.vertex(j).level;
      add(h.strategies.shining(h.camera, j));
      if (level > scene_.turns) continue;
      add(h.strategies.asked(h.camera, j, numbers));
      // One of each part of a long path.
      const int all = int(h.light.vertices.size()), parts = std::min(all, most_joined);
      for (int k = 0; k < parts; ++k) {
        const int i = all == parts ? k : std::min(int((float(k) + numbers.next()) * float(all) / float(parts)), all - 1);
        if (level + h.light.vertex(i).level <= scene_.turns)
          add(h.strategies.joined(h.light, i, h.camera, j, numbers), double(all) / parts);
      }
    }
    return sum;
  }

  PathScene scene_;
  LightOptions options_;
  bool joins_;
};

}  // namespace

std::unique_ptr<PictureIntegrator> light_integrator(const PathScene& scene, const LightOptions& options) {
  return std::make_unique<BothEnds>(scene, options, false);
}
std::unique_ptr<PictureIntegrator> bidirectional_integrator(const PathScene& scene, const LightOptions& options) {
  return std::make_unique<BothEnds>(scene, options, true);
}

}  // namespace sg::trace
