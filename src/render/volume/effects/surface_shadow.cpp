// SPDX-License-Identifier: Apache-2.0
#include "render/volume/effects/surface_shadow.h"

#include <algorithm>
#include <cmath>

#include "data/memory/memo.h"
#include "render/raster/raster.h"
#include "render/volume/medium/optical_depth.h"

namespace sg::volume {

bool casts_shadow(const Item& item) {
  if (const auto* s = std::get_if<SurfaceItem>(&item)) return s->opacity >= 1;
  const auto* g = std::get_if<GlyphsItem>(&item);
  return g && g->opacity >= 1 && !g->in_pixels;
}

SurfaceShadow::SurfaceShadow(const Scene& scene, const Box3& receivers, Vec3 towards, int side, Context& context) {
  Scene opaque;
  Box3 all = receivers;
  for (const Item& item : scene.items) {
    if (!casts_shadow(item)) continue;
    opaque.items.push_back(item);
    if (auto* s = std::get_if<SurfaceItem>(&opaque.items.back())) {
      s->edges = false, s->color_by.reset(), s->lic.reset(), s->material.lit = false;
      casters_.push_back(s->data);
    } else if (auto* g = std::get_if<GlyphsItem>(&opaque.items.back())) {
      g->color_by.reset(), g->material.lit = false;
      casters_.push_back(g->data);
    }
  }
  if (opaque.items.empty() || receivers.empty()) return;
  const Box3 bounds = scene_bounds(opaque);
  all.add(bounds.lo), all.add(bounds.hi);
  Camera camera;
  const Vec3 middle = (receivers.lo + receivers.hi) * 0.5, l = normalize(towards);
  const double reach = length(all.hi - all.lo) + length(middle - (all.lo + all.hi) * 0.5);
  camera.position = middle + l * reach, camera.target = middle;
  camera.up = std::abs(l.y) < 0.9 ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  camera.parallel = true, camera.parallel_height = std::max(length(receivers.hi - receivers.lo), 1e-300);
  camera.near_plane = 0, camera.far_plane = 2 * reach;
  from_lamp_ = make_projection(camera, side, side);
  hair_ = 2 / from_lamp_.scale;
  Frame frame(side, side);
  rasterize(opaque, from_lamp_, 1, frame, context);
  depth_.assign(frame.depth.begin(), frame.depth.end());
}

float SurfaceShadow::lit(Vec3 place) const {
  if (depth_.empty()) return 1;
  const Vec3 p = from_lamp_.to_pixel(place);
  const double x = p.x - 0.5, y = p.y - 0.5;
  const int n = from_lamp_.width;
  if (!(x > -1 && y > -1 && x < n && y < n)) return 1;
  const int i = int(std::floor(x)), j = int(std::floor(y));
  const float f = float(x - i), g = float(y - j);
  float share = 0;
  for (int c = 0; c < 4; ++c) {
    const int u = i + (c & 1), v = j + (c >> 1);
    const bool inside = u >= 0 && v >= 0 && u < n && v < n;
    const bool hidden = inside && double(depth_[size_t(v) * size_t(n) + size_t(u)]) < p.z - hair_;
    if (!hidden) share += (c & 1 ? f : 1 - f) * (c >> 1 ? g : 1 - g);
  }
  return share;
}

std::shared_ptr<const SurfaceShadow> surface_shadow(const Dataset& memo_of, const Scene& scene, const Box3& receivers, Vec3 towards,
                                                    size_t lamps, Context& context) {
  std::string key;
  append_numbers(key, {receivers.lo.x, receivers.lo.y, receivers.lo.z, receivers.hi.x, receivers.hi.y, receivers.hi.z});
  append_numbers(key, {towards.x, towards.y, towards.z});
  bool any = false;
  const auto add_pointer = [&key](const void* p) { key.append(reinterpret_cast<const char*>(&p), sizeof p); };
  for (const Item& item : scene.items) {
    if (!casts_shadow(item)) continue;
    any = true;
    if (const auto* s = std::get_if<SurfaceItem>(&item)) add_pointer(s->data.get());
    // Which shapes stand where has no short name: glyphs are drawn anew.
    else if (std::holds_alternative<GlyphsItem>(item))
      return std::make_shared<const SurfaceShadow>(scene, receivers, towards, 1024, context);
  }
  if (!any) return nullptr;
  const auto kept = memo_of.memo().keep("volume surface shadows", Recent<SurfaceShadow>(), 0);
  return kept->get(key, std::max<size_t>(2, lamps), [&] { return SurfaceShadow(scene, receivers, towards, 1024, context); });
}

}  // namespace sg::volume
