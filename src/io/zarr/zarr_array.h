// SPDX-License-Identifier: Apache-2.0
// One array of a Zarr folder (version 2, and regular chunks of version 3): its description and its chunks.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/array.h"
#include "io/zarr/zarr_codec.h"

namespace sg::zarr {

/// Sizes are in the order of the file: the last axis lies densest.
struct ZarrArray {
  std::string folder;  ///< with trailing slash
  ElementType type = ElementType::u8;
  bool big_endian = false;
  std::vector<size_t> shape, chunk;
  std::vector<Codec> codecs;
  std::byte fill[8]{};             ///< one element, in this machine's byte order
  std::vector<std::string> names;  ///< of the axes, where the array itself gives them (version 3); else empty
  std::string before;              ///< of the names of chunks: "" or "c/"
  char separator = '.';

  size_t chunk_bytes() const;
  /// Chunks along axis a.
  size_t chunks(size_t a) const { return (shape[a] + chunk[a] - 1) / chunk[a]; }
  std::string chunk_path(std::span<const size_t> at) const;
  /// The numbers of one whole chunk (also beyond the shape), in this machine's byte order. False for a chunk that is not there: all of it
  /// is the fill value, `out` is not touched. `packed` is reused from chunk to chunk. Throws Error(data).
  bool read_chunk(std::span<const size_t> at, std::byte* out, std::vector<std::byte>& packed) const;
};

/// Reads .zarray or zarr.json; nothing when neither is there (or zarr.json describes a group). Throws Error(data) for sizes that cannot be,
/// types and codecs that are not read. A chunk has at most 1 GiB, a shape at most 2^56 elements.
std::optional<ZarrArray> open_array(const std::string& folder);

}  // namespace sg::zarr
