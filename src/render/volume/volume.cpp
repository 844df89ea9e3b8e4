// SPDX-License-Identifier: Apache-2.0
#include "render/volume/volume.h"

#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "render/composite/background.h"
#include "render/volume/lattice/packets.h"
#include "render/volume/light/effects.h"
#include "render/volume/prepare_cast.h"

namespace sg::volume {

namespace {

constexpr int tile = 16;  // pixels; rays of a tile meet the same voxels

struct Picture {
  const Projection& projection;
  const FragmentLists& fragments;
  Frame& frame;
  const Knobs& knobs;
  std::vector<CastVolume> volumes;
  std::vector<std::shared_ptr<const Volume>> lattices;  // of each volume; null = no uniform or rectilinear grid
  bool shaded = false;
  struct Lamp {
    Vec3 direction;  // world, unit
    float intensity;
  };
  std::vector<Lamp> lamps;
  const Scene* fading = nullptr;  // with depth_cue: the scene into whose background it fades
};

/// What a tile's rays reuse.
struct Scratch {
  LitRay lit;
  Caster caster;
  std::vector<Fragment> fragments;
};

void light(const Picture& picture, int y, Vec3 origin, Vec3 direction, LitRay& lit) {
  lit.direction = Vec3f(direction), lit.origin = origin, lit.along = direction;
  if (picture.fading) lit.background = background_of_row(*picture.fading, picture.projection, y);
  lit.lights.clear();
  for (const Picture::Lamp& l : picture.lamps)
    lit.lights.push_back({Vec3f(l.direction), Vec3f(normalize(l.direction - direction)), l.intensity});
}

void pixel(const Picture& picture, int x, int y, Scratch& s) {
  const size_t p = size_t(y) * size_t(picture.frame.width) + size_t(x);
  const Projection& projection = picture.projection;
  const Projection::Ray ray = projection.ray(x + 0.5, y + 0.5);
  // depth = first_depth + t * per_length along the ray.
  const double per_length = dot(ray.direction, projection.forward), first_depth = dot(ray.origin - projection.eye, projection.forward);
  const double opaque = double(picture.frame.depth[p]);
  CastRay cast{ray.origin,
               ray.direction,
               (projection.near_plane - first_depth) / per_length,
               (std::min(projection.far_plane, opaque) - first_depth) / per_length,
               nullptr,
               0};
  s.fragments.clear();
  if (!picture.fragments.empty())
    s.fragments.assign(picture.fragments.fragments.begin() + picture.fragments.start[p],
                       picture.fragments.fragments.begin() + picture.fragments.start[p + 1]);
  for (Fragment& f : s.fragments) f.depth = float((double(f.depth) - first_depth) / per_length);
  if (picture.shaded) light(picture, y, ray.origin, ray.direction, s.lit), cast.lights = &s.lit;
  // The same place in the step for a pixel whatever the order of drawing.
  cast.jitter = random_unit(uint64_t(x), uint64_t(y) + uint64_t(std::llround(projection.shift_y)));

  RayState state;
  s.caster.cast(cast, s.fragments, state);
  float* out = &picture.frame.rgba[4 * p];
  state.sum.behind(out);
  out[0] = state.sum.r, out[1] = state.sum.g, out[2] = state.sum.b, out[3] = 1 - state.sum.transmittance;
  // A volume that hides what is behind it can be picked.
  if (state.surface >= 0 && !(opaque < HUGE_VAL))
    picture.frame.depth[p] = float(first_depth + state.surface * per_length), picture.frame.ids[p] = state.surface_id;
}

/// How one volume alone is drawn.
enum class Way { by_rays, in_steps, within_tolerance };

Way way_of(const CastVolume& volume, const PacketPlan& plan) {
  const VolumeItem& item = *volume.item;
  if (!item.clip.empty() || volume.effects) return Way::by_rays;
  const bool composite = item.mode == RayFunction::composite, steps = volume.step > 0;
  if (composite && !steps) return in_tolerant_packets(plan) ? Way::within_tolerance : Way::by_rays;
  const bool plain = composite ? item.sampling.classify == "post" && !item.sampling.jitter : item.mode == RayFunction::maximum;
  return plain && in_packets(plan) ? Way::in_steps : Way::by_rays;
}

void add_effects(const Scene& scene, Picture& picture, const Context& context) {
  Box3 drawn;
  for (const CastVolume& v : picture.volumes) drawn.add(v.source->bounds.lo), drawn.add(v.source->bounds.hi);
  std::vector<Vec3> lamps;
  for (const Picture::Lamp& l : picture.lamps) lamps.push_back(l.direction);
  for (CastVolume& v : picture.volumes) {
    v.effects = light_effects(*v.item, *v.source, *v.medium, lamps, picture.projection, drawn, &context);
    picture.shaded = picture.shaded || v.effects;
    if (v.item->light.depth_cue > 0) picture.fading = &scene;
  }
}

bool any_fragments(const FragmentLists& fragments, const Frame& frame, int x0, int y0, int x1, int y1) {
  if (fragments.empty()) return false;
  for (int y = y0; y < y1; ++y) {
    const size_t row = size_t(y) * size_t(frame.width);
    if (fragments.start[row + size_t(x0)] < fragments.start[row + size_t(x1)]) return true;
  }
  return false;
}

}  // namespace

Course course(const Volume& v, Vec3 origin, Vec3 direction, double from, double to) {
  Course c{v.q(origin), v.to_q * direction, from, to};
  for (int a = 0; a < 3; ++a) {
    if (c.along[a] == 0) {
      // In a face: the upper one belongs to the box like the lower one.
      if (c.start[a] < v.lo[a] || c.start[a] > v.hi[a]) c.leave = c.enter - 1;
      continue;
    }
    const double t0 = (v.lo[a] - c.start[a]) / c.along[a], t1 = (v.hi[a] - c.start[a]) / c.along[a];
    c.enter = std::max(c.enter, std::min(t0, t1)), c.leave = std::min(c.leave, std::max(t0, t1));
  }
  return c;
}

void composite_volumes(const Scene& scene, const Projection& projection, const FragmentLists& fragments, Frame& frame, Context& context,
                       const Knobs& knobs) {
  if (frame.width != projection.width || frame.height != projection.height)
    fail_internal(
        fmt::format("a frame of {} x {} for a projection of {} x {}", frame.width, frame.height, projection.width, projection.height));
  check_fragments(fragments, frame);
  Picture picture{projection, fragments, frame, knobs, {}, {}, false, {}};
  for (size_t i = 0; i < scene.items.size(); ++i)
    if (const auto* item = std::get_if<VolumeItem>(&scene.items[i])) {
      context.check();
      check(*item);
      auto lattice = std::make_shared<const Volume>(prepare(*item, uint32_t(i + 1), knobs));
      if (!(lattice->hi.x > lattice->lo.x)) continue;  // a grid without extent
      picture.lattices.push_back(lattice);
      picture.volumes.push_back(prepare_cast(*item, uint32_t(i + 1), std::move(lattice), knobs, context));
      picture.shaded = picture.shaded || item->shaded;
    }
  if (picture.volumes.empty()) return composite_fragments(fragments, frame, context);
  for (const Light& l : lights_of(scene)) {
    const Vec3 d = l.follows_camera ? projection.right * l.direction.x + projection.up * l.direction.y - projection.forward * l.direction.z
                                    : l.direction;
    picture.lamps.push_back({normalize(d), l.intensity});
  }
  add_effects(scene, picture, context);
  // One volume alone goes in packets of rays, where they can draw it.
  std::optional<PacketPlan> plan;
  Way way = Way::by_rays;
  if (picture.volumes.size() == 1 && picture.lattices[0]) {
    const CastVolume& only = picture.volumes[0];
    plan.emplace(PacketPlan{*picture.lattices[0], projection, knobs, {}, only.material, only.medium.get(), only.budget, float(only.source->edge)});
    if (picture.shaded)
      for (const Picture::Lamp& l : picture.lamps) plan->lamps.push_back({l.direction, l.intensity});
    way = way_of(only, *plan);
  }
  const size_t across = size_t(frame.width + tile - 1) / tile, down = size_t(frame.height + tile - 1) / tile;
  parallel_for(
      across * down, 1,
      [&](size_t begin, size_t end) {
        Scratch scratch{{}, Caster(picture.volumes), {}};
        for (size_t t = begin; t < end; ++t) {
          const int x0 = int(t % across) * tile, y0 = int(t / across) * tile;
          const int x1 = std::min(x0 + tile, frame.width), y1 = std::min(y0 + tile, frame.height);
          if (way != Way::by_rays && !any_fragments(fragments, frame, x0, y0, x1, y1)) {
            (way == Way::in_steps ? march_tile : cast_tile)(*plan, x0, y0, x1, y1, frame);
            continue;
          }
          for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) pixel(picture, x, y, scratch);
        }
      },
      &context);
}

}  // namespace sg::volume

namespace sg {

void composite_volumes(const Scene& scene, const Projection& projection, const FragmentLists& fragments, Frame& frame, Context& context) {
  volume::composite_volumes(scene, projection, fragments, frame, context, volume::Knobs{});
}

}  // namespace sg
