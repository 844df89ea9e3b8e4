// SPDX-License-Identifier: Apache-2.0
#include "io/bytes/inflate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include <bzlib.h>
#include <libdeflate.h>

#include "base/error.h"
#include "base/text/text.h"
#include "io/plausible.h"

namespace sg {

namespace {

constexpr size_t slack = size_t(64) << 20;

struct Decompressor {
  libdeflate_decompressor* d = libdeflate_alloc_decompressor();
  Decompressor() {
    if (!d) fail_data("not enough memory to decompress");
  }
  ~Decompressor() { libdeflate_free_decompressor(d); }
  Decompressor(const Decompressor&) = delete;
  Decompressor& operator=(const Decompressor&) = delete;
};

enum class Outcome { complete, full, damaged };

// Unpacks all members that lie one after the other; `got` bytes are valid unless damaged or full in the first member.
Outcome unpack_deflate(Codec codec, std::span<const std::byte> in, std::byte* out, size_t room, size_t& got) {
  Decompressor d;
  got = 0;
  size_t at = 0;
  while (at < in.size()) {
    size_t used = 0, made = 0;
    const auto r = codec == Codec::gzip
                       ? libdeflate_gzip_decompress_ex(d.d, in.data() + at, in.size() - at, out + got, room - got, &used, &made)
                       : libdeflate_zlib_decompress_ex(d.d, in.data() + at, in.size() - at, out + got, room - got, &used, &made);
    if (r == LIBDEFLATE_INSUFFICIENT_SPACE) return Outcome::full;
    if (r != LIBDEFLATE_SUCCESS) return at > 0 ? Outcome::complete : Outcome::damaged;  // rubbish after a member is padding
    got += made, at += used;
    if (codec == Codec::zlib || got == room) break;
  }
  return Outcome::complete;
}

struct Bunzip {
  bz_stream s{};
  bool open = false;
  void start() {
    stop();
    if (BZ2_bzDecompressInit(&s, 0, 0) != BZ_OK) fail_data("not enough memory to decompress");
    open = true;
  }
  void stop() {
    if (open) BZ2_bzDecompressEnd(&s);
    open = false;
  }
  ~Bunzip() { stop(); }
};

Outcome unpack_bzip2(std::span<const std::byte> in, std::byte* out, size_t room, size_t& got) {
  Bunzip b;
  b.start();
  got = 0;
  size_t at = 0;
  bool any = false;
  constexpr size_t step = size_t(1) << 30;
  for (;;) {
    const size_t give = std::min(step, in.size() - at), take = std::min(step, room - got);
    b.s.next_in = reinterpret_cast<char*>(const_cast<std::byte*>(in.data() + at));
    b.s.avail_in = unsigned(give);
    b.s.next_out = reinterpret_cast<char*>(out + got);
    b.s.avail_out = unsigned(take);
    const int r = BZ2_bzDecompress(&b.s);
    const size_t used = give - b.s.avail_in, made = take - b.s.avail_out;
    at += used, got += made;
    if (r == BZ_STREAM_END) {
      any = true;
      if (at == in.size()) return Outcome::complete;
      b.start();
      continue;
    }
    if (r != BZ_OK) return any ? Outcome::complete : Outcome::damaged;
    if (got == room) return Outcome::full;
    if (used == 0 && made == 0) return Outcome::damaged;  // input ends inside a block
  }
}

Outcome unpack_all(Codec codec, std::span<const std::byte> in, std::byte* out, size_t room, size_t& got) {
  return codec == Codec::bzip2 ? unpack_bzip2(in, out, room, got) : unpack_deflate(codec, in, out, room, got);
}

const char* name(Codec c) { return c == Codec::gzip ? "gzip" : c == Codec::zlib ? "zlib" : "bzip2"; }

}  // namespace

void check_ratio(Codec codec, size_t packed, size_t need, const std::string& where) {
  // deflate codes at most 258 bytes in 2 bits; a bzip2 block of some 40 bytes holds at most 900000 run-coded bytes (45.9 MB).
  const size_t ratio = codec == Codec::bzip2 ? size_t(1) << 21 : 1032;
  if (need / ratio > packed + 64)
    fail_data(fmt::format("{} bytes of {} data cannot hold the {} bytes announced by the header", packed, name(codec), need), where);
}

void unpack(Codec codec, std::span<const std::byte> in, Window window, std::byte* out, size_t need, const std::string& where) {
  auto damaged = [&] { fail_data(fmt::format("the {} data is damaged or truncated", name(codec)), where); };
  auto too_short = [&](size_t got) {
    fail_data(fmt::format("decompresses to {} bytes, but {} are needed", got, window.from_end ? need + window.after : window.skip + need),
              where);
  };
  size_t got = 0;
  if (window.skip == 0 && !window.from_end) {
    const Outcome r = unpack_all(codec, in, out, need, got);
    if (r == Outcome::damaged) damaged();
    if (r == Outcome::complete) {
      if (got < need) too_short(got);
      return;
    }
    if (codec == Codec::bzip2) return;  // full: the rest is not wanted, and what came is valid
  }
  // The stream is longer than the window: unpack it whole, in memory that grows up to the limit.
  size_t limit = 0;
  if (__builtin_add_overflow(need, slack, &limit) || __builtin_add_overflow(limit, window.skip, &limit)) too_short(0);
  size_t room = std::min(limit, std::max<size_t>(need + window.skip, 1 << 16) + (1 << 16));
  for (;; room = std::min(limit, room * 4)) {
    const auto memory = std::make_unique_for_overwrite<std::byte[]>(room);
    const Outcome r = unpack_all(codec, in, memory.get(), room, got);
    if (r == Outcome::damaged) damaged();
    if (r == Outcome::full && room < limit) continue;
    if (r == Outcome::full)
      fail_data(fmt::format("decompresses to more than {}, though the header announces {}", human_bytes(limit), human_bytes(need)), where);
    size_t begin = window.skip;
    if (window.from_end) {
      if (got < need) too_short(got);
      begin = got - need - std::min(got - need, window.after);
    }
    if (begin > got || got - begin < need) too_short(got);
    std::memcpy(out, memory.get() + begin, need);
    return;
  }
}

std::vector<std::byte> inflate_raw(std::span<const std::byte> in, const std::string& where) {
  Decompressor d;
  for (size_t room = 4 * in.size() + (1 << 16);; room *= 4) {
    check_plausible(room, in.size(), where);
    std::vector<std::byte> out(room);
    size_t used = 0, made = 0;
    const auto r = libdeflate_deflate_decompress_ex(d.d, in.data(), in.size(), out.data(), room, &used, &made);
    if (r == LIBDEFLATE_INSUFFICIENT_SPACE) continue;
    if (r != LIBDEFLATE_SUCCESS) fail_data("the deflated data is damaged or truncated", where);
    out.resize(made);
    return out;
  }
}

std::vector<std::byte> pack_gzip(std::span<const std::byte> in) {
  struct Compressor {
    libdeflate_compressor* c = libdeflate_alloc_compressor(6);
    ~Compressor() { libdeflate_free_compressor(c); }
  } c;
  if (!c.c) fail_data("not enough memory to compress");
  std::vector<std::byte> out(libdeflate_gzip_compress_bound(c.c, in.size()));
  const size_t n = libdeflate_gzip_compress(c.c, in.data(), in.size(), out.data(), out.size());
  if (n == 0) fail_internal("gzip compression failed");
  out.resize(n);
  return out;
}

}  // namespace sg
