// SPDX-License-Identifier: Apache-2.0
// Oriented discs (surfels): each pixel shows the nearest disc that its ray meets, with the disc's own normal. Internal to raster/.
#pragma once
#include "render/raster/triangles/kernels.h"
#include "render/shade/shade.h"

namespace sg::raster {

struct DiscJob {
  EyeView view;
  const float *xyz, *normals, *radius;
  const uint32_t* points;  ///< of each disc; null: disc i is point i
  uint32_t first_primitive;
  uint64_t* keys;  ///< one per pixel of the picture
};

/// Draws discs begin..end into the visibility buffer with an atomic minimum. Discs smaller than a pixel take the one at their centre.
void draw_discs(const DiscJob& job, size_t begin, size_t end);
void draw_discs_one_by_one(const DiscJob& job, size_t begin, size_t end);  ///< the same in plain C++

/// Whether the discs at the end of the list are nearer to the viewer than those at its start, judged by a few of each: then drawing from
/// the end hides more of the others early.
bool last_is_nearer(const DiscJob& job, size_t count);

/// Like shade(), for the pixels of a disc item; `triangle` of the batch holds the disc. Depth comes from the keys.
void shade_discs(const PreparedItem& item, const EyeView& view, const std::vector<Lamp>& lights, const uint64_t* keys, ShadeBatch& b);

/// Light and gloss of the discs of a batch, as shade() makes them. Pads the batch.
struct DiscLight {
  const EyeView& view;
  const Material& material;
  std::span<const Lamp> lights;
  const uint32_t* points;  ///< null: disc i is point i
  const float* normals;
};
void light_discs(const DiscLight& job, ShadeBatch& batch);

}  // namespace sg::raster
