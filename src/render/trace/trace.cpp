// SPDX-License-Identifier: Apache-2.0
#include "render/trace/trace.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "render/composite/background.h"
#include "render/composite/marks.h"
#include "render/prepare/picture_set.h"
#include "render/raster/raster.h"
#include "render/trace/denoise/denoise.h"
#include "render/trace/denoise/features.h"
#include "render/trace/integrators/bidirectional/whole_picture.h"
#include "render/trace/integrators/integrator.h"
#include "render/trace/integrators/picture_camera.h"
#include "render/trace/progress/sweeps.h"
#include "render/trace/squares.h"
#include "render/trace/studio.h"

namespace sg {

namespace {

using namespace trace;

void check(const LightOptions& o) {
  if (!(o.noise > 0)) fail_usage(fmt::format("noise {}", o.noise), "trace", "give a share of full scale above 0, e.g. 0.02");
  if (o.paths < 1 || o.paths > 1 << 24) fail_usage(fmt::format("{} paths a pixel", o.paths), "trace", "give 1 to 16777216");
  if (!(o.seconds >= 0)) fail_usage(fmt::format("{} seconds", o.seconds), "trace", "give seconds above 0, or 0 for no limit");
  if (o.stop < 0) fail_usage(fmt::format("stop={}", o.stop), "trace", "give a number of paths a pixel, or 0 for none");
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
  Isosurfaces isosurfaces = isosurfaces_of(scene, projection, context);
  size.more = std::move(isosurfaces.objects);
  Geometry geometry = Geometry::make(*prepared, size, context);
  media->place(geometry.placement());
  const auto of_data = std::make_shared<const trace::Material>(data_material());
  std::vector<std::shared_ptr<const trace::Material>> materials;
  const auto add = [&](const std::optional<SurfaceMaterial>& made_of, bool varies) {
    materials.push_back(made_of ? std::make_shared<const trace::Material>(*made_of, geometry.placement().scale, 1, varies) : of_data);
  };
  for (const raster::PreparedItem& item : prepared->items) add(item.made_of, item.pictures && !item.pictures->factors.empty());
  for (const Isosurfaces::Look& look : isosurfaces.looks) add(look.made_of, look.patches && !look.patches->all().pictures->factors.empty());
  Studio studio = studio_of(scene, projection, geometry.placement());
  backdrop = studio.backdrop;
  PictureLook look(*prepared, projection, size.pixel, texture_scene(*prepared, projection, context));
  return {prepared, std::move(geometry),          std::move(materials), std::move(studio.lights), std::move(studio.environment),
          media,    std::move(isosurfaces.looks), scene.shows,          std::move(look)};
}

/// What paths from the lights alone do not find.
void tell_what_is_left_out(const Scene& scene, Context& context) {
  bool surfaces = false, glow = false;
  for (const Item& item : scene.items) {
    const auto* v = std::get_if<VolumeItem>(&item);
    if (!v || v->mode != RayFunction::composite) continue;
    const bool shines = v->scattering.light == VolumeLighting::emission;
    surfaces = surfaces || (v->shaded && !shines), glow = glow || shines || v->scattering.glow > 0;
  }
  if (surfaces)
    context.info(
        "surfaces within volumes are left out, which paths from the lights do not find: shaded=no shows them as matter, integrator=bdpt as "
        "they are");
  if (glow)
    context.info("what glows in volumes is seen and lights nothing, as paths begin at lamps alone; integrator=bdpt finds its light");
}

/// What is around the scene, as the middle of each pixel sees it.
void put_behind(Frame& frame, const PictureCamera& camera, const Backdrop& backdrop, const Frame* marks) {
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const size_t i = size_t(y) * size_t(frame.width) + size_t(x);
      float* rgba = &frame.rgba[4 * i];
      Vec3f seen = backdrop.radiance(camera.ray({float(x) + 0.5f, float(y) + 0.5f}).direction);
      if (marks) seen = seen_behind(*marks, i, seen);
      for (int c = 0; c < 3; ++c) rgba[c] += (1 - rgba[3]) * seen[c];
      rgba[3] = 1;
    }
}

}  // namespace

Frame trace_scene(const Scene& scene, const PreparedScenePtr& prepared, const Projection& projection, const LightOptions& options,
                  TraceReport& report, Context& context, const LightWatch& watch, const Frame* marks) {
  check(options);
  Backdrop backdrop;
  const PictureCamera* eye = nullptr;
  LightWatch whole_watch = watch;  // of pictures that get what is around the scene at the end
  if (watch.on_frame && lights_whole_picture(options.integrator))
    whole_watch.on_frame = [&](const Frame& frame, const TraceReport& so_far) {
      if (!backdrop.seen) return watch.on_frame(frame, so_far);
      Frame all = frame;
      put_behind(all, *eye, backdrop, marks);
      return watch.on_frame(all, so_far);
    };
  Sweeps sweeps(options, whole_watch);
  World world = world_of(scene, prepared, projection, backdrop, context);
  if (!world.lights().any() && options.integrator != IntegratorKind::ambient_occlusion)
    context.warn("nothing shines: no light, no environment, no material with emission; the picture is dark");
  if (options.integrator != IntegratorKind::path && options.integrator != IntegratorKind::ambient_occlusion && world.walks_below())
    context.info("light that wanders below surfaces comes out where it went in: integrator=path follows it");
  const auto integrator = make_integrator(options);
  const PictureCamera camera(projection, world.geometry().placement());
  eye = &camera;
  world.look_from(camera.ray({float(projection.width) / 2, float(projection.height) / 2}));
  Frame frame(projection.width, projection.height);
  report = {};
  report.planes.error.assign(frame.pixels(), 0);
  if (world.empty()) {
    if (backdrop.seen) put_behind(frame, camera, backdrop, marks);
    return frame;
  }
  Plane<float> variance, behind;
  variance.assign(frame.pixels(), 0);
  if (lights_whole_picture(options.integrator)) {
    if (std::any_of(prepared->items.begin(), prepared->items.end(), [](const auto& i) { return i.pictures && i.pictures->isolines; }))
      context.info(
          "lines of equal value are left out: their width is one of pixels, which paths from the lights do not know; "
          "integrator=path draws them");
    if (options.integrator == IntegratorKind::light) tell_what_is_left_out(scene, context);
    draw_whole_picture(world, camera, options, sweeps, frame, variance, report, context);
  } else {
    LitPicture picture{world, camera, backdrop, {}, options, marks};
    for (int y = 0; y < frame.height; ++y) picture.around.push_back(background_of_row(scene, projection, y));
    draw_squares(picture, *integrator, sweeps, frame, behind, variance, report, context);
  }
  if (options.denoise || options.features) {
    const Features features = features_of(world, camera, options, context);
    if (options.denoise) denoise(features, variance, frame, context);
    if (options.features) keep_features(features, projection, report.planes);
  }
  if (!behind.empty()) add_behind(behind, frame);
  else if (backdrop.seen) put_behind(frame, camera, backdrop, marks);
  return frame;
}

}  // namespace sg
