// SPDX-License-Identifier: Apache-2.0
// The compressors of Zarr chunks.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sg::zarr {

enum class Codec { zlib, gzip, bzip2, zstd, blosc, lz4, crc32c };
/// Names of numcodecs (Zarr v2) and of Zarr v3; false for one that is not known.
bool parse_codec(std::string_view name, Codec& codec);

/// One after the other, the last one of writing first. Exactly `bytes` bytes must come out; throws Error(data) naming `where` when they do
/// not. Asks for no more memory than `bytes` between two codecs.
void decode(std::span<const Codec> codecs, std::span<const std::byte> in, std::byte* out, size_t bytes, const std::string& where);

/// How chunks are written. `compression` is lz4 (the default: Blosc with LZ4 and shuffled bytes), zstd (Blosc with Zstandard and shuffled
/// bytes), zlib or none.
struct Packing {
  std::string compression = "lz4";
  /// The .zarray value of "compressor".
  std::string json() const;
};
/// Throws Error(usage) for a compression that is not known.
void check_packing(const Packing& packing, const std::string& where);
/// `out` is reused from chunk to chunk.
void encode(const Packing& packing, std::span<const std::byte> in, size_t element, std::vector<std::byte>& out);

}  // namespace sg::zarr
