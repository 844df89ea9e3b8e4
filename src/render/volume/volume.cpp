// SPDX-License-Identifier: Apache-2.0
#include "render/volume/volume.h"

#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "data/bricked.h"
#include "render/composite/background.h"
#include "render/volume/cells/cell_source.h"
#include "render/volume/cells/tet_rays.h"
#include "render/volume/classic/layers.h"
#include "render/volume/lattice/packets.h"
#include "render/volume/lattice/reconstructed_ray.h"
#include "render/volume/light/effects.h"
#include "render/volume/prepare_cast.h"

namespace sg::volume {

namespace {

constexpr int tile = 16;  // pixels; rays of a tile meet the same voxels
constexpr int block = 4;  // tiles across and down that one thread draws, so that what they share stays in its cache

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
  // The same place in the step for a pixel of the whole picture, whatever band it is drawn in.
  cast.jitter = random_unit(uint64_t(x), uint64_t(std::llround(2 * y - projection.height - 2 * projection.shift_y)));

  RayState state;
  s.caster.cast(cast, s.fragments, state);
  float* out = &picture.frame.rgba[4 * p];
  state.sum.behind(out);
  out[0] = state.sum.r, out[1] = state.sum.g, out[2] = state.sum.b, out[3] = 1 - state.sum.transmittance;
  // A volume that hides what is behind it can be picked.
  if (state.surface >= 0 && !(opaque < HUGE_VAL))
    picture.frame.depth[p] = float(first_depth + state.surface * per_length), picture.frame.ids[p] = state.surface_id;
}

/// One volume alone, in the fastest way that can draw it.
class Alone {
 public:
  Alone(const Picture& picture, Context& context) : picture_(picture) {
    if (picture.volumes.size() != 1) return;
    const CastVolume& v = picture.volumes[0];
    const VolumeItem& item = *v.item;
    if (!item.clip.empty() || v.detail || v.effects) return;
    const bool composite = item.mode == RayFunction::composite, by_tolerance = composite && !(v.step > 0);
    if (picture.lattices[0]) {
      if (wants_reconstruction(item.sampling)) return;
      plan_.emplace(PacketPlan{
          *picture.lattices[0], picture.projection, picture.knobs, {}, v.material, v.medium.get(), v.budget, float(v.source->edge)});
      if (picture.shaded)
        for (const Picture::Lamp& l : picture.lamps) plan_->lamps.push_back({l.direction, l.intensity});
      const bool in_steps = composite ? item.sampling.classify == "post" && !item.sampling.jitter : item.mode == RayFunction::maximum;
      if (by_tolerance && in_tolerant_packets(*plan_)) {
        packets_ = cast_tile;
        sums_.emplace(*v.medium), bends_ = bends_of(item, *picture.lattices[0]);
        plan_->sums = &*sums_, plan_->bends = bends_.get();
      }
      else if (!by_tolerance && in_steps && in_packets(*plan_)) packets_ = march_tile;
    } else if (by_tolerance && !bricked_of(*item.data) && TetRays::fits(cell_volume_of(*v.source))) {
      tets_.emplace(cell_volume_of(*v.source), picture.projection, *v.medium, context, v.budget.stop_below);
      std::vector<TetLight::Lamp> lamps;
      for (const Picture::Lamp& l : picture.lamps) lamps.push_back({Vec3f(l.direction), l.intensity});
      if (item.shaded) tets_->light(std::move(lamps), item.light, v.per_scale);
    }
  }

  /// Draws a tile; false when it has to go by single rays.
  bool in_blocks() const { return packets_; }  ///< may `draw` take more than a tile at once?
  bool draw(int x0, int y0, int x1, int y1) const {
    if (packets_) packets_(*plan_, x0, y0, x1, y1, picture_.frame);
    else if (tets_) draw_tets(x0, y0, x1, y1);
    return packets_ || tets_;
  }

 private:
  void draw_tets(int x0, int y0, int x1, int y1) const {
    Frame& frame = picture_.frame;
    float limit[TetRays::tile * TetRays::tile];
    TetRays::Pixel found[TetRays::tile * TetRays::tile];
    const int width = x1 - x0;
    const auto place = [&](int x, int y) { return size_t(y) * size_t(frame.width) + size_t(x); };
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        limit[(y - y0) * width + x - x0] = std::min(float(picture_.projection.far_plane), frame.depth[place(x, y)]);
    tets_->draw(x0, y0, width, y1 - y0, limit, found);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        const TetRays::Pixel& from = found[(y - y0) * width + x - x0];
        const size_t p = place(x, y);
        float* out = &frame.rgba[4 * p];
        Gathered sum{from.r, from.g, from.b, from.transmittance};
        sum.behind(out);
        out[0] = sum.r, out[1] = sum.g, out[2] = sum.b, out[3] = 1 - sum.transmittance;
        if (from.half == from.half && !(frame.depth[p] < HUGE_VALF)) frame.depth[p] = from.half, frame.ids[p] = picture_.volumes[0].id;
      }
  }

  const Picture& picture_;
  std::optional<PacketPlan> plan_;
  std::optional<MediumSums> sums_;
  std::shared_ptr<const Bends> bends_;
  void (*packets_)(const PacketPlan&, int, int, int, int, Frame&) = nullptr;
  std::optional<TetRays> tets_;
};
static_assert(tile == TetRays::tile);

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
  draw_layers(scene, projection, frame, context);
  Picture picture{projection, fragments, frame, knobs, {}, {}, false, {}};
  for (size_t i = 0; i < scene.items.size(); ++i)
    if (const auto* item = std::get_if<VolumeItem>(&scene.items[i]); item && item->method == VolumeMethod::ray) {
      context.check();
      check(*item);
      std::shared_ptr<const Volume> lattice;
      const BrickedPtr bricks = bricked_of(*item->data);
      const bool in_bricks = bricks && (item->field.empty() || item->field == bricks->field);
      if (!in_bricks && (item->data->as<UniformGrid>() || item->data->as<RectilinearGrid>())) {
        lattice = std::make_shared<const Volume>(prepare(*item, uint32_t(i + 1), knobs));
        if (!(lattice->hi.x > lattice->lo.x)) continue;  // a grid without extent
      }
      picture.lattices.push_back(lattice);
      picture.volumes.push_back(prepare_cast(*item, uint32_t(i + 1), std::move(lattice), projection, knobs, context));
      picture.shaded = picture.shaded || item->shaded;
    }
  if (picture.volumes.empty()) return composite_fragments(fragments, frame, context);
  for (const Light& l : lights_of(scene)) {
    const Vec3 d = l.follows_camera ? projection.right * l.direction.x + projection.up * l.direction.y - projection.forward * l.direction.z
                                    : l.direction;
    picture.lamps.push_back({normalize(d), l.intensity});
  }
  add_effects(scene, picture, context);
  const Alone alone(picture, context);
  const int across = (frame.width + tile - 1) / tile, down = (frame.height + tile - 1) / tile;
  const int blocks_across = (across + block - 1) / block, blocks_down = (down + block - 1) / block;
  parallel_for(
      size_t(blocks_across) * size_t(blocks_down), 1,
      [&](size_t begin, size_t end) {
        Scratch scratch{{}, Caster(picture.volumes), {}};
        const auto draw = [&](int tx0, int ty0, int tx1, int ty1) {
          const int x0 = tx0 * tile, y0 = ty0 * tile, x1 = std::min(tx1 * tile, frame.width), y1 = std::min(ty1 * tile, frame.height);
          if (!any_fragments(fragments, frame, x0, y0, x1, y1) && alone.draw(x0, y0, x1, y1)) return;
          for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) pixel(picture, x, y, scratch);
        };
        for (size_t b = begin; b < end; ++b) {
          const int tx0 = int(b) % blocks_across * block, ty0 = int(b) / blocks_across * block;
          const int tx1 = std::min(tx0 + block, across), ty1 = std::min(ty0 + block, down);
          if (!knobs.wanted && alone.in_blocks()) {
            const int x1 = std::min(tx1 * tile, frame.width), y1 = std::min(ty1 * tile, frame.height);
            if (!any_fragments(fragments, frame, tx0 * tile, ty0 * tile, x1, y1)) {
              alone.draw(tx0 * tile, ty0 * tile, x1, y1);
              continue;
            }
          }
          for (int ty = ty0; ty < ty1; ++ty)
            for (int tx = tx0; tx < tx1; ++tx)
              if (!knobs.wanted || (*knobs.wanted)[size_t(ty) * size_t(across) + size_t(tx)]) draw(tx, ty, tx + 1, ty + 1);
        }
      },
      &context);
}

}  // namespace sg::volume

namespace sg {

void composite_volumes(const Scene& scene, const Projection& projection, const FragmentLists& fragments, Frame& frame, Context& context,
                       const std::vector<uint8_t>* wanted) {
  volume::Knobs knobs;
  knobs.wanted = wanted;
  volume::composite_volumes(scene, projection, fragments, frame, context, knobs);
}

}  // namespace sg
