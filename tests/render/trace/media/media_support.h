// SPDX-License-Identifier: Apache-2.0
// Volumes in light that is known, seen along single rays.
#pragma once
#include <cmath>
#include <memory>
#include <vector>

#include "render/trace/integrators/integrator.h"
#include "render/volume/sources/cells/volume_cells_support.h"
#include "render/volume/volume_support.h"

namespace sg::trace::test {

using namespace sg::test;

/// The volumes of a scene, in coordinates of their own.
inline std::shared_ptr<Media> media_of(const Scene& scene, Tracking tracking = Tracking::mixed) {
  Context context;
  const std::shared_ptr<Media> media = Media::make(scene, parallel_view(8, 8, 1), context);
  for (ParticipatingMedium& m : media->media()) m.use(tracking);
  media->place(Placement::of(media->bounds()));
  return media;
}

/// Volumes and nothing else.
inline World world_of(const Scene& scene, std::vector<AnyLight> lights, Environment environment, Tracking tracking = Tracking::mixed) {
  Context context;
  const std::shared_ptr<Media> media = media_of(scene, tracking);
  const PreparedScenePtr prepared = prepare_scene(scene, context);
  GeometryOptions options;
  options.around = media->bounds();
  Geometry geometry = Geometry::make(*prepared, options, context);
  media->place(geometry.placement());
  SurfaceMaterial matte;
  matte.specular_weight = 0;
  std::vector<std::shared_ptr<const trace::Material>> materials(prepared->items.size(), std::make_shared<const trace::Material>(matte));
  return {prepared, std::move(geometry), std::move(materials), std::move(lights), std::move(environment), media};
}

/// From world coordinates.
inline Ray ray_of(const Placement& p, Vec3 from, Vec3 direction) { return {p.traced(from), normalize(Vec3f(direction))}; }

struct Mean {
  double value = 0, error = 0, passed = 0;
};
template <class F>  // an Estimate of each sample
Mean mean(int n, F&& f) {
  Mean m;
  double square = 0;
  for (int i = 0; i < n; ++i) {
    const Estimate e = f(i);
    m.value += double(e.radiance.x) / n, square += double(e.radiance.x) * double(e.radiance.x) / n, m.passed += double(e.passed) / n;
  }
  m.error = std::sqrt(std::max(0.0, square - m.value * m.value) / n);
  return m;
}
inline Mean seen(const World& world, Vec3 from, Vec3 direction, int n, int bounces = 100, uint64_t seed = 1) {
  const Ray ray = ray_of(world.geometry().placement(), from, direction);
  const auto integrator = path_integrator(bounces);
  Sampler sampler(SamplerKind::independent, seed, n);
  return mean(n, [&](int i) {
    sampler.start(0, 0, uint32_t(i));
    return integrator->along(world, ray, sampler);
  });
}

/// Of extinction tau everywhere.
inline VolumeItem even(DatasetPtr data, double tau, Vec3f color = {1, 1, 1}) {
  return item(std::move(data), one_color(color), constant_opacity(tau));
}
/// Tetrahedra over [-1, 1]^3.
inline DatasetPtr tets_of(const std::function<double(Vec3)>& f) {
  return with_field(test::cube(CellType::tetra, 6, [](Vec3 p) { return p * 2.0 - Vec3{1, 1, 1}; }), f);
}
/// A curvilinear grid over it, bent inside.
inline DatasetPtr curvilinear_of(const std::function<double(Vec3)>& f) {
  CurvilinearGrid g;
  g.dims = {7, 6, 5};
  std::vector<double> xyz;
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 7; ++i) {
        const Vec3 p = bent({i / 6.0, j / 5.0, k / 4.0}) * 2.0 - Vec3{1, 1, 1};
        xyz.insert(xyz.end(), {p.x, p.y, p.z});
      }
  g.points.xyz = Array::from_vector(std::move(xyz), 3);
  DatasetParts parts;
  parts.mesh = std::move(g);
  return with_field(std::move(parts), f);
}
inline double one(Vec3) { return 1; }

}  // namespace sg::trace::test
