// SPDX-License-Identifier: Apache-2.0
#include "render/progressive.h"

#include <algorithm>

#include "base/parallel.h"

namespace sg {

namespace {

/// Each pixel of `coarse` stands for a square of pixels.
void enlarge(const Frame& coarse, int factor, Frame& frame) {
  parallel_for(size_t(frame.height), 16, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y)
      for (size_t x = 0; x < size_t(frame.width); ++x) {
        const size_t from = std::min(y / size_t(factor), size_t(coarse.height) - 1) * size_t(coarse.width) +
                            std::min(x / size_t(factor), size_t(coarse.width) - 1);
        const size_t to = y * size_t(frame.width) + x;
        std::copy_n(&coarse.rgba[4 * from], 4, &frame.rgba[4 * to]);
        frame.depth[to] = coarse.depth[from], frame.ids[to] = coarse.ids[from];
      }
  });
}

}  // namespace

Frame render_progressively(const Scene& scene, const Camera& camera, const RenderOptions& options, Context& context,
                           const std::function<bool(const Frame&, int coarseness)>& show) {
  Frame frame(std::max(options.width, 1), std::max(options.height, 1));
  const bool large = size_t(std::max(options.width, 1)) * size_t(std::max(options.height, 1)) >= size_t(1) << 19;
  for (int factor = large ? 16 : 8; factor > 1; factor /= 2) {
    // A square of pixels with one colour needs no better integral than that.
    Scene rough = scene;
    for (Item& item : rough.items)
      if (auto* volume = std::get_if<VolumeItem>(&item))
        volume->sampling.tolerance = std::min(0.125, 2 * factor * volume->sampling.within());
    RenderOptions coarse = options;
    coarse.width = std::max(1, (options.width + factor - 1) / factor), coarse.height = std::max(1, (options.height + factor - 1) / factor);
    coarse.samples = 1;
    enlarge(render(rough, camera, coarse, context), factor, frame);
    if (!show(frame, factor)) return frame;
  }
  frame = render(scene, camera, options, context);
  show(frame, 1);
  return frame;
}

}  // namespace sg
