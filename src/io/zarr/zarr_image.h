// SPDX-License-Identifier: Apache-2.0
// An OME-Zarr image (NGFF 0.4 on Zarr 2, 0.5 on Zarr 3), or a lone Zarr array: what its axes and levels are, and boxes of its numbers.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "base/vec.h"
#include "data/bricked.h"
#include "data/mesh.h"
#include "io/volume/lattice_part.h"
#include "io/zarr/zarr_array.h"

namespace sg::zarr {

struct Image {
  struct Level {
    ZarrArray array;
    Vec3 spacing{1, 1, 1}, origin{0, 0, 0};
  };
  std::string path;
  std::string name;
  std::vector<Level> levels;   ///< finest first
  int axis[3] = {-1, -1, -1};  ///< places of x, y and z in the shape; -1 = a single layer
  int time_axis = -1, channel_axis = -1;
  double time_step = 1, first_time = 0;
  std::string length_unit;            ///< "mm", ...; as in the file, when it is not one of ours
  std::vector<std::string> channels;  ///< a name each
  // Additional data in our own files.
  std::string unit;
  Mat3 direction;
  bool vector = false;  ///< the channels are the components of one field
  bool labels = false;
  std::string minmax;  ///< folder of the extremes array, or ""

  std::array<size_t, 3> dims(size_t level) const;
  size_t steps() const { return time_axis < 0 ? 1 : levels[0].array.shape[size_t(time_axis)]; }
  UniformGrid grid(size_t level) const;
};

/// Throws Error(data).
Image open_image(const std::string& path);

/// A lattice in one array: the axes that are not x, y or z stay at `fixed`.
struct Box {
  const ZarrArray& array;
  std::array<int, 3> axis;
  std::vector<size_t> fixed;
};
Box box_of(const Image& image, size_t level, size_t step, size_t channel);

/// Gets the numbers of one chunk (null: all are the fill value).
using Chunks = std::function<std::shared_ptr<const Array>(const ZarrArray& array, const std::vector<size_t>& at)>;

/// The samples of the part, x fastest, `tuple` elements apart. With `parallel`, on all threads. Chunks without a wanted sample are not
/// touched.
void read_part(const Box& box, const LatticePart& part, std::byte* out, size_t tuple, const Chunks& chunks, const Context* context,
               bool parallel);
/// Reads and unpacks, keeps nothing.
Chunks fresh_chunks();
/// Whether any chunk of the lattice is there; touches at most the folders.
bool any_chunk(const Box& box);

/// The volume of one step and channel, with a cache of `cache` bytes of unpacked chunks.
BrickedPtr bricked(std::shared_ptr<const Image> image, size_t step, size_t channel, size_t cache);

}  // namespace sg::zarr
