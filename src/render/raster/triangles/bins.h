// SPDX-License-Identifier: Apache-2.0
// Which primitives touch which tile, in order of the primitives. Internal to raster/.
#pragma once
#include <cstdint>
#include <vector>

#include "base/parallel.h"
#include "render/raster/triangles/kernels.h"
#include "render/shade/shade.h"

namespace sg::raster {

struct TileGrid {
  int width, height, across, down;
  TileGrid(int w, int h) : width(w), height(h), across((w + tile_size - 1) / tile_size), down((h + tile_size - 1) / tile_size) {}
  size_t count() const { return size_t(across) * size_t(down); }
  PixelBox box(size_t tile) const {
    const int x = int(tile % size_t(across)) * tile_size, y = int(tile / size_t(across)) * tile_size;
    return {x, y, std::min(x + tile_size, width) - 1, std::min(y + tile_size, height) - 1};
  }
};

struct Bins {
  std::vector<size_t> start;    ///< tiles + 1; empty when nothing was binned
  std::vector<uint32_t> items;  ///< ascending within a tile
  /// Calls f(i) for the things that touch the tile.
  template <class F>
  void each(size_t tile, F&& f) const {
    if (start.empty()) return;
    for (size_t k = start[tile]; k < start[tile + 1]; ++k) f(items[k]);
  }
  bool any(size_t tile) const { return !start.empty() && start[tile] < start[tile + 1]; }
};

/// box_of(i): the pixels that thing i may touch. Counts per block of things, then one prefix sum, tile by tile: the same lists for
/// any number of threads.
template <class BoxOf>
Bins bin(size_t n, const TileGrid& grid, BoxOf&& box_of) {
  Bins b;
  if (n == 0) return b;
  constexpr size_t block = 8192;
  const size_t blocks = (n + block - 1) / block, tiles = grid.count();
  std::vector<size_t> place(blocks * tiles);
  auto each_tile = [&](size_t i, auto&& f) {
    const PixelBox p = box_of(i);
    if (p.empty()) return;
    for (int y = p.y0 / tile_size; y <= p.y1 / tile_size; ++y)
      for (int x = p.x0 / tile_size; x <= p.x1 / tile_size; ++x) f(size_t(y) * size_t(grid.across) + size_t(x));
  };
  parallel_for(n, block, [&](size_t begin, size_t end) {
    size_t* count = &place[begin / block * tiles];
    for (size_t i = begin; i < end; ++i) each_tile(i, [&](size_t t) { ++count[t]; });
  });
  b.start.resize(tiles + 1);
  size_t sum = 0;
  for (size_t t = 0; t < tiles; ++t) {
    b.start[t] = sum;
    for (size_t k = 0; k < blocks; ++k) {
      const size_t c = place[k * tiles + t];
      place[k * tiles + t] = sum;
      sum += c;
    }
  }
  b.start[tiles] = sum;
  b.items.resize(sum);
  parallel_for(n, block, [&](size_t begin, size_t end) {
    size_t* next = &place[begin / block * tiles];
    for (size_t i = begin; i < end; ++i) each_tile(i, [&](size_t t) { b.items[next[t]++] = uint32_t(i); });
  });
  return b;
}

}  // namespace sg::raster
