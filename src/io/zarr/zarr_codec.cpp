// SPDX-License-Identifier: Apache-2.0
#include "io/zarr/zarr_codec.h"

#include <blosc.h>
#include <fmt/core.h>
#include <libdeflate.h>
#include <lz4.h>
#include <zstd.h>

#include <memory>

#include "base/bytes.h"
#include "base/error.h"
#include "io/bytes/inflate.h"

namespace sg::zarr {

namespace {

struct Named {
  std::string_view name;
  Codec codec;
};
constexpr Named names[] = {{"zlib", Codec::zlib},          {"gzip", Codec::gzip},           {"bz2", Codec::bzip2},
                           {"zstd", Codec::zstd},          {"blosc", Codec::blosc},         {"lz4", Codec::lz4},
                           {"crc32c", Codec::crc32c},      {"numcodecs.zlib", Codec::zlib}, {"numcodecs.lz4", Codec::lz4},
                           {"numcodecs.bz2", Codec::bzip2}};

[[noreturn]] void fail(const char* codec, size_t bytes, const std::string& where) {
  fail_data(fmt::format("the {} stream is damaged or does not hold the {} bytes of a chunk", codec, bytes), where);
}

void decode_blosc(std::span<const std::byte> in, std::byte* out, size_t bytes, const std::string& where) {
  size_t holds = 0;
  if (in.size() < BLOSC_MIN_HEADER_LENGTH || blosc_cbuffer_validate(in.data(), in.size(), &holds) != 0 || holds != bytes)
    fail("Blosc", bytes, where);
  if (blosc_decompress_ctx(in.data(), out, bytes, 1) != int(bytes)) fail("Blosc", bytes, where);
}

void decode_lz4(std::span<const std::byte> in, std::byte* out, size_t bytes, const std::string& where) {
  if (in.size() < 4 || load<uint32_t>(in.data()) != bytes || in.size() > size_t(LZ4_MAX_INPUT_SIZE)) fail("LZ4", bytes, where);
  const int n =
      LZ4_decompress_safe(reinterpret_cast<const char*>(in.data()) + 4, reinterpret_cast<char*>(out), int(in.size() - 4), int(bytes));
  if (n < 0 || size_t(n) != bytes) fail("LZ4", bytes, where);
}

void decode_last(Codec codec, std::span<const std::byte> in, std::byte* out, size_t bytes, const std::string& where) {
  switch (codec) {
    case Codec::zlib: return unpack(sg::Codec::zlib, in, {}, out, bytes, where);
    case Codec::gzip: return unpack(sg::Codec::gzip, in, {}, out, bytes, where);
    case Codec::bzip2: return unpack(sg::Codec::bzip2, in, {}, out, bytes, where);
    case Codec::zstd:
      if (ZSTD_decompress(out, bytes, in.data(), in.size()) != bytes) fail("Zstandard", bytes, where);
      return;
    case Codec::blosc: return decode_blosc(in, out, bytes, where);
    case Codec::lz4: return decode_lz4(in, out, bytes, where);
    case Codec::crc32c: break;
  }
  fail_internal("a checksum is not a compressor", where);
}

}  // namespace

bool parse_codec(std::string_view name, Codec& codec) {
  for (const Named& n : names)
    if (n.name == name) {
      codec = n.codec;
      return true;
    }
  return false;
}

void decode(std::span<const Codec> codecs, std::span<const std::byte> in, std::byte* out, size_t bytes, const std::string& where) {
  // Checksums follow what they protect; damage shows in the stream itself.
  while (!codecs.empty() && codecs.back() == Codec::crc32c) {
    if (in.size() < 4) fail_data("is shorter than its checksum", where);
    in = in.first(in.size() - 4), codecs = codecs.first(codecs.size() - 1);
  }
  if (codecs.empty()) {
    if (in.size() != bytes) fail_data(fmt::format("has {} bytes, but a chunk has {}", in.size(), bytes), where);
    std::memcpy(out, in.data(), bytes);
    return;
  }
  if (codecs.size() > 1) fail_data(fmt::format("is compressed {} times", codecs.size()), where, "only one compressor is supported");
  decode_last(codecs[0], in, out, bytes, where);
}

std::string Packing::json() const {
  if (compression == "none") return "null";
  if (compression == "zlib") return R"({"id": "zlib", "level": 5})";
  return fmt::format(R"({{"id": "blosc", "cname": "{}", "clevel": {}, "shuffle": 1, "blocksize": 0}})", compression,
                     compression == "zstd" ? 3 : 5);
}

void check_packing(const Packing& packing, const std::string& where) {
  for (const char* known : {"none", "zlib", "lz4", "zstd"})
    if (packing.compression == known) return;
  fail_usage(fmt::format("unknown compression '{}'", packing.compression), where, "a Zarr folder takes lz4, zstd, zlib or none");
}

void encode(const Packing& packing, std::span<const std::byte> in, size_t element, std::vector<std::byte>& out) {
  if (packing.compression == "none") {
    out.assign(in.begin(), in.end());
  } else if (packing.compression == "zlib") {
    const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> c(libdeflate_alloc_compressor(5),
                                                                                          libdeflate_free_compressor);
    if (!c) fail_data("not enough memory to compress");
    out.resize(libdeflate_zlib_compress_bound(c.get(), in.size()));
    out.resize(libdeflate_zlib_compress(c.get(), in.data(), in.size(), out.data(), out.size()));
  } else {
    out.resize(in.size() + BLOSC_MAX_OVERHEAD);
    const int n = blosc_compress_ctx(packing.compression == "zstd" ? 3 : 5, BLOSC_SHUFFLE, element, in.size(), in.data(), out.data(),
                                     out.size(), packing.compression.c_str(), 0, 1);
    if (n <= 0) fail_internal("Blosc could not compress a chunk");
    out.resize(size_t(n));
  }
}

}  // namespace sg::zarr
