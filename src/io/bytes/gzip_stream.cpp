// SPDX-License-Identifier: Apache-2.0
#include "io/bytes/gzip_stream.h"

#include <fmt/core.h>

#include <algorithm>

#include <zlib.h>

#include "base/error.h"

namespace sg {

struct GzipStream::State {
  std::span<const std::byte> in;
  std::string where;
  z_stream z{};
  size_t at = 0, made = 0;
  bool open = false, zlib = false, damaged = false, ended = false;

  ~State() {
    if (open) inflateEnd(&z);
  }
  // Unpacks up to `bytes` bytes; fewer when the stream ends or is damaged.
  size_t some(std::byte* to, size_t bytes) noexcept {
    size_t got = 0;
    constexpr size_t step = size_t(1) << 30;
    while (got < bytes && !ended) {
      if (!open) {
        // Members may follow one another; anything else behind the last one is padding.
        if (at >= in.size() || (made > 0 && (zlib || in[at] != std::byte(0x1f))) || inflateInit2(&z, 15 + 32) != Z_OK) {
          ended = true;
          break;
        }
        open = true;
        zlib = in[at] != std::byte(0x1f);  // a zlib stream has one member
      }
      const size_t give = std::min(step, in.size() - at), take = std::min(step, bytes - got);
      z.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(in.data() + at));
      z.avail_in = uInt(give);
      z.next_out = reinterpret_cast<Bytef*>(to + got);
      z.avail_out = uInt(take);
      const int r = inflate(&z, Z_NO_FLUSH);
      const size_t used = give - z.avail_in, out = take - z.avail_out;
      at += used, got += out, made += out;
      if (r == Z_STREAM_END) {
        inflateEnd(&z);
        open = false;
      } else if (r != Z_OK || (used == 0 && out == 0)) {
        damaged = ended = true;
      }
    }
    return got;
  }
};

GzipStream::GzipStream(std::span<const std::byte> in, std::string where) : state_(std::make_unique<State>()) {
  state_->in = in;
  state_->where = std::move(where);
}
GzipStream::~GzipStream() = default;

void GzipStream::read(std::byte* to, size_t bytes) {
  std::unique_ptr<std::byte[]> rubbish;
  constexpr size_t block = size_t(1) << 18;
  if (!to) rubbish = std::make_unique_for_overwrite<std::byte[]>(std::min(block, bytes));
  for (size_t got = 0; got < bytes;) {
    const size_t want = to ? bytes - got : std::min(block, bytes - got);
    const size_t n = state_->some(to ? to + got : rubbish.get(), want);
    got += n;
    if (n < want) {
      if (state_->damaged) fail_data(fmt::format("the compressed data is damaged or truncated near byte {}", state_->at), state_->where);
      fail_data(fmt::format("decompresses to {} bytes; {} more are needed", state_->made, bytes - got), state_->where);
    }
  }
}

size_t GzipStream::read_some(std::byte* to, size_t bytes) noexcept { return state_->some(to, bytes); }

size_t gzip_peek(std::span<const std::byte> head, std::byte* to, size_t bytes) {
  if (head.size() < 18 || head[0] != std::byte(0x1f) || head[1] != std::byte(0x8b)) return 0;
  return GzipStream(head, "").read_some(to, bytes);
}

}  // namespace sg
