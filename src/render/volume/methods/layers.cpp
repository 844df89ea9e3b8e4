// SPDX-License-Identifier: Apache-2.0
#include "render/volume/methods/layers.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"

namespace sg::volume {

namespace {

Layer layer_of(const LayerInput& input) {
  switch (input.item.method) {
    case VolumeMethod::splat: return splat(input);
    case VolumeMethod::slices: return slices(input);
    case VolumeMethod::shear_warp: return shear_warp(input);
    case VolumeMethod::fourier: return fourier(input);
    case VolumeMethod::cells: return project_cells(input);
    case VolumeMethod::ray: break;
  }
  fail_internal("rays are not a layer");
}

}  // namespace

void draw_layers(const Scene& scene, const Projection& projection, Frame& frame, Context& context) {
  struct Entry {
    double depth;
    size_t item;
  };
  std::vector<Entry> order;
  for (size_t i = 0; i < scene.items.size(); ++i)
    if (const auto* item = std::get_if<VolumeItem>(&scene.items[i]); item && item->method != VolumeMethod::ray) {
      if (!item->data) fail_usage("a volume item has no dataset", "volume");
      order.push_back({projection.to_eye(item->data->bounds().center()).z, i});
    }
  std::stable_sort(order.begin(), order.end(), [](const Entry& a, const Entry& b) { return a.depth > b.depth; });
  const std::vector<Light> lights = lights_of(scene);
  for (const Entry& e : order) {
    context.check();
    const Layer layer = layer_of({std::get<VolumeItem>(scene.items[e.item]), projection, frame, lights, context});
    parallel_for(frame.pixels(), 65536, [&](size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p) {
        const float* top = &layer.rgba[4 * p];
        float* out = &frame.rgba[4 * p];
        for (int k = 0; k < 4; ++k) out[k] = top[k] + (1 - top[3]) * out[k];
        if (top[3] > 0.5f && !(frame.depth[p] < HUGE_VALF)) frame.depth[p] = float(e.depth), frame.ids[p] = uint32_t(e.item + 1);
      }
    });
  }
}

}  // namespace sg::volume
