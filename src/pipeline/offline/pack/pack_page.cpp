// SPDX-License-Identifier: Apache-2.0
#include "pipeline/offline/pack/pack_page.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"
#include "pipeline/offline/pack/json_text.h"
#include "pipeline/offline/pack/pack_annotation.h"
#include "pipeline/offline/pack/pack_items.h"

namespace sg::offline {

namespace {

Scene without_box(const Panel& panel) {
  Scene scene = panel.scene;
  if (panel.box_behind && !scene.items.empty()) scene.items.pop_back();
  return scene;
}

Json pack_lights(const Scene& scene) {
  std::vector<Json> lights;
  for (const Light& l : lights_of(scene))
    lights.emplace_back(
        Json::Members{{"direction", numbers(l.direction)}, {"follows", Json(l.follows_camera)}, {"intensity", Json(double(l.intensity))}});
  return Json(std::move(lights));
}

Json pack_step(const PageStep& step, const Packing& packing, Context& context) {
  const Scene scene = without_box(step.panel);
  std::vector<Json> items;
  const PreparedScenePtr prepared = prepare_scene(scene, context);
  for (const raster::PreparedItem& item : prepared->items)
    if (Json packed = pack_item(item, packing); !packed.is_null()) items.push_back(std::move(packed));
  for (const Item& item : scene.items)
    if (const auto* volume = std::get_if<VolumeItem>(&item))
      if (Json packed = pack_volume(*volume, packing, context); !packed.is_null()) items.push_back(std::move(packed));
  Json::Members m{{"items", Json(std::move(items))}, {"annotation", pack_annotation(step.panel, step.stated, packing.scales)}};
  if (step.time) m.emplace_back("time", number(*step.time));
  return Json(std::move(m));
}

std::vector<const PageStep*> every_step(const std::vector<PageStep>& steps, size_t stride) {
  std::vector<const PageStep*> some;
  for (size_t i = 0; i < steps.size(); i += stride) some.push_back(&steps[i]);
  return some;
}

}  // namespace

PackedPage pack_page(const std::vector<const PageStep*>& steps, const Quality& quality, size_t small, Context& context) {
  PackedPage page;
  ScaleStore scales(page.arrays);
  const Packing packing{page.arrays, scales, quality, small, page.notes};
  std::vector<Json> packed;
  for (const PageStep* step : steps) {
    context.check();
    packed.push_back(pack_step(*step, packing, context));
  }
  page.arrays.compress();
  const PageStep& first = *steps.front();
  const Scene& scene = first.panel.scene;
  Json::Members m{{"sightglass", Json(uint64_t(1))},
                  {"camera", pack_camera(first.panel.camera)},
                  {"views", pack_views(first.panel)},
                  {"margin", Json(first.panel.margin)},
                  {"lights", pack_lights(scene)},
                  {"background", numbers(scene.background)},
                  {"background_top", numbers(scene.background_top.value_or(scene.background))},
                  {"transparent", Json(scene.transparent)},
                  {"scales", scales.description()},
                  {"steps", Json(std::move(packed))},
                  {"arrays", page.arrays.description()},
                  {"notes", texts(page.notes)}};
  page.description = Json(std::move(m)).dump();
  return page;
}

PackedPage pack_within(const std::vector<PageStep>& steps, size_t budget, Context& context) {
  const size_t small = budget / 64;
  size_t least = 0;
  for (size_t stride = 1;; stride *= 2) {
    const std::vector<const PageStep*> some = every_step(steps, stride);
    const bool last = some.size() == 1;
    const size_t end = last ? coarsest : coarsest_step;
    std::optional<PackedPage> best;
    const auto fits = [&](size_t grade) {
      // Nothing is small any more where little is left of all.
      PackedPage page = pack_page(some, qualities[grade], grade > coarsest_step ? 0 : small / some.size(), context);
      least = page.bytes();
      if (page.bytes() > budget) return false;
      best = std::move(page);
      return true;
    };
    if (!fits(finest)) {
      size_t bad = finest, good = end + 1;  // `good` fits, but for end + 1, which was not tried
      if (fits(end)) {
        good = end;
        while (good - bad > 1) {
          const size_t middle = (bad + good) / 2;
          if (fits(middle)) good = middle;
          else bad = middle;
        }
      }
    }
    if (best) {
      if (stride > 1) best->notes.push_back(fmt::format("of {} time steps {} are there", steps.size(), some.size()));
      return std::move(*best);
    }
    if (last) fail_usage(fmt::format("a page of this picture has at least {}", human_bytes(least)), "max", "allow more, or show less");
  }
}

}  // namespace sg::offline
