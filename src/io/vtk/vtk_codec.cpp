// SPDX-License-Identifier: Apache-2.0
#include "io/vtk/vtk_codec.h"

#include <libdeflate.h>
#include <lz4.h>
#include <lzma.h>

#include <algorithm>
#include <atomic>
#include <cstring>

#include "base/error.h"
#include "base/parallel.h"

namespace sg::vtk {

std::string_view codec_name(Codec codec) {
  constexpr std::string_view names[] = {"", "vtkZLibDataCompressor", "vtkLZ4DataCompressor", "vtkLZMADataCompressor"};
  return names[size_t(codec)];
}

namespace {

// On a smooth field of 64 MB level 1 gives 59 % in 0.57 s, level 5 57 % in 1.6 s (zlib at level 5, as VTK writes: 61 % in 3.3 s).
constexpr int zlib_level = 1;
constexpr uint32_t lzma_level = 5;

// One per thread: making them costs more than a small block.
libdeflate_decompressor* inflater() {
  struct Own {
    libdeflate_decompressor* d = libdeflate_alloc_decompressor();
    ~Own() { libdeflate_free_decompressor(d); }
  };
  thread_local Own own;
  if (!own.d) fail_data("not enough memory to decompress");
  return own.d;
}

libdeflate_compressor* deflater() {
  struct Own {
    libdeflate_compressor* c = libdeflate_alloc_compressor(zlib_level);
    ~Own() { libdeflate_free_compressor(c); }
  };
  thread_local Own own;
  if (!own.c) fail_data("not enough memory to compress");
  return own.c;
}

}  // namespace

bool decompress_block(Codec codec, const std::byte* src, size_t n, std::byte* dst, size_t bytes) {
  switch (codec) {
    case Codec::none: break;
    case Codec::zlib: {
      size_t got = 0;
      return libdeflate_zlib_decompress(inflater(), src, n, dst, bytes, &got) == LIBDEFLATE_SUCCESS && got == bytes;
    }
    case Codec::lz4: {
      if (n > size_t(INT32_MAX) || bytes > size_t(INT32_MAX)) return false;
      const int got = LZ4_decompress_safe(reinterpret_cast<const char*>(src), reinterpret_cast<char*>(dst), int(n), int(bytes));
      return got >= 0 && size_t(got) == bytes;
    }
    case Codec::lzma: {
      uint64_t memory = uint64_t(128) << 20;  // the strongest preset needs 65 MiB; a damaged header requires more
      size_t in = 0, out = 0;
      return lzma_stream_buffer_decode(&memory, 0, nullptr, reinterpret_cast<const uint8_t*>(src), &in, n, reinterpret_cast<uint8_t*>(dst),
                                       &out, bytes) == LZMA_OK &&
             out == bytes;
    }
  }
  if (n != bytes) return false;
  std::memcpy(dst, src, n);
  return true;
}

std::vector<std::byte> compress_block(Codec codec, const std::byte* src, size_t n) {
  std::vector<std::byte> out;
  switch (codec) {
    case Codec::none: out.assign(src, src + n); break;
    case Codec::zlib: {
      out.resize(libdeflate_zlib_compress_bound(deflater(), n));
      out.resize(libdeflate_zlib_compress(deflater(), src, n, out.data(), out.size()));
      break;
    }
    case Codec::lz4: {
      out.resize(size_t(LZ4_compressBound(int(n))));
      const int got =
          LZ4_compress_default(reinterpret_cast<const char*>(src), reinterpret_cast<char*>(out.data()), int(n), int(out.size()));
      out.resize(size_t(std::max(got, 0)));
      break;
    }
    case Codec::lzma: {
      out.resize(lzma_stream_buffer_bound(n));
      size_t got = 0;
      if (lzma_easy_buffer_encode(lzma_level, LZMA_CHECK_CRC32, nullptr, reinterpret_cast<const uint8_t*>(src), n,
                                  reinterpret_cast<uint8_t*>(out.data()), &got, out.size()) != LZMA_OK)
        got = 0;
      out.resize(got);
      break;
    }
  }
  if (out.empty() && n > 0) fail_internal("a block could not be compressed");
  return out;
}

uint64_t most_uncompressed(Codec codec, uint64_t n) {
  // Deflate cannot do better than 1032:1 and LZ4 than 255:1; xz reaches about 7000:1 on zeros.
  const uint64_t ratio = codec == Codec::zlib ? 1033 : codec == Codec::lz4 ? 256 : codec == Codec::lzma ? 16384 : 1;
  uint64_t r = 0;
  return __builtin_mul_overflow(n + 1, ratio, &r) ? UINT64_MAX : r;
}

namespace {

struct Base64Table {
  uint8_t value[256];
  constexpr Base64Table() : value{} {
    for (auto& v : value) v = 0xff;
    for (int i = 0; i < 26; ++i) value['A' + i] = uint8_t(i), value['a' + i] = uint8_t(26 + i);
    for (int i = 0; i < 10; ++i) value['0' + i] = uint8_t(52 + i);
    value[int('+')] = 62, value[int('/')] = 63;
  }
};
constexpr Base64Table base64;

// Whole groups without padding; false at the first invalid character.
bool decode_groups(const char* p, size_t groups, std::byte* out) {
  uint8_t bad = 0;
  for (size_t g = 0; g < groups; ++g, p += 4, out += 3) {
    const uint8_t a = base64.value[uint8_t(p[0])], b = base64.value[uint8_t(p[1])], c = base64.value[uint8_t(p[2])],
                  d = base64.value[uint8_t(p[3])];
    bad |= uint8_t(a | b | c | d);
    out[0] = std::byte(a << 2 | b >> 4);
    out[1] = std::byte(uint8_t(b << 4 | c >> 2));
    out[2] = std::byte(uint8_t(c << 6 | d));
  }
  return bad < 64;
}

// One group, perhaps padded: bytes in it, 0 when it is not base64.
size_t decode_group(const char* p, std::byte out[3]) {
  char q[4] = {p[0], p[1], p[2], p[3]};
  size_t n = 3;
  if (q[3] == '=') q[3] = 'A', n = 2;
  if (n == 2 && q[2] == '=') q[2] = 'A', n = 1;
  return decode_groups(q, 1, out) ? n : 0;
}

}  // namespace

size_t decode_base64(std::string_view text, std::byte* out, size_t n) {
  // The common case: one stream. All but its last group is free of padding.
  if (const size_t whole = n / 3; n > 3 && text.size() >= whole * 4) {
    std::atomic<bool> good{true};
    parallel_for(whole, 1 << 15, [&](size_t begin, size_t end) {
      if (!decode_groups(text.data() + 4 * begin, end - begin, out + 3 * begin)) good = false;
    });
    if (good) {
      if (n % 3 == 0) return whole * 4;
      std::byte last[3];
      if (text.size() < whole * 4 + 4 || decode_group(text.data() + whole * 4, last) < n % 3) return SIZE_MAX;
      std::memcpy(out + whole * 3, last, n % 3);
      return whole * 4 + 4;
    }
  }
  size_t have = 0, p = 0;
  while (have < n) {
    std::byte b[3];
    if (text.size() - p < 4) return SIZE_MAX;
    const size_t k = decode_group(text.data() + p, b);
    if (k == 0) return SIZE_MAX;
    std::memcpy(out + have, b, std::min(k, n - have));
    have += std::min(k, n - have);
    p += 4;
  }
  return p;
}

void encode_base64(const std::byte* src, size_t n, char* out) {
  static constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  auto group = [&](uint32_t v, char* o) {
    o[0] = letters[v >> 18], o[1] = letters[v >> 12 & 63], o[2] = letters[v >> 6 & 63], o[3] = letters[v & 63];
  };
  auto at = [&](size_t i) { return uint32_t(src[i]); };
  parallel_for(n / 3, 1 << 16, [&](size_t begin, size_t end) {
    for (size_t g = begin; g < end; ++g) group(at(3 * g) << 16 | at(3 * g + 1) << 8 | at(3 * g + 2), out + 4 * g);
  });
  if (const size_t rest = n % 3) {
    char* o = out + n / 3 * 4;
    group(at(n - rest) << 16 | (rest == 2 ? at(n - 1) << 8 : 0), o);
    o[3] = '=';
    if (rest == 1) o[2] = '=';
  }
}

}  // namespace sg::vtk
