// SPDX-License-Identifier: Apache-2.0
#include "render/raster/raster.h"

#include <fmt/core.h>

#include <cstring>

#include "base/error.h"
#include "base/parallel.h"
#include "render/raster/discs/discs.h"
#include "render/raster/fragments.h"
#include "render/raster/glyphs/glyphs.h"
#include "render/raster/lic/textures.h"
#include "render/raster/marks/marks.h"
#include "render/raster/pictures.h"
#include "render/raster/triangles/bins.h"
#include "render/raster/triangles/key_plane.h"
#include "render/shade/shade.h"

namespace sg {

namespace raster {
namespace {

constexpr uint32_t no_primitive = 0xFFFFFFFFu, no_item = no_primitive;
constexpr size_t triangle_chunk = 1 << 14, glyph_chunk = 1 << 10;
constexpr int small_triangle = 16;  ///< pixels; below this size a triangle is drawn at once

class Drawing {
 public:
  Drawing(const PreparedScene& scene, const Projection& projection, double pixel_scale, Frame& frame, Context& context,
          const RenderTextures* textures)
      : scene_(scene),
        projection_(projection),
        pixel_scale_(pixel_scale),
        frame_(frame),
        context_(context),
        textures_(textures),
        grid_(projection.width, projection.height),
        lights_(lamps_of(scene.lights, projection)),
        keys_(size_t(projection.width) * size_t(projection.height)) {}

  FragmentLists run() {
    draw_small();
    RenderTextures own;
    if (!textures_ && scene_.textured()) {
      own = texture();
      textures_ = &own;
    }
    fragments_.resize(grid_.count());
    parallel_for(
        grid_.count(), 1, [&](size_t tile, size_t) { draw_tile(tile); }, &context_);
    return collect(fragments_, grid_, frame_);
  }

  /// The textures of what is seen, after draw_small().
  RenderTextures texture() {
    parallel_for(
        grid_.count(), 1, [&](size_t tile, size_t) { draw_large(opaque_, opaque_bins_, tile, keys_.data()); }, &context_);
    large_drawn_ = true;
    RenderTextures t{projection_.width, projection_.height, {}, std::vector<int>(scene_.items.size(), -1)};
    t.layers.push_back(surface_texture(scene_, views_, keys_.data(), -1, pixel_scale_, context_));
    for (size_t i = 0; i < scene_.items.size(); ++i) {
      const PreparedItem& item = scene_.items[i];
      if (!item.lic) continue;
      if (!item.translucent) {
        t.layer_of[i] = 0;
        continue;
      }
      // What is seen through has a picture of its own, of its nearest side.
      KeyPlane keys(size_t(projection_.width) * size_t(projection_.height));
      clear(keys);
      std::vector<TriangleRecord> large;
      draw_surface(item, views_[i], small_triangle, keys.data(), large);
      const Bins bins = bin(large.size(), grid_, [&](size_t k) { return pixel_box(large[k], projection_.width, projection_.height); });
      parallel_for(grid_.count(), 1, [&](size_t tile, size_t) { draw_large(large, bins, tile, keys.data()); });
      t.layer_of[i] = int(t.layers.size());
      t.layers.push_back(surface_texture(scene_, views_, keys.data(), int(i), pixel_scale_, context_));
    }
    return t;
  }

  /// Small triangles, discs and records of all that is binned.
  void draw_small() {
    clear(keys_);
    const int width = projection_.width, height = projection_.height;
    size_t opaque_items = 0;
    for (const PreparedItem& item : scene_.items) {
      views_.push_back(eye_view(projection_, item.kind == PreparedItem::Kind::surface ? item.triangles.origin : item.origin));
      if (item.kind == PreparedItem::Kind::surface) {
        if (item.glyphs) views_.back() = eye_view(projection_, item.origin);
        if (!item.translucent) only_ = opaque_items++ ? no_item : uint32_t(&item - scene_.items.data());
        if (item.glyphs) draw_glyph_item(item, views_.back(), item.translucent ? translucent_ : opaque_);
        else
          draw_surface(item, views_.back(), item.translucent ? 0 : small_triangle, keys_.data(), item.translucent ? translucent_ : opaque_);
      } else if (item.discs) {
        only_ = opaque_items++ ? no_item : uint32_t(&item - scene_.items.data());
        const DiscJob job{views_.back(),
                          reinterpret_cast<const float*>(item.positions.raw()),
                          reinterpret_cast<const float*>(item.disc_normals.raw()),
                          reinterpret_cast<const float*>(item.disc_radius.raw()),
                          item.points ? item.points->data() : nullptr,
                          item.first_primitive,
                          keys_.data()};
        const size_t n = item.primitives;
        const bool back = last_is_nearer(job, n);
        parallel_for(
            n, triangle_chunk, [&](size_t begin, size_t end) { draw_discs(job, back ? n - end : begin, back ? n - begin : end); },
            &context_);
      } else {
        const auto number = uint32_t(&item - scene_.items.data());
        const std::vector<MarkRecord> m =
            item.glyphs ? glyph_marks(item, number, projection_, pixel_scale_) : mark_records(item, number, projection_, pixel_scale_);
        marks_.insert(marks_.end(), m.begin(), m.end());
      }
    }
    auto triangle_box = [&](const std::vector<TriangleRecord>& r) { return [&](size_t i) { return pixel_box(r[i], width, height); }; };
    opaque_bins_ = bin(opaque_.size(), grid_, triangle_box(opaque_));
    translucent_bins_ = bin(translucent_.size(), grid_, triangle_box(translucent_));
    mark_bins_ = bin(marks_.size(), grid_, [&](size_t i) { return mark_box(marks_[i], width, height); });
  }

 private:
  void clear(KeyPlane& keys) {
    const uint64_t empty = empty_key(float(projection_.far_plane));
    parallel_for(
        size_t(projection_.width) * size_t(projection_.height), 1 << 16,
        [&](size_t begin, size_t end) { std::fill(keys.data() + begin, keys.data() + end, empty); }, &context_);
  }

  void draw_surface(const PreparedItem& item, const EyeView& view, int small, uint64_t* keys, std::vector<TriangleRecord>& large) {
    const TriangleSet& t = item.triangles;
    const TriangleJob job{view, t.xyz(), t.indices(), item.first_primitive, small, keys};
    draw_chunks(t.count, triangle_chunk, large, [&](size_t begin, size_t end, auto& part) { draw_triangles(job, begin, end, part); });
  }

  void draw_glyph_item(const PreparedItem& item, const EyeView& view, std::vector<TriangleRecord>& large) {
    const GlyphJob job{
        view,        item.glyphs.get(), item.first_primitive, item.translucent ? 0 : small_triangle, !item.translucent, float(pixel_scale_),
        keys_.data()};
    draw_chunks(item.glyphs->instances->count(), glyph_chunk, large,
                [&](size_t begin, size_t end, auto& part) { draw_glyphs(job, begin, end, part); });
  }

  /// draw(begin, end, records) for chunks of n things; the records go behind `large` in the order of the chunks.
  template <class F>
  void draw_chunks(size_t n, size_t chunk, std::vector<TriangleRecord>& large, F&& draw) {
    const size_t chunks = (n + chunk - 1) / chunk;
    std::vector<std::vector<TriangleRecord>> parts(chunks);
    parallel_for(
        n, chunk, [&](size_t begin, size_t end) { draw(begin, end, parts[begin / chunk]); }, &context_);
    std::vector<size_t> start(chunks);
    for (size_t i = 0; i < chunks; ++i) start[i] = parts[i].size();
    const size_t before = large.size(), more = exclusive_scan(start);
    large.resize(before + more);
    parallel_for(chunks, 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) std::copy(parts[i].begin(), parts[i].end(), large.begin() + ptrdiff_t(before + start[i]));
    });
  }

  void draw_large(const std::vector<TriangleRecord>& records, const Bins& bins, size_t tile, uint64_t* keys) {
    const PixelBox box = grid_.box(tile);
    bins.each(tile, [&](uint32_t i) {
      PixelBox b = pixel_box(records[i], projection_.width, projection_.height);
      b = {std::max(b.x0, box.x0), std::max(b.y0, box.y0), std::min(b.x1, box.x1), std::min(b.y1, box.y1)};
      draw_record(records[i], b, projection_.parallel, keys, projection_.width);
    });
  }

  void draw_tile(size_t tile) {
    const PixelBox box = grid_.box(tile);
    if (!large_drawn_) draw_large(opaque_, opaque_bins_, tile, keys_.data());
    shade_opaque(box);
    if (!translucent_bins_.any(tile) && !mark_bins_.any(tile)) return;
    std::vector<Cover> covers;
    cover_translucent(tile, box, covers);
    MarkTile marks(box, projection_, keys_.data());
    mark_bins_.each(tile, [&](uint32_t i) { marks.draw(marks_[i], covers); });
    for (Cover& c : covers)
      if (const PreparedItem& item = scene_.items[c.item]; item.kind != PreparedItem::Kind::surface)
        color_mark(item, lights_, projection_, &frame_.rgba[4 * pixel_in_frame(box, c.pixel, frame_.width)], c);
    fragments_[tile] = resolve(scene_, box, covers, frame_);
  }

  struct Seen {
    uint32_t item, pixel, primitive;
  };

  template <class Job>
  void shade_batch_of(uint32_t number, ShadeBatch& batch, Job&& job) {
    const PreparedItem& item = scene_.items[number];
    if (item.glyphs) shade_glyphs(item, views_[number], float(pixel_scale_), lights_, batch);
    else if (item.discs) shade_discs(item, views_[number], lights_, keys_.data(), batch);
    else shade(job(), batch);
    if (item.pictures) draw_pictures(item, views_[number], pixel_scale_, lights_, batch);
    if (item.lic) apply_texture(*textures_, item, number, projection_, batch);
  }

  /// Calls f(item, batch, first) for runs of at most shade_batch pixels of one item; `of(i)` tells what is seen, `depth_of(i)` how deep.
  template <class Of, class DepthOf, class F>
  void shade_runs(size_t n, const PixelBox& box, Of&& of, DepthOf&& depth_of, F&& f) {
    ShadeBatch batch;
    batch.tile_x = box.x0, batch.tile_y = box.y0;
    for (size_t i = 0; i < n;) {
      const size_t first = i;
      const uint32_t number = of(i).item;
      const PreparedItem& item = scene_.items[number];
      for (batch.n = 0; i < n && batch.n < shade_batch; ++i, ++batch.n) {
        const Seen s = of(i);
        if (s.item != number) break;
        batch.pixel[batch.n] = s.pixel, batch.triangle[batch.n] = s.primitive - item.first_primitive;
      }
      if (item.glyphs)
        for (size_t k = 0; k < batch.n; ++k) batch.depth[k] = depth_of(first + k);
      shade_batch_of(number, batch, [&] { return shade_job(item, views_[number], lights_); });
      f(item, batch, first);
    }
  }

  void store_opaque(const PreparedItem& item, const ShadeBatch& b, const PixelBox& box) {
    const size_t width = size_t(frame_.width), first = size_t(box.y0) * width + size_t(box.x0), n = b.n;
    float *rgba = frame_.rgba.data() + 4 * first, *depth = frame_.depth.data() + first;
    uint32_t *ids = frame_.ids.data() + first, id = item.id;
    for (size_t i = 0; i < n; ++i) {
      const size_t p = b.pixel[i] / tile_size * width + b.pixel[i] % tile_size;
      const float light = b.light[i], gloss = b.gloss[i];
      const float q[4] = {b.rgba[0][i] * light + gloss, b.rgba[1][i] * light + gloss, b.rgba[2][i] * light + gloss, 1.0f};
      std::memcpy(rgba + 4 * p, q, sizeof q);
      depth[p] = b.depth[i], ids[p] = id;
    }
  }

  /// Where one item alone is seen, the usual case: pixels go from the keys into the batch without a list between.
  void shade_single(uint32_t number, const PixelBox& box) {
    const PreparedItem& item = scene_.items[number];
    const ShadeJob job = item.glyphs ? ShadeJob{} : shade_job(item, views_[number], lights_);
    ShadeBatch batch;
    batch.tile_x = box.x0, batch.tile_y = box.y0;
    for (int y = box.y0; y <= box.y1; ++y) {
      const uint64_t* row = keys_.data() + size_t(y) * size_t(frame_.width);
      size_t n = batch.n;
      for (int x = box.x0; x <= box.x1; ++x) {
        const uint32_t primitive = uint32_t(row[x]);
        batch.pixel[n] = uint32_t((y - box.y0) * tile_size + (x - box.x0)), batch.triangle[n] = primitive - item.first_primitive;
        batch.depth[n] = key_depth(row[x]);
        n += primitive != no_primitive;
      }
      batch.n = n;
      if (n + tile_size < shade_batch && y < box.y1) continue;
      shade_batch_of(number, batch, [&]() -> const ShadeJob& { return job; });
      store_opaque(item, batch, box);
      batch.n = 0;
    }
  }

  void shade_opaque(const PixelBox& box) {
    if (only_ != no_item) return shade_single(only_, box);
    uint32_t lowest = no_primitive, highest = 0;
    for (int y = box.y0; y <= box.y1; ++y)
      for (int x = box.x0; x <= box.x1; ++x) {
        const uint32_t primitive = uint32_t(keys_.data()[size_t(y) * size_t(frame_.width) + size_t(x)]);
        lowest = std::min(lowest, primitive), highest = std::max(highest, primitive + 1);  // no_primitive + 1 is 0
      }
    if (highest == 0) return;
    const uint32_t first = scene_.item_of(lowest);
    if (first == scene_.item_of(highest - 1)) return shade_single(first, box);
    std::vector<Seen> seen;
    uint32_t item = 0, from = 1, to = 0;  // the range of primitives of the item that was seen last
    for (int y = box.y0; y <= box.y1; ++y)
      for (int x = box.x0; x <= box.x1; ++x) {
        const uint32_t primitive = uint32_t(keys_.data()[size_t(y) * size_t(frame_.width) + size_t(x)]);
        if (primitive == no_primitive) continue;
        if (primitive < from || primitive >= to) {
          item = scene_.item_of(primitive);
          from = scene_.items[item].first_primitive, to = from + scene_.items[item].primitives;
        }
        seen.push_back({item, uint32_t((y - box.y0) * tile_size + (x - box.x0)), primitive});
      }
    std::stable_sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.item < b.item; });
    shade_runs(
        seen.size(), box, [&](size_t i) { return seen[i]; },
        [&](size_t i) { return key_depth(keys_.data()[pixel_in_frame(box, seen[i].pixel, frame_.width)]); },
        [&](const PreparedItem& it, const ShadeBatch& b, size_t) { store_opaque(it, b, box); });
  }

  void cover_translucent(size_t tile, const PixelBox& box, std::vector<Cover>& covers) {
    translucent_bins_.each(tile, [&](uint32_t i) {
      const TriangleRecord& t = translucent_[i];
      PixelBox b = pixel_box(t, frame_.width, frame_.height);
      b = {std::max(b.x0, box.x0), std::max(b.y0, box.y0), std::min(b.x1, box.x1), std::min(b.y1, box.y1)};
      const WPlane plane = w_plane(t);
      const uint32_t item = scene_.item_of(t.primitive);
      for_each_span(t, b, [&](int y, int x0, int x1) {
        alignas(64) float depth[tile_size + 64];
        span_depths(plane, projection_.parallel, x0, y, x1 - x0 + 1, depth);
        for (int x = x0; x <= x1; ++x) {
          const float z = depth[x - x0];
          if (!(z < key_depth(keys_.data()[size_t(y) * size_t(frame_.width) + size_t(x)]))) continue;
          covers.push_back({uint32_t((y - box.y0) * tile_size + (x - box.x0)), z, z, t.primitive, item, 1, 0, 0, {0, 0, 0}});
        }
      });
    });
    std::stable_sort(covers.begin(), covers.end(), [](const Cover& a, const Cover& b) { return a.item < b.item; });
    shade_runs(
        covers.size(), box,
        [&](size_t i) {
          return Seen{covers[i].item, covers[i].pixel, covers[i].primitive};
        },
        [&](size_t i) { return covers[i].depth; },
        [&](const PreparedItem& it, const ShadeBatch& b, size_t first) {
          for (size_t i = 0; i < b.n; ++i) {
            Cover& c = covers[first + i];
            c.order = c.depth = b.depth[i], c.alpha = b.rgba[3][i] * it.opacity;
            for (size_t k = 0; k < 3; ++k) c.rgb[k] = b.rgba[k][i] * b.light[i] + b.gloss[i];
          }
        });
  }

  const PreparedScene& scene_;
  const Projection& projection_;
  const double pixel_scale_;
  Frame& frame_;
  Context& context_;
  const RenderTextures* textures_;
  bool large_drawn_ = false;
  const TileGrid grid_;
  const std::vector<Lamp> lights_;
  KeyPlane keys_;
  std::vector<EyeView> views_;
  uint32_t only_ = no_item;  ///< the one opaque surface, if there is just one
  std::vector<TriangleRecord> opaque_, translucent_;
  std::vector<MarkRecord> marks_;
  Bins opaque_bins_, translucent_bins_, mark_bins_;
  std::vector<std::vector<TilePixelFragment>> fragments_;
};

}  // namespace
}  // namespace raster

FragmentLists rasterize_prepared(const PreparedScene& scene, const Projection& projection, double pixel_scale, Frame& frame,
                                 Context& context, const RenderTextures* textures) {
  if (frame.width != projection.width || frame.height != projection.height)
    fail_usage(fmt::format("the frame is {}x{}, the projection {}x{}", frame.width, frame.height, projection.width, projection.height),
               "rasterize", "make both the same size");
  if (!(pixel_scale > 0)) fail_usage(fmt::format("pixel scale {} is not a valid size", pixel_scale), "rasterize", "it must be above 0");
  return raster::Drawing(scene, projection, pixel_scale, frame, context, textures).run();
}

std::shared_ptr<const RenderTextures> texture_scene(const PreparedScene& scene, const Projection& projection, Context& context) {
  if (!scene.textured()) return nullptr;
  Frame none;
  raster::Drawing drawing(scene, projection, 1, none, context, nullptr);
  drawing.draw_small();
  return std::make_shared<const RenderTextures>(drawing.texture());
}

FragmentLists rasterize(const Scene& scene, const Projection& projection, double pixel_scale, Frame& frame, Context& context) {
  return rasterize_prepared(*prepare_scene(scene, context), projection, pixel_scale, frame, context);
}

}  // namespace sg
