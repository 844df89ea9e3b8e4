// SPDX-License-Identifier: Apache-2.0
#include "render/trace/denoise/features.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/parallel.h"
#include "data/memory/memory_budget.h"
#include "render/trace/sampling/random_stream.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

namespace {

constexpr int most_rays = 8, most_rays_in_matter = 4;  // ways through matter cost more than they tell
constexpr int most_layers = 16;                        // of what is translucent

using Seen = std::array<float, Features::channels>;

void add(Seen& seen, float share, Vec3f albedo, Vec3f normal, float depth) {
  for (int c = 0; c < 3; ++c) {
    seen[size_t(Features::albedo + c)] += share * albedo[c];
    seen[size_t(Features::normal + c)] += share * normal[c];
  }
  seen[Features::depth] += share * depth, seen[Features::cover] += share;
}

Seen seen_along(const World& world, MediaWalk* media, Ray ray, RayFootprint footprint, Sampler& sampler) {
  Seen seen{};
  float share = 1, gone = 0;
  for (int layer = 0; layer < most_layers && share > 1e-3f; ++layer) {
    Hit hit;
    const bool met = world.geometry().nearest(ray, hit);
    if (media) {
      const float u = sampler.next();
      RandomStream random(sampler.stream());
      ray.t_max = hit.t;
      const bool exact = media->exact();
      const float passes = exact ? media->passes_exactly(ray) : 0;
      if (passes < 1)
        if (const auto matter = exact ? media->collide_surely(u, random) : media->collide(ray, u, random)) {
          const float stopped = share * (1 - passes);
          add(seen, stopped, matter->albedo + matter->emission, matter->on_surface ? matter->normal : Vec3f(), gone + matter->t);
          share -= stopped;
        }
    }
    if (!met) break;
    const SurfacePoint point = world.geometry().at(ray, hit);
    const Vec4f color = world.color(ray, hit, footprint);
    const float opacity = std::clamp(color.w, 0.f, 1.f);
    const Vec3f normal = dot(point.face_normal, ray.direction) > 0 ? -point.shading_normal : point.shading_normal;
    gone += hit.t;
    add(seen, share * opacity, {color.x, color.y, color.z}, normal, gone);
    share *= 1 - opacity;
    ray = {leave(point, ray.direction), ray.direction}, footprint = footprint.after(hit.t);
  }
  return seen;
}

}  // namespace

Features features_of(const World& world, const PictureCamera& camera, const LightOptions& options, Context& context) {
  Features f;
  f.width = camera.width(), f.height = camera.height();
  const size_t pixels = size_t(f.width) * size_t(f.height);
  need_memory(double(pixels) * double(2 * sizeof(Seen)), fmt::format("{}x{} pixels to compare", f.width, f.height), "denoise",
              "make a smaller picture: --size");
  for (auto* planes : {&f.mean, &f.variance})
    for (Plane<float>& p : *planes) p.resize(pixels);
  const int rays = std::min(options.paths, world.has_media() ? most_rays_in_matter : most_rays);
  parallel_for(
      size_t(f.height), 1,
      [&](size_t y, size_t) {
        const Media::Borrowed media = world.borrow_media();
        Sampler sampler(options.sampler, options.seed, options.paths);
        for (int x = 0; x < f.width; ++x) {
          std::array<double, Features::channels> sum{}, square{};
          for (int k = 0; k < rays; ++k) {
            sampler.start(uint32_t(x), uint32_t(y), uint32_t(k));
            const Vec2f in_pixel = sampler.next2(), on_lens = camera.has_lens() ? concentric_disc(sampler.next2()) : Vec2f();
            const Vec2f at{float(x) + in_pixel.x, float(y) + in_pixel.y};
            const RayFootprint footprint = world.has_pictures() ? camera.footprint(at) : RayFootprint();
            const Seen seen = seen_along(world, media.get(), camera.ray(at, on_lens), footprint, sampler);
            for (size_t c = 0; c < seen.size(); ++c) sum[c] += double(seen[c]), square[c] += double(seen[c]) * double(seen[c]);
          }
          const size_t i = y * size_t(f.width) + size_t(x);
          for (size_t c = 0; c < sum.size(); ++c) {
            const double mean = sum[c] / rays;
            f.mean[c][i] = float(mean);
            f.variance[c][i] = rays > 1 ? float(std::max(0.0, square[c] / rays - mean * mean) / (rays - 1)) : 0;
          }
        }
      },
      &context);
  return f;
}

void keep_features(const Features& f, const Projection& projection, LightPlanes& planes) {
  const size_t pixels = size_t(f.width) * size_t(f.height);
  planes.albedo.resize(3 * pixels), planes.normal.resize(3 * pixels);
  const Vec3f axes[3] = {Vec3f(projection.right), Vec3f(projection.up), -Vec3f(projection.forward)};
  parallel_for(pixels, size_t(f.width), [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto vector = [&](size_t first) { return Vec3f{f.mean[first][i], f.mean[first + 1][i], f.mean[first + 2][i]}; };
      const Vec3f albedo = vector(Features::albedo), normal = vector(Features::normal);
      for (int c = 0; c < 3; ++c) planes.albedo[3 * i + size_t(c)] = albedo[c], planes.normal[3 * i + size_t(c)] = dot(normal, axes[c]);
    }
  });
}

}  // namespace sg::trace
