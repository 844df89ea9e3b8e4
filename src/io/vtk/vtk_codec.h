// SPDX-License-Identifier: Apache-2.0
// Base64 and the block compressors of VTK XML files.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sg::vtk {

enum class Codec { none, zlib, lz4, lzma };
/// "vtkZLibDataCompressor", ...; "" for none.
std::string_view codec_name(Codec codec);

/// One block into `dst`; false unless it gives exactly `bytes` bytes.
bool decompress_block(Codec codec, const std::byte* src, size_t n, std::byte* dst, size_t bytes);
std::vector<std::byte> compress_block(Codec codec, const std::byte* src, size_t n);
/// The most bytes that n compressed bytes can hold: a header that promises more is wrong.
uint64_t most_uncompressed(Codec codec, uint64_t n);

/// Characters of n bytes in base64, padding included.
constexpr size_t base64_size(size_t n) { return (n + 2) / 3 * 4; }
/// The first n bytes of the text, which may be several padded streams one after the other; no white space.
/// Returns the characters used (whole groups of four), or SIZE_MAX when the text is too short or no base64.
size_t decode_base64(std::string_view text, std::byte* out, size_t n);
void encode_base64(const std::byte* src, size_t n, char* out);

}  // namespace sg::vtk
