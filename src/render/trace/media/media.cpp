// SPDX-License-Identifier: Apache-2.0
#include "render/trace/media/media.h"

#include <fmt/core.h>

#include "base/error.h"
#include "data/bricked.h"
#include "render/volume/effects/scatter_colors.h"
#include "render/volume/natural_units.h"
#include "render/volume/prepare_cast.h"

namespace sg::trace {

namespace {

void check(const VolumeItem& item) {
  if (item.mode != RayFunction::composite && item.mode != RayFunction::isosurface)
    fail_usage(fmt::format("mode={} shows no matter that light could meet", info_of(item.mode).name), "integrator",
               "use mode=composite or mode=isosurface, or leave integrator out");
  if (item.method != VolumeMethod::ray)
    fail_usage(fmt::format("method={} does not follow light", word_of(item.method)), "integrator",
               "use method=ray, or leave integrator out");
  if (item.scattering.light == VolumeLighting::map)
    fail_usage("light=map belongs to pictures without an integrator", "integrator",
               "use light=single or light=path, or leave integrator out");
}

void check_glow(const VolumeItem& item, const ColorScale& shown) {
  const bool glows = item.scattering.black_body && item.scattering.glow > 0 && item.scattering.light != VolumeLighting::emission;
  if (glows && !(shown.hi >= 100 && shown.hi > shown.lo))
    fail_usage(fmt::format("the range of the colours ends at {}, which is no temperature that glows", shown.hi), "black_body",
               "state a range in kelvin, e.g. range=300,1800, of a field that is one (calc makes it of others)");
}

}  // namespace

std::shared_ptr<Media> Media::make(const Scene& scene, const Projection& projection, Context& context) {
  auto out = std::make_shared<Media>();
  for (const Item& item : scene.items)
    if (const auto* v = std::get_if<VolumeItem>(&item)) check(*v);
  auto natural = volume::natural_scene(scene);
  const double length = natural ? natural->length : 1;
  const Projection inner = natural ? natural->projection(projection) : projection;
  const auto own = std::make_shared<Scene>(natural ? std::move(natural->scene) : scene);
  out->scene_ = own;
  // Bricks are read for what a camera sees; light goes everywhere.
  volume::Knobs knobs;
  knobs.coarser = 0;
  for (size_t i = 0; i < own->items.size(); ++i) {
    auto* item = std::get_if<VolumeItem>(&own->items[i]);
    if (!item || item->mode != RayFunction::composite) continue;
    context.check();
    if (item->scattering.light != VolumeLighting::emission) *item = volume::with_scatter_colors(std::move(*item));
    if (const BrickedPtr bricks = item->data->bricks(); bricks && bricks->levels.size() > 1)
      context.info("a volume in bricks is lit at the level that is in memory; --memory allows more");
    const VolumeLight& l = item->light;
    if (l.shadows > 0 || l.occlusion > 0 || l.depth_cue > 0 || l.style != LightStyle::none || l.ink > 0)
      context.info("shadows=, occlusion=, depth_cue=, style= and ink= are left out: paths have their own shadows");
    std::shared_ptr<const volume::Volume> lattice;
    volume::CastVolume prepared = volume::prepare_volume(*item, uint32_t(i + 1), inner, knobs, context, lattice);
    if (!prepared.source) continue;
    const auto& stated = std::get<VolumeItem>(scene.items[i]);
    const ColorScale& shown = stated.detail.color_by_second ? stated.detail.second_color : stated.color;
    check_glow(stated, shown);
    out->media_.emplace_back(std::move(prepared), uint32_t(i), length, Range{shown.lo, shown.hi});
    const Box3 b = out->media_.back().bounds();
    if (!b.empty()) out->bounds_.add(b.lo), out->bounds_.add(b.hi);
  }
  return out;
}

Media::Borrowed Media::borrow() const { return media_.empty() ? Borrowed() : walks_.borrow(); }

}  // namespace sg::trace
