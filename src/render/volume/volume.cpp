// SPDX-License-Identifier: Apache-2.0
#include "render/volume/volume.h"

#include <fmt/core.h>

#include <deque>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "render/composite/background.h"
#include "render/prepare/shared_progress.h"
#include "render/shade/lamp.h"
#include "render/volume/effects/effects.h"
#include "render/volume/effects/scatter_colors.h"
#include "render/volume/engines/engine.h"
#include "render/volume/methods/layers.h"
#include "render/volume/natural_units.h"
#include "render/volume/prepare_cast.h"
#include "render/volume/rays/split_rays.h"

namespace sg::volume {

namespace {

constexpr int block = 4;  // tiles across and down that one thread draws, so that what they share stays in its cache

struct Picture {
  const Projection& projection;
  const FragmentLists& fragments;
  Frame& frame;
  const Knobs& knobs;
  std::vector<CastVolume> volumes;
  std::vector<std::shared_ptr<const Volume>> lattices;  // of each volume; null = no uniform or rectilinear grid
  bool shaded = false;
  std::vector<Lamp> lamps;
  std::vector<LampShadows> shadows;  // of each lamp, when a volume asks for them
  const Scene* scene = nullptr;      // with shadows: whose surfaces they fall on
  float darkest = 0;                 // largest share of the volumes' shadows
  const Scene* fading = nullptr;     // with depth_cue: the scene into whose background it fades
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
  seen_along(picture.lamps, direction, lit.lights);
}

/// What of the lamps' light arrives at a surface behind or in volumes; 1 for what is not lit.
float light_on_surface(const Picture& picture, size_t pixel, Vec3 place) {
  const uint32_t id = picture.frame.ids[pixel];
  if (id == 0 || id > picture.scene->items.size()) return 1;
  const Item& item = picture.scene->items[id - 1];
  const Material* material = nullptr;
  if (const auto* s = std::get_if<SurfaceItem>(&item)) material = &s->material;
  else if (const auto* g = std::get_if<GlyphsItem>(&item)) material = &g->material;
  if (!material || !material->lit) return 1;
  float all = 0, arrives = 0;
  for (size_t i = 0; i < picture.lamps.size(); ++i) {
    all += picture.lamps[i].intensity;
    arrives += picture.lamps[i].intensity * (1 - picture.darkest + picture.darkest * picture.shadows[i].through_volumes(place));
  }
  return all > 0 ? material->ambient + (1 - material->ambient) * arrives / all : 1;
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
  // The same place in the step for a pixel of the whole picture, whatever band it is drawn in.
  cast.jitter =
      random_unit(uint64_t(std::llround(2 * (x - projection.middle_x()))), uint64_t(std::llround(2 * (y - projection.middle_y()))));

  float* out = &picture.frame.rgba[4 * p];
  if (picture.scene && opaque < HUGE_VAL) {
    const float light = light_on_surface(picture, p, ray.origin + ray.direction * ((opaque - first_depth) / per_length));
    for (int k = 0; k < 3; ++k) out[k] *= light;
  }
  RayState state;
  s.caster.cast(cast, s.fragments, state);
  state.sum.behind(out);
  out[0] = state.sum.r, out[1] = state.sum.g, out[2] = state.sum.b, out[3] = 1 - state.sum.transmittance;
  // A volume that hides what is behind it can be picked.
  if (state.surface >= 0 && !(opaque < HUGE_VAL))
    picture.frame.depth[p] = float(first_depth + state.surface * per_length), picture.frame.ids[p] = state.surface_id;
}

/// Depth at which the ray of a pixel leaves the box of a volume, but for rounding; -infinity where it misses.
float leaves(const Projection& p, const Volume& volume, int x, int y) {
  const Projection::Ray ray = p.ray(x + 0.5, y + 0.5);
  const Course c = course(volume, ray.origin, ray.direction, -HUGE_VAL, HUGE_VAL);
  if (!(c.leave > c.enter)) return -HUGE_VALF;
  return float((dot(ray.origin - p.eye, p.forward) + c.leave * dot(ray.direction, p.forward)) * (1 - 2e-6));
}

/// Where a volume asks for shadows, all composited volumes cast them, on each other and on surfaces; surfaces on volumes.
void shadow_lamps(const Scene& scene, Picture& picture, const Box3& drawn, Context& context) {
  const auto shadows = [](const CastVolume& v) { return scatters_by_map(*v.item) ? 1.0 : v.item->light.shadows; };
  const CastVolume* deepest = nullptr;
  for (const CastVolume& v : picture.volumes)
    if (!deepest || shadows(v) > shadows(*deepest)) deepest = &v;
  if (!deepest || !(shadows(*deepest) > 0)) return;
  std::vector<Vec3> directions;
  for (const Lamp& l : picture.lamps) directions.push_back(l.direction);
  picture.shadows.resize(directions.size()), picture.scene = &scene;
  picture.darkest = float(shadows(*deepest));
  for (const CastVolume& v : picture.volumes) {
    if (!info_of(v.item->mode).absorbs) continue;
    const auto maps = light_maps(*v.item, *v.source, v.extinction(), directions, &context);
    for (size_t i = 0; i < maps.size(); ++i) picture.shadows[i].volumes.push_back(maps[i]);
  }
  for (size_t i = 0; i < directions.size(); ++i)
    picture.shadows[i].surfaces = surface_shadow(*deepest->item->data, scene, drawn, directions[i], directions.size(), context);
}

void add_effects(const Scene& scene, Picture& picture, Context& context) {
  Box3 drawn;
  for (const CastVolume& v : picture.volumes) drawn.add(v.source->bounds.lo), drawn.add(v.source->bounds.hi);
  shadow_lamps(scene, picture, drawn, context);
  for (CastVolume& v : picture.volumes) {
    v.effects = light_effects(*v.item, *v.source, v.extinction(), picture.shadows, picture.projection, drawn, &context);
    picture.shaded = picture.shaded || v.effects;
    if (v.item->light.depth_cue > 0) picture.fading = &scene;
  }
}

// Packets where no pixel has fragments inside the volume: those behind it come first. The other pixels go by single rays.
void draw_among(const Picture& picture, const TileEngine& engine, int x0, int y0, int x1, int y1, Scratch& scratch) {
  struct Pixel {
    int x, y;
    float depth;
  };
  std::vector<Pixel> single;
  Frame& frame = picture.frame;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const size_t p = size_t(y) * size_t(frame.width) + size_t(x);
      const size_t first = picture.fragments.start[p], last = picture.fragments.start[p + 1];
      if (first == last) continue;
      if (leaves(picture.projection, *engine.blocks(), x, y) > picture.fragments.fragments[first].depth) {  // the nearest is the first
        single.push_back({x, y, frame.depth[p]});
        frame.depth[p] = -HUGE_VALF;
        continue;
      }
      Gathered sum;
      for (size_t i = first; i < last; ++i) sum.behind(picture.fragments.fragments[i].rgba);
      float* out = &frame.rgba[4 * p];
      sum.behind(out);
      out[0] = sum.r, out[1] = sum.g, out[2] = sum.b, out[3] = 1 - sum.transmittance;
    }
  engine.draw(x0, y0, x1, y1, frame);
  for (const Pixel& s : single) {
    frame.depth[size_t(s.y) * size_t(frame.width) + size_t(s.x)] = s.depth;
    pixel(picture, s.x, s.y, scratch);
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

namespace {

void cast_volumes(const Scene& scene, const Projection& projection, const FragmentLists& fragments, Frame& frame, Context& context,
                  const Knobs& knobs) {
  std::deque<VolumeItem> scattering;
  Picture picture{projection, fragments, frame, knobs, {}, {}, false, {}, {}, nullptr, 0, nullptr};
  for (size_t i = 0; i < scene.items.size(); ++i)
    if (const auto* item = std::get_if<VolumeItem>(&scene.items[i]); item && item->method == VolumeMethod::ray) {
      context.check();
      if (item->pictures && item->pictures->color)
        context.warn("pictures on isosurfaces are seen along paths of light alone: --integrator path shows this one");
      if (scatters_by_map(*item)) item = &scattering.emplace_back(with_scatter_colors(*item));
      std::shared_ptr<const Volume> lattice;
      CastVolume volume = prepare_volume(*item, uint32_t(i + 1), projection, knobs, context, lattice);
      if (!volume.source) continue;
      picture.lattices.push_back(std::move(lattice));
      picture.volumes.push_back(std::move(volume));
      picture.shaded = picture.shaded || item->shaded;
    }
  if (picture.volumes.empty()) return composite_fragments(fragments, frame, context);
  picture.lamps = lamps_of(lights_of(scene), projection);
  add_effects(scene, picture, context);
  std::unique_ptr<TileEngine> engine;
  if (picture.volumes.size() == 1)
    engine = engine_for({picture.volumes[0], picture.lattices[0].get(), projection, picture.lamps, picture.shaded, knobs, context});
  const int across = (frame.width + tile - 1) / tile, down = (frame.height + tile - 1) / tile;
  const int blocks_across = (across + block - 1) / block, blocks_down = (down + block - 1) / block;
  const size_t blocks = size_t(blocks_across) * size_t(blocks_down);
  SharedProgress progress(context, blocks, "drawing");
  parallel_for(
      blocks, 1,
      [&](size_t begin, size_t end) {
        Scratch scratch{{}, Caster(picture.volumes), {}};
        const auto draw = [&](int tx0, int ty0, int tx1, int ty1) {
          const int x0 = tx0 * tile, y0 = ty0 * tile, x1 = std::min(tx1 * tile, frame.width), y1 = std::min(ty1 * tile, frame.height);
          if (engine && !any_fragments(fragments, frame, x0, y0, x1, y1)) return engine->draw(x0, y0, x1, y1, frame);
          for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) pixel(picture, x, y, scratch);
        };
        for (size_t b = begin; b < end; ++b) {
          const int tx0 = int(b) % blocks_across * block, ty0 = int(b) / blocks_across * block;
          const int tx1 = std::min(tx0 + block, across), ty1 = std::min(ty0 + block, down);
          if (!knobs.wanted && engine && engine->blocks()) {
            const int x1 = std::min(tx1 * tile, frame.width), y1 = std::min(ty1 * tile, frame.height);
            if (any_fragments(fragments, frame, tx0 * tile, ty0 * tile, x1, y1))
              draw_among(picture, *engine, tx0 * tile, ty0 * tile, x1, y1, scratch);
            else engine->draw(tx0 * tile, ty0 * tile, x1, y1, frame);
            continue;
          }
          for (int ty = ty0; ty < ty1; ++ty)
            for (int tx = tx0; tx < tx1; ++tx)
              if (!knobs.wanted || (*knobs.wanted)[size_t(ty) * size_t(across) + size_t(tx)]) draw(tx, ty, tx + 1, ty + 1);
        }
        progress.step();
      },
      &context);
}

void composite_natural(const Scene& scene, const Projection& projection, const FragmentLists& fragments, Frame& frame, Context& context,
                       const Knobs& knobs) {
  draw_layers(scene, projection, frame, context);
  // A draft has no rays to spare.
  const std::vector<RaySlab> slabs = knobs.coarser > 1 ? std::vector<RaySlab>() : ray_slabs(scene, projection);
  if (slabs.empty()) return cast_volumes(scene, projection, fragments, frame, context, knobs);
  draw_in_slabs(slabs, scene, projection, fragments, frame, knobs,
                [&](const Scene& s, const Projection& p, const FragmentLists& among, Frame& f, const Knobs& k) {
                  context.check();
                  cast_volumes(s, p, among, f, context, k);
                });
}

}  // namespace

void composite_volumes(const Scene& scene, const Projection& projection, const FragmentLists& fragments, Frame& frame, Context& context,
                       const Knobs& knobs) {
  if (frame.width != projection.width || frame.height != projection.height)
    fail_internal(
        fmt::format("a frame of {} x {} for a projection of {} x {}", frame.width, frame.height, projection.width, projection.height));
  check_fragments(fragments, frame);
  const auto natural = natural_scene(scene);
  if (!natural) return composite_natural(scene, projection, fragments, frame, context, knobs);
  const auto depths_times = [&](double factor) {
    for (float& d : frame.depth) d = float(double(d) * factor);
  };
  depths_times(natural->length);
  composite_natural(natural->scene, natural->projection(projection), natural->fragments(fragments), frame, context, knobs);
  depths_times(1 / natural->length);
}

}  // namespace sg::volume

namespace sg {

void composite_volumes(const Scene& scene, const Projection& projection, const FragmentLists& fragments, Frame& frame, Context& context,
                       const std::vector<uint8_t>* wanted, double coarser) {
  volume::Knobs knobs;
  knobs.wanted = wanted, knobs.coarser = coarser;
  volume::composite_volumes(scene, projection, fragments, frame, context, knobs);
}

}  // namespace sg
