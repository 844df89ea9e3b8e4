// SPDX-License-Identifier: Apache-2.0
// Small scenes whose traced coordinates are their own, and pictures of them by every integrator, in regions with standard errors.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "render/raster/raster_support.h"
#include "render/trace/integrators/bidirectional/whole_picture.h"
#include "render/trace/integrators/integrator.h"
#include "render/trace/integrators/picture_camera.h"
#include "render/trace/sampling/warp.h"
#include "render/volume/volume_support.h"
#include "support/statistics.h"
#include "support/test.h"

namespace sg::trace::test {

inline SurfaceMaterial diffuse() {
  SurfaceMaterial m;
  m.specular_weight = 0;
  return m;
}

/// A flat parallelogram from a corner along two sides.
inline SurfaceItem sheet(Vec3f corner, Vec3f u, Vec3f v, const SurfaceMaterial& made_of, double albedo = 0.6, double opacity = 1) {
  std::vector<float> xyz;
  for (const Vec3f& p : {corner, corner + u, corner + u + v, corner + v}) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  const float srgb = srgb_encode(float(albedo));
  SurfaceItem item = sg::test::item(sg::test::surface(std::move(xyz), {0, 1, 2, 0, 2, 3}), {srgb, srgb, srgb});
  item.made_of = made_of, item.opacity = opacity;
  return item;
}

/// A ball of 2 n (2 n - 2) triangles, with rounded normals or flat ones.
inline SurfaceItem ball(Vec3f middle, float radius, int n, const SurfaceMaterial& made_of, double albedo = 0.6, bool flat = false) {
  SurfaceMesh mesh = std::get<SurfaceMesh>(sg::test::sphere(n, radius)->mesh());
  mesh.points.origin = Vec3(middle);
  const float srgb = srgb_encode(float(albedo));
  SurfaceItem item = sg::test::item(make_dataset(Mesh(std::move(mesh))), {srgb, srgb, srgb});
  item.made_of = made_of, item.flat = flat, item.feature_angle = 180;
  return item;
}

/// Matter in [-side, side]^3 with an extinction of `tau` times f, which is 0 to 1.
inline VolumeItem matter(float side, double tau, const std::function<double(Vec3)>& f, Vec3f color = {1, 1, 1}) {
  VolumeItem v = sg::test::item(sg::test::grid(sg::test::cube(9, -double(side), double(side)), f), sg::test::one_color(color), {});
  v.opacity.points.clear();
  for (int i = 0; i <= 100; ++i) v.opacity.points.push_back({i / 100.0, 1 - std::exp(-tau * i / 100)});
  return v;
}

struct LightScene {
  Scene scene;
  std::vector<AnyLight> lights;
  Environment environment;
  Camera camera;
  int bounces = 4;
  double point_radius = 0;
};

/// The room [-0.9, 0.9]^3 of diffuse walls, its front at y = -0.9 open.
inline void add_room(LightScene& s, double albedo = 0.6) {
  const float a = 0.9f, b = 1.8f;
  s.scene.items.emplace_back(sheet({-a, -a, -a}, {b, 0, 0}, {0, b, 0}, diffuse(), albedo));         // floor
  s.scene.items.emplace_back(sheet({-a, -a, a}, {0, b, 0}, {b, 0, 0}, diffuse(), albedo));          // ceiling
  s.scene.items.emplace_back(sheet({-a, a, -a}, {b, 0, 0}, {0, 0, b}, diffuse(), albedo));          // behind
  s.scene.items.emplace_back(sheet({-a, -a, -a}, {0, b, 0}, {0, 0, b}, diffuse(), 0.75 * albedo));  // left
  s.scene.items.emplace_back(sheet({a, -a, -a}, {0, 0, b}, {0, b, 0}, diffuse(), albedo));          // right
}
inline void add_floor(LightScene& s, double albedo = 0.6) {
  s.scene.items.emplace_back(sheet({-0.9f, -0.9f, -0.9f}, {1.8f, 0, 0}, {0, 1.8f, 0}, diffuse(), albedo));
  // Keeps the scene's box, and is out of the way.
  s.scene.items.emplace_back(sheet({-0.9f, 0.9f, 0.8f}, {0.1f, 0, 0}, {0, 0, 0.1f}, diffuse(), albedo));
}

inline Camera look(Vec3 from, Vec3 at, double angle) {
  Camera c;
  c.position = from, c.target = at, c.up = {0, 0, 1}, c.view_angle = angle, c.near_plane = 0.01, c.far_plane = 20;
  return c;
}

class LitWorld {
 public:
  static constexpr int side = 12;                  // of pictures
  static constexpr int cuts = 3;                   // of regions along a side
  static constexpr int regions = cuts * cuts + 1;  // and the whole

  explicit LitWorld(const LightScene& s, int width = side, int height = side)
      : projection(make_projection(s.camera, width, height)), bounces(s.bounces), world(make(s)) {
    const Placement& p = world.geometry().placement();
    REQUIRE(p.scale == 1);
    REQUIRE(length(p.middle) < 1e-6);
  }

  Projection projection;
  int bounces;
  World world;

 private:
  static World make(const LightScene& s) {
    Context context;
    const PreparedScenePtr prepared = prepare_scene(s.scene, context);
    const std::shared_ptr<Media> media = Media::make(s.scene, make_projection(s.camera, side, side), context);
    std::vector<std::shared_ptr<const trace::Material>> materials;
    for (const raster::PreparedItem& item : prepared->items)
      materials.push_back(std::make_shared<const trace::Material>(item.made_of ? *item.made_of : diffuse()));
    GeometryOptions options;
    options.point_radius = s.point_radius, options.around = media->bounds();
    Geometry geometry = Geometry::make(*prepared, options, context);
    media->place(geometry.placement());
    return {prepared, std::move(geometry), std::move(materials), s.lights, s.environment, media};
  }
};

/// Mean luminance of nine regions and of the whole; mean alpha.
using Moments = sg::test::Moments;
struct Means : std::array<Moments, LitWorld::regions> {
  Moments alpha;
};

inline void add_picture(const Frame& f, Means& means) {
  std::array<double, LitWorld::regions> sum{};
  double alpha = 0;
  for (int y = 0; y < f.height; ++y)
    for (int x = 0; x < f.width; ++x) {
      const float* p = &f.rgba[4 * (size_t(y) * size_t(f.width) + size_t(x))];
      const double v = 0.2126 * double(p[0]) + 0.7152 * double(p[1]) + 0.0722 * double(p[2]);
      const int region = y * LitWorld::cuts / f.height * LitWorld::cuts + x * LitWorld::cuts / f.width;
      sum[size_t(region)] += v * LitWorld::cuts * LitWorld::cuts / double(f.pixels());
      sum[LitWorld::regions - 1] += v / double(f.pixels());
      alpha += double(p[3]) / double(f.pixels());
    }
  for (size_t r = 0; r < sum.size(); ++r) means[r].add(sum[r]);
  means.alpha.add(alpha);
}

inline LightOptions options_of(const LitWorld& w, IntegratorKind kind, int paths, uint64_t seed) {
  LightOptions o;
  o.integrator = kind, o.paths = paths, o.seed = seed, o.bounces = w.bounces;
  o.sampler = SamplerKind::independent, o.noise = 1e-9;
  return o;
}

/// `seeds` independent pictures of so many paths a pixel.
inline Means pictures_by(const LitWorld& w, IntegratorKind kind, int seeds, int paths) {
  Means means;
  Context context;
  for (int seed = 0; seed < seeds; ++seed) {
    const LightOptions o = options_of(w, kind, paths, uint64_t(100 + seed));
    if (lights_whole_picture(kind)) {
      add_picture(draw_whole_picture(w.world, w.projection, o, context).frame, means);
      continue;
    }
    Frame frame(w.projection.width, w.projection.height);
    const auto integrator = path_integrator(w.bounces);
    const PictureCamera camera(w.projection, w.world.geometry().placement());
    parallel_for(frame.pixels(), 8, [&](size_t begin, size_t end) {
      Sampler sampler(o.sampler, o.seed, o.paths);
      for (size_t i = begin; i < end; ++i)
        for (int k = 0; k < paths; ++k) {
          const auto x = uint32_t(i % size_t(frame.width)), y = uint32_t(i / size_t(frame.width));
          sampler.start(x, y, uint32_t(k));
          const Vec2f u = sampler.next2(), on_lens = camera.has_lens() ? concentric_disc(sampler.next2()) : Vec2f();
          const Estimate e = integrator->along(w.world, camera.ray({float(x) + u.x, float(y) + u.y}, on_lens), sampler);
          for (int c = 0; c < 3; ++c) frame.rgba[4 * i + size_t(c)] += e.radiance[c] / float(paths);
          frame.rgba[4 * i + 3] += (1 - e.passed) / float(paths);
        }
    });
    add_picture(frame, means);
  }
  return means;
}

/// Every region of both, and alpha, within four standard errors of their difference.
inline void check_same(const Means& a, const Means& b) {
  CHECK(std::abs(a.alpha.mean - b.alpha.mean) <= 4 * std::hypot(a.alpha.standard_error(), b.alpha.standard_error()) + 1e-4);
  for (size_t r = 0; r < a.size(); ++r) {
    CAPTURE(r);
    CAPTURE(a[r].mean);
    CAPTURE(b[r].mean);
    CAPTURE(a[r].standard_error());
    CAPTURE(b[r].standard_error());
    CHECK(std::abs(a[r].mean - b[r].mean) <= 4 * std::hypot(a[r].standard_error(), b[r].standard_error()) + 1e-6);
  }
}

}  // namespace sg::trace::test
