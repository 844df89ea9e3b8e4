// SPDX-License-Identifier: Apache-2.0
#include "render/render.h"

#include <fmt/core.h>

#include <algorithm>

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

/// Box filter of n x n pixels in linear light; depth and id of the nearest of them. Fills the rows from `first` on.
void reduce(const Frame& fine, int n, int first, Frame& frame) {
  const float weight = 1.0f / float(n * n);
  parallel_for(size_t(fine.height / n), 8, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y)
      for (size_t x = 0; x < size_t(frame.width); ++x) {
        float sum[4] = {0, 0, 0, 0};
        const size_t to = (size_t(first) + y) * size_t(frame.width) + x;
        for (size_t j = 0; j < size_t(n); ++j)
          for (size_t i = 0; i < size_t(n); ++i) {
            const size_t from = (y * size_t(n) + j) * size_t(fine.width) + x * size_t(n) + i;
            for (size_t k = 0; k < 4; ++k) sum[k] += fine.rgba[4 * from + k];
            if (fine.depth[from] < frame.depth[to]) frame.depth[to] = fine.depth[from], frame.ids[to] = fine.ids[from];
          }
        for (size_t k = 0; k < 4; ++k) frame.rgba[4 * to + k] = sum[k] * weight;
      }
  });
}

/// Pixels of a supersampled band: few enough that its planes stay small, enough that going through the scene once a band costs
/// little. The bands depend on the size of the picture alone.
constexpr size_t band_pixels = size_t(1) << 21;

}  // namespace

Frame render(const Scene& scene, const Camera& camera, const RenderOptions& options, Context& context) {
  if (options.width < 1 || options.height < 1 || options.width > 32768 || options.height > 32768)
    fail_usage(fmt::format("picture size {}x{} is out of range", options.width, options.height), "render",
               "each side must be 1 to 32768 pixels");
  if (options.samples < 0 || options.samples > 8)
    fail_usage(fmt::format("{} samples per pixel and axis", options.samples), "render", "give 1 to 8, or 0 for the default");
  const int n = chosen_samples(scene, options.samples);
  const Projection whole = make_projection(camera, options.width * n, options.height * n);
  const auto prepared = prepare_scene(scene, context);
  Frame frame(options.width, options.height);
  auto draw = [&](const Projection& projection, Frame& into) {
    const FragmentLists fragments = rasterize_prepared(*prepared, projection, n, into, context);
    context.check();
    composite_volumes(scene, projection, fragments, into, context);
  };
  if (n == 1) {
    draw(whole, frame);
  } else {
    const int rows = std::clamp(int(band_pixels / (size_t(whole.width) * size_t(n))), 1, options.height);
    for (int first = 0; first < options.height; first += rows) {
      const int count = std::min(rows, options.height - first);
      Frame band(whole.width, count * n);
      draw(band_of(whole, first * n, count * n), band);
      reduce(band, n, first, frame);
    }
  }
  composite_background(scene, frame);
  return frame;
}

}  // namespace sg
