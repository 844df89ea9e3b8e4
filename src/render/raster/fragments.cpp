// SPDX-License-Identifier: Apache-2.0
#include "render/raster/fragments.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"

namespace sg::raster {

std::vector<TilePixelFragment> resolve(const PreparedScene& scene, const PixelBox& box, std::vector<Cover>& covers, Frame& frame) {
  std::sort(covers.begin(), covers.end(), [](const Cover& a, const Cover& b) {
    if (a.pixel != b.pixel) return a.pixel < b.pixel;
    if (a.order != b.order) return a.order < b.order;
    return a.primitive < b.primitive;
  });
  std::vector<TilePixelFragment> out;
  uint32_t done = 0xFFFFFFFFu;
  for (const Cover& c : covers) {
    if (c.pixel == done || !(c.alpha > 0)) continue;
    const uint32_t id = scene.items[c.item].id;
    if (c.alpha >= 1) {
      const size_t p = pixel_in_frame(box, c.pixel, frame.width);
      for (size_t k = 0; k < 3; ++k) frame.rgba[4 * p + k] = c.rgb[k];
      frame.rgba[4 * p + 3] = 1, frame.depth[p] = c.depth, frame.ids[p] = id;
      done = c.pixel;
    } else {
      out.push_back({c.pixel, {c.order, {c.rgb[0] * c.alpha, c.rgb[1] * c.alpha, c.rgb[2] * c.alpha, c.alpha}, id}});
    }
  }
  return out;
}

FragmentLists collect(const std::vector<std::vector<TilePixelFragment>>& tiles, const TileGrid& grid, const Frame& frame) {
  FragmentLists lists;
  size_t total = 0;
  for (const auto& t : tiles) total += t.size();
  if (total == 0) return lists;
  if (total >= UINT32_MAX)
    fail_usage(fmt::format("{} translucent fragments are more than a picture holds", total), "render",
               "make the picture smaller or the surfaces opaque");
  lists.start.assign(frame.pixels() + 1, 0);
  lists.fragments.resize(total);
  auto place = [&](size_t t, const TilePixelFragment& f) { return pixel_in_frame(grid.box(t), f.pixel, frame.width); };
  parallel_for(grid.count(), 8, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t)
      for (const TilePixelFragment& f : tiles[t]) ++lists.start[place(t, f) + 1];
  });
  for (size_t p = 0; p < frame.pixels(); ++p) lists.start[p + 1] += lists.start[p];
  parallel_for(grid.count(), 8, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t) {
      size_t nth = 0;
      for (size_t i = 0; i < tiles[t].size(); ++i) {
        nth = i && tiles[t][i].pixel == tiles[t][i - 1].pixel ? nth + 1 : 0;
        lists.fragments[lists.start[place(t, tiles[t][i])] + nth] = tiles[t][i].fragment;
      }
    }
  });
  return lists;
}

}  // namespace sg::raster
