// SPDX-License-Identifier: Apache-2.0
// Frame: the grid of pixels (or voxels) on which a texture of a flow is made, the flow on it and the fields carried to it.
#pragma once
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/huge_allocator.h"
#include "data/cells/mesh_dimension.h"
#include "data/dataset.h"

namespace sg::texture {

struct Frame {
  UniformGrid grid;             ///< one axis has one point when flat
  int dimension = 2;            ///< 2 or 3
  int axis[3] = {0, 1, 2};      ///< the grid's axis of each axis of the texture
  int32_t n[3] = {1, 1, 1};     ///< pixels along them
  double pitch[3] = {1, 1, 1};  ///< world length from pixel to pixel
  double pixels_per_cell = 1;   ///< how much finer than the input the grid is, at least 1
  std::string velocity_name;
  FieldSet fields;     ///< of the input, on the points of the grid
  Array hidden_cells;  ///< u8 GhostBits of the grid's cells where the input had none; may be empty
  std::optional<double> time;
  std::vector<std::pair<std::string, std::string>> notes;

  size_t size() const { return size_t(n[0]) * size_t(n[1]) * size_t(n[2]); }
  /// Position in pixels of a place in the world (its foot on the plane, when flat), and back.
  Vec3 to_pixels(Vec3 world) const;
};

/// Whether it can carry a texture: an extent along at least two axes, and cells. Operations leave other parts of collections unchanged.
bool has_room(const Dataset& data);
/// f for each dataset; parts of collections that have no room, or fewer dimensions than the others (the skins of a solid), stay as they
/// are, with a note.
template <class F>
Data over_parts(const Data& data, std::string_view who, Context& context, F&& f) {
  const bool alone = std::holds_alternative<DatasetPtr>(data);
  int dimension = 0;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    if (has_room(*d)) dimension = std::max(dimension, mesh_dimension(*d));
  });
  return map_datasets(data, [&](const DatasetPtr& d) -> DatasetPtr {
    if (alone || (has_room(*d) && mesh_dimension(*d) == dimension)) return f(d);
    context.info(std::string(who) + ": a part without area (like points or lines), or of fewer dimensions than others, is left unchanged");
    return d;
  });
}

/// Velocities of the pixels [begin, end): `dimension` numbers each, along the frame's axes, in pixels per unit of time; NaN: no value.
void velocity_of(const Frame& frame, size_t begin, size_t end, float* out);
/// Of all pixels.
Plane<float> velocity_of(const Frame& frame, const Context& context);

/// `field`: of velocities; empty: the active vectors. `resolution`: pixels along the longest side; 0: the grid's own, or whole multiples up
/// to 1024 where it is coarser and flat (128 in 3D). Uniform grids of square pixels of that number are taken as they are; everything else
/// is resampled (with a note in the log). Vectors are projected on the plane of flat data. Throws Error(usage) naming `who`, for fields
/// that are not vectors, for curved surfaces and points, and for sizes beyond 2^31 pixels.
Frame make_frame(const DatasetPtr& input, const std::string& field, int64_t resolution, std::string_view who, Context& context);

/// The dataset of the frame with one more point field (or several).
DatasetPtr frame_dataset(const Frame& frame, std::vector<Field> more);

/// A point field of `from` on the frame's pixels, f32 and packed: as it is when there are as many points, else resampled, the image's box
/// stretched over the frame's. Throws Error(usage) when `from` is not a uniform grid of the frame's dimension.
Array field_on_frame(const Frame& frame, const DatasetPtr& from, const Field& field, std::string_view who);

}  // namespace sg::texture
