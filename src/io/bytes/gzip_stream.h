// SPDX-License-Identifier: Apache-2.0
// gzip (or zlib) from front to back in little memory: for parts of large files. Whole files are faster with unpack() of io/bytes/inflate.h.
#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace sg {

class GzipStream {
 public:
  GzipStream(std::span<const std::byte> in, std::string where);
  ~GzipStream();
  GzipStream(const GzipStream&) = delete;
  GzipStream& operator=(const GzipStream&) = delete;

  /// The next `bytes` bytes, or passes over them when `to` is null. Throws Error(data) when the stream is damaged or ends before.
  void read(std::byte* to, size_t bytes);
  /// As many as there are, at most `bytes`; damage counts as the end.
  size_t read_some(std::byte* to, size_t bytes) noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The first unpacked bytes of a gzip head that may be cut off: for sniffing. Returns how many there are.
size_t gzip_peek(std::span<const std::byte> head, std::byte* to, size_t bytes);

}  // namespace sg
