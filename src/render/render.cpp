// SPDX-License-Identifier: Apache-2.0
#include "render/render.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "data/memory/memory_budget.h"
#include "render/composite/background.h"
#include "render/composite/marks.h"
#include "render/raster/raster.h"
#include "render/trace/integrators/bidirectional/whole_picture.h"
#include "render/trace/trace.h"
#include "render/volume/volume.h"

namespace sg {

namespace {

/// Volumes in which rays meet surfaces, whose silhouettes are sharp.
bool has_silhouettes(const Item& item) {
  const auto* v = std::get_if<VolumeItem>(&item);
  return v && (v->mode == RayFunction::isosurface || v->mode == RayFunction::first_hit);
}

struct Samples {
  int across = 1;       ///< of a pixel
  double adaptive = 0;  ///< RenderOptions::adaptive
};
Samples chosen_samples(const Scene& scene, const RenderOptions& options) {
  if (options.samples > 0) return {options.samples, options.adaptive};
  const auto any = [&](auto&& of) { return std::any_of(scene.items.begin(), scene.items.end(), of); };
  // Lines, dots and volumes have soft edges of their own.
  if (any([](const Item& i) { return std::holds_alternative<SurfaceItem>(i) || std::holds_alternative<GlyphsItem>(i); }))
    return {2, options.adaptive};
  if (!any(has_silhouettes)) return {};
  constexpr double seen = 1.0 / 32;  // rays are dear, and most of a surface is smooth
  return {2, options.adaptive > 0 ? options.adaptive : seen};
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

/// Squares of `side` pixels, by rows of ceil(width/side), in which or beside which a pixel of one sample differs from a neighbour.
std::vector<uint8_t> uneven_squares(const Frame& frame, int side, double threshold) {
  const int across = (frame.width + side - 1) / side, down = (frame.height + side - 1) / side;
  std::vector<uint8_t> uneven(size_t(across) * size_t(down));
  const auto differ = [&](size_t p, size_t q) {
    if (frame.ids[p] != frame.ids[q]) return true;
    for (size_t k = 0; k < 4; ++k) {
      const auto shown = [&](size_t i) { return std::sqrt(std::clamp(double(frame.rgba[4 * i + k]), 0.0, 1.0)); };  // near sRGB's curve
      if (std::abs(shown(p) - shown(q)) > threshold) return true;
    }
    return false;
  };
  parallel_for(size_t(down), 1, [&](size_t begin, size_t end) {
    for (int j = int(begin); j < int(end); ++j)
      for (int i = 0; i < across; ++i) {
        bool any = false;
        for (int y = std::max(0, j * side - 1); y < std::min(frame.height - 1, (j + 1) * side) && !any; ++y)
          for (int x = std::max(0, i * side - 1); x < std::min(frame.width - 1, (i + 1) * side) && !any; ++x) {
            const size_t p = size_t(y) * size_t(frame.width) + size_t(x);
            any = differ(p, p + 1) || differ(p, p + size_t(frame.width));
          }
        uneven[size_t(j) * size_t(across) + size_t(i)] = any;
      }
  });
  return uneven;
}

/// Pixels of a supersampled band: few enough that its planes stay small, enough that going through the scene once a band costs
/// little. The bands depend on the size of the picture alone.
constexpr size_t band_pixels = size_t(1) << 21;

// What became of the noise that was asked for: of each part of the picture, or of all that shows something.
std::string unreached(const TraceReport& report, const LightOptions& light) {
  if (report.reached) return "";
  const char* where = trace::lights_whole_picture(light.integrator) ? "where there is something" : "everywhere";
  if (report.stopped > 0 && light.seconds > 0)
    return fmt::format("; noise={} was not reached {} in {:.3g} s, enough for {} paths a pixel there", light.noise, where, light.seconds,
                       report.stopped);
  if (report.stopped > 0) return fmt::format("; stopped before noise={} was reached {}", light.noise, where);
  if (light.stop > 0 && light.stop < light.paths)
    return fmt::format("; noise={} was not reached {} with stop={}", light.noise, where, light.stop);
  return fmt::format("; noise={} was not reached {} with paths={}", light.noise, where, light.paths);
}

Frame render_light(const Scene& whole, const Camera& camera, const RenderOptions& options, TraceReport& report, Context& context) {
  check_picture_memory(options.width, options.height, 2);
  Scene scene = whole;
  const Scene beside = take_marks(scene);
  std::optional<Frame> marks;
  if (!beside.items.empty()) {
    RenderOptions lines;
    lines.width = options.width, lines.height = options.height;
    Context silent(context, 0, 0.01);
    silent.on_log = nullptr;
    marks = render(beside, camera, lines, silent);
  }
  LightWatch watch;
  watch.every = options.watch.every, watch.so_far = options.watch.so_far;
  if (options.watch.on_frame)
    watch.on_frame = [&](const Frame& light, const TraceReport& so_far) {
      Frame frame = light;
      if (marks) put_marks(*marks, frame);
      composite_background(scene, frame);
      return options.watch.on_frame(frame, so_far);
    };
  Frame frame = trace_scene(scene, prepare_scene(scene, context), make_projection(camera, options.width, options.height), *options.light,
                            report, context, watch, marks ? &*marks : nullptr);
  if (marks) put_marks(*marks, frame);
  composite_background(scene, frame);
  context.info(fmt::format("light: {}{}{}", light_text(report), unreached(report, *options.light),
                           options.light->denoise ? "; denoised, the error is that before" : ""));
  return frame;
}

}  // namespace

void check_picture_memory(int width, int height, int frames) {
  const double pixels = double(width) * double(height);
  constexpr double bytes_of_frame = 24, bytes_of_image = 8;  // of a pixel: rgba, depth, id; the image, and what is packed of it
  need_memory(pixels * (bytes_of_frame * frames + bytes_of_image), fmt::format("{}x{} pixels", width, height), "render",
              "make a smaller picture: --size");
}

std::string light_text(const TraceReport& report) {
  if (report.paths < 1.5) return "1 path a pixel, too few to know the error";
  return fmt::format("{:.0f} paths a pixel on average, standard error {:.4f} of full scale", report.paths, report.noise);
}

Frame render(const Scene& scene, const Camera& camera, const RenderOptions& options, Context& context, TraceReport* report) {
  if (options.width < 1 || options.height < 1 || options.width > 32768 || options.height > 32768)
    fail_usage(fmt::format("picture size {}x{} is out of range", options.width, options.height), "render",
               "each side must be 1 to 32768 pixels");
  if (options.samples < 0 || options.samples > 8)
    fail_usage(fmt::format("{} samples per pixel and axis", options.samples), "render", "give 1 to 8, or 0 for the default");
  if (options.light) {
    TraceReport own;
    return render_light(scene, camera, options, report ? *report : own, context);
  }
  const auto [n, threshold] = chosen_samples(scene, options);
  const Projection whole = make_projection(camera, options.width * n, options.height * n);
  const bool adaptive = threshold > 0 && n > 1;
  check_picture_memory(options.width, options.height, adaptive ? 2 : 1);
  const auto prepared = prepare_scene(scene, context);
  const auto textures = n > 1 ? texture_scene(*prepared, make_projection(camera, options.width, options.height), context) : nullptr;
  Frame frame(options.width, options.height);
  auto draw = [&](const Projection& projection, int samples, const std::vector<uint8_t>* wanted, Frame& into, Context& part) {
    const FragmentLists fragments = rasterize_prepared(*prepared, projection, samples, into, part, textures.get());
    part.check();
    composite_volumes(scene, projection, fragments, into, part, wanted, options.coarser);
  };
  if (n == 1) {
    draw(whole, 1, nullptr, frame, context);
  } else {
    // One sample first, where that may do.
    constexpr int tile = 16;
    const int side = tile / n;
    std::vector<uint8_t> uneven;
    Frame single(adaptive ? options.width : 1, adaptive ? options.height : 1);
    if (adaptive) {
      Context part(context, 0, 0.2);
      draw(make_projection(camera, options.width, options.height), 1, nullptr, single, part);
      uneven = uneven_squares(single, side, threshold);
    }
    const size_t across = size_t(options.width + side - 1) / size_t(side);
    int rows = std::clamp(int(band_pixels / (size_t(whole.width) * size_t(n))), 1, options.height);
    if (adaptive) rows = std::max(rows / side, 1) * side;  // squares are not cut by bands
    for (int first = 0; first < options.height; first += rows) {
      const int count = std::min(rows, options.height - first);
      Frame band(whole.width, count * n);
      std::vector<uint8_t> wanted;
      if (adaptive) wanted.assign(uneven.begin() + ptrdiff_t(across * size_t(first / side)), uneven.end());
      const auto drawn = [&](int row) { return (adaptive ? 0.2 : 0) + (adaptive ? 0.8 : 1) * row / options.height; };
      Context part(context, drawn(first), drawn(first + count));
      draw(band_of(whole, first * n, count * n), n, adaptive && side * n == tile ? &wanted : nullptr, band, part);
      if (first + count < options.height) part.progress(1, "drawing");
      reduce(band, n, first, frame);
      for (int y = first; adaptive && y < first + count; ++y)
        for (int x = 0; x < options.width; ++x) {
          if (uneven[across * size_t(y / side) + size_t(x / side)]) continue;
          const size_t p = size_t(y) * size_t(options.width) + size_t(x);
          std::copy_n(&single.rgba[4 * p], 4, &frame.rgba[4 * p]);
          frame.depth[p] = single.depth[p], frame.ids[p] = single.ids[p];
        }
    }
  }
  composite_background(scene, frame);
  return frame;
}

}  // namespace sg
