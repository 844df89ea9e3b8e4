// SPDX-License-Identifier: Apache-2.0
#include "render/trace/trace.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "render/composite/background.h"
#include "render/prepare/shared_progress.h"
#include "render/trace/integrators/bidirectional/whole_picture.h"
#include "render/trace/integrators/integrator.h"
#include "render/trace/integrators/picture_camera.h"
#include "render/trace/light/luminance.h"
#include "render/trace/sampling/warp.h"
#include "render/trace/studio.h"

namespace sg {

namespace {

using namespace trace;

constexpr int side = 8;        // of the squares of pixels that are finished together
constexpr uint32_t pass = 16;  // paths a pixel between two looks at the error

/// Sums over the paths of a pixel.
struct PixelSum {
  Vec3 light, behind;                      // of what is met, and of what lies around the scene
  double passed = 0, sum = 0, square = 0;  // of the luminance of both

  /// `around`: what is seen where nothing is met.
  void add(const Estimate& e, Vec3f around) {
    const Vec3f seen = around * e.passed;
    const auto y = double(luminance(e.radiance + seen));
    light += Vec3(e.radiance), behind += Vec3(seen), passed += e.passed, sum += y, square += y * y;
  }
  /// The variance of the mean of n, as displayed: by the slope of sRGB's curve there, at least that of a dark grey.
  double variance(uint32_t n) const {
    const double mean = sum / n, v = std::max(0.0, square / n - mean * mean) / (n - 1);
    constexpr float step = 0.01f;
    const float y = std::clamp(float(mean), 2 * step, 1.f);
    const double slope = double(srgb_encode(y + step) - srgb_encode(y - step)) / (2 * double(step));
    return v * slope * slope;
  }
};

struct SquareReport {
  uint64_t paths = 0;
  double variance = 0;
  bool reached = true;
};

void check(const LightOptions& o) {
  if (!(o.noise > 0)) fail_usage(fmt::format("noise {}", o.noise), "trace", "give a share of full scale above 0, e.g. 0.02");
  if (o.paths < 1 || o.paths > 1 << 24) fail_usage(fmt::format("{} paths a pixel", o.paths), "trace", "give 1 to 16777216");
  if (o.bounces < 0 || o.bounces > 1000) fail_usage(fmt::format("{} bounces", o.bounces), "trace", "give 0 to 1000");
}

std::unique_ptr<Integrator> make_integrator(const LightOptions& o) {
  switch (o.integrator) {
    case IntegratorKind::ambient_occlusion: return occlusion_integrator(0.5f);
    case IntegratorKind::whitted: return whitted_integrator(o.bounces);
    case IntegratorKind::path: return path_integrator(o.bounces);
    default: return nullptr;  // of the whole picture
  }
}

World world_of(const Scene& scene, const PreparedScenePtr& prepared, const Projection& projection, Backdrop& backdrop, Context& context) {
  const std::shared_ptr<Media> media = Media::make(scene, projection, context);
  GeometryOptions size;
  size.around = media->bounds();
  const double depth = projection.to_eye(scene_bounds(scene).center()).z;
  size.pixel = projection.parallel ? 1 / projection.scale : std::max(depth, projection.near_plane) / projection.scale;
  Geometry geometry = Geometry::make(*prepared, size, context);
  media->place(geometry.placement());
  SurfaceMaterial plain;
  plain.specular_roughness = 0.45, plain.specular_weight = 0.6;
  const auto of_data = std::make_shared<const trace::Material>(plain);
  std::vector<std::shared_ptr<const trace::Material>> materials;
  for (const raster::PreparedItem& item : prepared->items)
    materials.push_back(item.made_of ? std::make_shared<const trace::Material>(*item.made_of) : of_data);
  Studio studio = studio_of(scene, projection, geometry.placement());
  backdrop = studio.backdrop;
  return {prepared, std::move(geometry), std::move(materials), std::move(studio.lights), std::move(studio.environment), media};
}

/// What is around the scene, as the middle of each pixel sees it.
void put_behind(Frame& frame, const PictureCamera& camera, const Backdrop& backdrop) {
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      float* rgba = &frame.rgba[4 * (size_t(y) * size_t(frame.width) + size_t(x))];
      const Vec3f seen = backdrop.radiance(camera.ray({float(x) + 0.5f, float(y) + 0.5f}).direction);
      for (int c = 0; c < 3; ++c) rgba[c] += (1 - rgba[3]) * seen[c];
      rgba[3] = 1;
    }
}

}  // namespace

Frame trace_scene(const Scene& scene, const PreparedScenePtr& prepared, const Projection& projection, const LightOptions& options,
                  TraceReport& report, Context& context) {
  check(options);
  Backdrop backdrop;
  const World world = world_of(scene, prepared, projection, backdrop, context);
  if (!world.lights().any() && options.integrator != IntegratorKind::ambient_occlusion)
    context.warn("nothing shines: no light, no environment, no material with emission; the picture is dark");
  const auto integrator = make_integrator(options);
  const PictureCamera camera(projection, world.geometry().placement());
  Frame frame(projection.width, projection.height);
  if (world.empty()) {
    if (backdrop.seen) put_behind(frame, camera, backdrop);
    return frame;
  }
  if (lights_whole_picture(options.integrator)) {
    if (world.has_media())
      fail_usage(fmt::format("integrator={} does not light volumes", word_of(options.integrator)), "integrator", "use integrator=path");
    if (projection.lens > 0)
      fail_usage(fmt::format("integrator={} sees through a pinhole", word_of(options.integrator)), "aperture",
                 "leave out aperture=, or use integrator=path");
    WholePicture whole = draw_whole_picture(world, projection, options, context);
    report = {whole.paths, whole.noise, whole.reached};
    if (backdrop.seen) put_behind(whole.frame, camera, backdrop);
    return std::move(whole.frame);
  }
  const auto across = size_t(projection.width + side - 1) / side, down = size_t(projection.height + side - 1) / side;
  std::vector<SquareReport> squares(across * down);
  const bool pictures = std::any_of(prepared->items.begin(), prepared->items.end(), [](const auto& item) { return item.pictures; });
  SharedProgress progress(context, squares.size(), "following light");
  parallel_for(
      across * down, 1,
      [&](size_t begin, size_t end) {
        const Media::Borrowed media = world.borrow_media();
        for (size_t square = begin; square < end; ++square) {
          const int x0 = int(square % across) * side, y0 = int(square / across) * side;
          const int w = std::min(side, projection.width - x0), h = std::min(side, projection.height - y0);
          PixelSum sums[side * side];
          Vec3f around[side];
          for (int y = 0; y < h; ++y) around[y] = background_of_row(scene, projection, y0 + y);
          Sampler sampler(options.sampler, options.seed, options.paths);
          SquareReport& told = squares[square];
          uint32_t n = 0;
          do {
            const uint32_t to = std::min(n + pass, uint32_t(options.paths));
            for (int p = 0; p < w * h; ++p) {
              const int x = x0 + p % w, y = y0 + p / w;
              for (uint32_t k = n; k < to; ++k) {
                sampler.start(uint32_t(x), uint32_t(y), k);
                const Vec2f in_pixel = sampler.next2(), on_lens = camera.has_lens() ? concentric_disc(sampler.next2()) : Vec2f();
                const Vec2f at{float(x) + in_pixel.x, float(y) + in_pixel.y};
                const Ray ray = camera.ray(at, on_lens);
                sums[p].add(integrator->along(world, ray, sampler, pictures ? camera.footprint(at) : RayFootprint()),
                            backdrop.seen ? backdrop.radiance(ray.direction) : around[p / w]);
              }
            }
            n = to;
            told.variance = 0;
            for (int p = 0; p < w * h && n > 1; ++p) told.variance += sums[p].variance(n) / (w * h);
            told.reached = n > 1 && told.variance <= options.noise * options.noise;
          } while (!told.reached && n < uint32_t(options.paths));
          told.paths = n;
          for (int p = 0; p < w * h; ++p) {
            const int x = x0 + p % w, y = y0 + p / w;
            const size_t at = size_t(y) * size_t(frame.width) + size_t(x);
            const Vec3 seen = backdrop.seen ? sums[p].light + sums[p].behind : sums[p].light;
            for (int c = 0; c < 3; ++c) frame.rgba[4 * at + size_t(c)] = float(seen[c] / n);
            frame.rgba[4 * at + 3] = backdrop.seen ? 1 : float(1 - sums[p].passed / n);
            // What the middle of the pixel sees.
            const Vec2f middle{float(x) + 0.5f, float(y) + 0.5f};
            const Ray ray = camera.ray(middle);
            Hit hit;
            if (world.geometry().nearest(ray, hit)) frame.ids[at] = prepared->items[hit.object].id;
            if (media) {
              // Where half of the light is gone; of several volumes at one place, about there.
              RandomStream random(at);
              const float passes = media->passes_exactly({ray.origin, ray.direction, hit.t});
              const auto matter = passes <= 0.5f ? media->collide_surely(0.5f / (1 - passes), random) : std::nullopt;
              if (matter) hit.t = matter->t, frame.ids[at] = matter->item + 1;
            }
            if (frame.ids[at] != 0) frame.depth[at] = float(camera.depth(middle, hit.t));
          }
          progress.step();
        }
      },
      &context);
  report = {};
  double variance = 0;
  for (const SquareReport& s : squares) {
    report.paths += double(s.paths) / double(squares.size()), variance += s.variance / double(squares.size());
    report.reached = report.reached && s.reached;
  }
  report.noise = std::sqrt(variance);
  return frame;
}

}  // namespace sg
