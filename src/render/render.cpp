// SPDX-License-Identifier: Apache-2.0
#include "render/render.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "render/composite/background.h"
#include "render/raster/raster.h"
#include "render/volume/volume.h"

namespace sg {

namespace {

int chosen_samples(const Scene& scene, int asked) {
  if (asked > 0) return asked;
  for (const Item& item : scene.items)
    if (std::holds_alternative<SurfaceItem>(item)) return 2;  // lines, dots and volumes have soft edges of their own
  return 1;
}

/// Box filter of n x n pixels in linear light; depth and id of the nearest of them.
Frame reduced(const Frame& fine, int n) {
  Frame frame(fine.width / n, fine.height / n);
  const float weight = 1.0f / float(n * n);
  parallel_for(size_t(frame.height), 8, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y)
      for (size_t x = 0; x < size_t(frame.width); ++x) {
        float sum[4] = {0, 0, 0, 0};
        const size_t to = y * size_t(frame.width) + x;
        for (size_t j = 0; j < size_t(n); ++j)
          for (size_t i = 0; i < size_t(n); ++i) {
            const size_t from = (y * size_t(n) + j) * size_t(fine.width) + x * size_t(n) + i;
            for (size_t k = 0; k < 4; ++k) sum[k] += fine.rgba[4 * from + k];
            if (fine.depth[from] < frame.depth[to]) frame.depth[to] = fine.depth[from], frame.ids[to] = fine.ids[from];
          }
        for (size_t k = 0; k < 4; ++k) frame.rgba[4 * to + k] = sum[k] * weight;
      }
  });
  return frame;
}

}  // namespace

Frame render(const Scene& scene, const Camera& camera, const RenderOptions& options, Context& context) {
  if (options.width < 1 || options.height < 1 || options.width > 32768 || options.height > 32768)
    fail_usage(fmt::format("picture size {}x{} is out of range", options.width, options.height), "render",
               "each side must be 1 to 32768 pixels");
  if (options.samples < 0 || options.samples > 8)
    fail_usage(fmt::format("{} samples per pixel and axis", options.samples), "render", "give 1 to 8, or 0 for the default");
  const int n = chosen_samples(scene, options.samples);
  Frame frame(options.width * n, options.height * n);
  const Projection projection = make_projection(camera, frame.width, frame.height);
  const FragmentLists fragments = rasterize(scene, projection, n, frame, context);
  context.check();
  composite_volumes(scene, projection, fragments, frame, context);
  if (n > 1) frame = reduced(frame, n);
  composite_background(scene, frame);
  return frame;
}

}  // namespace sg
