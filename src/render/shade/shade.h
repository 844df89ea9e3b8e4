// SPDX-License-Identifier: Apache-2.0
// From visible triangles to colours: where the ray of a pixel meets its triangle, with what normal, value and light. Internal to raster/.
#pragma once
#include <span>

#include "render/prepare/eye_view.h"
#include "render/prepare/prepared.h"
#include "render/shade/lamp.h"

namespace sg::raster {

constexpr int tile_size = 64;
constexpr size_t tile_pixels = size_t(tile_size) * tile_size;
constexpr size_t shade_batch = 1024;  ///< pixels shaded at once

struct ShadeJob {
  EyeView view;
  const float* xyz;
  const uint32_t* triangles;
  const float* normals;     ///< null: face normals
  const uint32_t* corners;  ///< normal numbers, three per triangle
  const ColorSource* color;
  const uint32_t* cells;  ///< null: first_cell + triangle
  uint32_t first_cell;
  Material material;
  std::span<const Lamp> lights;
};
ShadeJob shade_job(const PreparedItem& item, const EyeView& view, const std::vector<Lamp>& lights);

/// Pixels of one tile and item. `n` of `pixel` (y * 64 + x in the tile) and `triangle` are filled in; the kernel fills the rest.
struct ShadeBatch {
  size_t n = 0;
  int tile_x = 0, tile_y = 0;  ///< first pixel of the tile
  alignas(64) uint32_t pixel[shade_batch];
  alignas(64) uint32_t triangle[shade_batch];
  alignas(64) float depth[shade_batch];
  alignas(64) float rgba[4][shade_batch];  ///< surface colour, linear, straight alpha
  alignas(64) float light[shade_batch];    ///< ambient and diffuse, times the colour
  alignas(64) float gloss[shade_batch];    ///< specular, added
};
/// Colours, light and depth of all n pixels. Pads the inputs of the last vector, so `n` stays and places beyond are overwritten.
void shade(const ShadeJob& job, ShadeBatch& batch);
/// One pixel at a time, in plain C++ and double precision where it is free: what the vector code is compared with.
void shade_reference(const ShadeJob& job, ShadeBatch& batch);

}  // namespace sg::raster
