// SPDX-License-Identifier: Apache-2.0
// Image-space LIC on surfaces (Laramee, Jobard, Hauser 2003): the vectors of the pixels that a surface shows, lines through the pixels,
// and noise convolved along them. Internal to render/.
//
//   visibility buffer -> per pixel: direction on the picture, depth and its slope, noise of the place on the surface
//                     -> per pixel: which of its 8 neighbours continue the same sheet (depth within what the slopes allow)
//                     -> per pixel: noise along the line through it, over steps from pixel to pixel that are never across a border
#pragma once
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "base/huge_allocator.h"
#include "render/raster/lic/lic_kernel.h"
#include "render/raster/triangles/kernels.h"
#include "scene/items/surface_texture.h"

namespace sg {
class PreparedScene;
}

namespace sg::raster {

/// Planes with a border of one pixel: pixel (x, y) stands at (y + 1) * stride + x + 1.
struct LicPlanes {
  int width = 0, height = 0;
  size_t stride = 0;
  Plane<uint32_t> item;  ///< number of the prepared item + 1; 0: nothing to texture
  Plane<uint32_t> word;  ///< direction, 12 bits x and 12 bits y in 1/2047 (0, 0: none); 8 bits: neighbours that may be entered
  Plane<float> w;        ///< what is linear on the picture: 1/z in perspective, z in parallel
  Plane<float> wx, wy;   ///< its slope per pixel, limited to that of a surface 8 times as steep as one seen face on
  Plane<float> noise;    ///< mean 0, variance 1/12
  Plane<float> value;    ///< result: mean 0, variance 1 for noise independent of the lines; 0 where there is no direction

  size_t at(int x, int y) const { return size_t(y + 1) * stride + size_t(x + 1); }
};

/// One surface as the vector kernel sees it.
struct VectorJob {
  EyeView view;
  const float* xyz;
  const uint32_t* triangles;
  const float* vectors;  ///< 3 per point, or per cell
  bool per_cell;
  const uint32_t* cells;  ///< null: first_cell + triangle
  uint32_t first_cell;
  float least;  ///< shorter vectors have no direction
  float grain;  ///< pixels
  uint32_t seed;
};

constexpr float noise_turn[2] = {0.7927f, 0.6096f};  ///< cosine and sine of the angle of the noise's squares
constexpr float noise_square = 0.8f;                 ///< smallest side of a square, in grains; the next size is mixed in

constexpr size_t vector_batch = 512;
/// n pixels of one surface: x, y and triangle come in, the rest goes out.
struct VectorBatch {
  size_t n = 0;
  alignas(64) int32_t x[vector_batch];
  alignas(64) int32_t y[vector_batch];
  alignas(64) uint32_t triangle[vector_batch];
  alignas(64) uint32_t word[vector_batch];  ///< without neighbours
  alignas(64) float w[vector_batch], wx[vector_batch], wy[vector_batch], noise[vector_batch];
};
void pixel_vectors(const VectorJob& job, VectorBatch& batch);
/// The same in plain C++; agrees up to rounding, and up to noise at the borders of its grains.
void pixel_vectors_reference(const VectorJob& job, VectorBatch& batch);

/// Sets the neighbour bits of the rows [first, last).
void connect_pixels(LicPlanes& planes, const EyeView& view, int first, int last);
void connect_pixels_reference(LicPlanes& planes, const EyeView& view, int first, int last);

/// Bit of the neighbour (dx, dy), each -1 to 1 and not both 0.
constexpr int neighbor_bit(int dx, int dy) {
  const int k = dy * 3 + dx;
  return k + 4 - (k > 0);
}

struct ConvolveJob {
  const uint32_t* word;
  const float* noise;
  float* value;
  int stride;
  float step;  ///< pixels
  const LicWeights* weights;
};
/// value[p] of n pixels p (places in the planes). Line steps by Adams-Bashforth of second order, directions of the pixels passed.
void convolve(const ConvolveJob& job, const int32_t* pixels, size_t n);
/// One line after the other; the same bytes.
void convolve_reference(const ConvolveJob& job, const int32_t* pixels, size_t n);

/// The texture of everything that `keys` shows (only: of one item; -1: of all that have one). `pixel_scale`: as in rasterize().
LicPlanes surface_texture(const PreparedScene& scene, const std::vector<EyeView>& views, const uint64_t* keys, int only, double pixel_scale,
                          Context& context);

}  // namespace sg::raster
