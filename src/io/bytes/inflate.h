// SPDX-License-Identifier: Apache-2.0
// gzip, zlib and bzip2 with an output that is bounded by what the file's header promises.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace sg {

enum class Codec { gzip, zlib, bzip2 };

/// Where the wanted bytes lie in the unpacked stream: after `skip` bytes from the front, or so that `after` bytes follow them.
struct Window {
  size_t skip = 0;
  bool from_end = false;
  size_t after = 0;
};

/// Unpacks `in` and copies the `need` bytes of the window to `out`. gzip may have several members, bzip2 several streams;
/// bytes behind the window are ignored. Never unpacks more than skip + need + 64 MiB. Throws Error(data) naming `where` for
/// damaged, too short or absurdly long streams.
void unpack(Codec codec, std::span<const std::byte> in, Window window, std::byte* out, size_t need, const std::string& where);

/// Throws Error(data) when `packed` bytes can by no means unpack to `need` bytes: a check before memory is allocated.
void check_ratio(Codec codec, size_t packed, size_t need, const std::string& where);

/// All of a raw deflate stream (RFC 1951); bytes behind it are ignored. Throws Error(data) naming `where` where it is damaged or holds more
/// than check_plausible() lets pass.
std::vector<std::byte> inflate_raw(std::span<const std::byte> in, const std::string& where);

/// One gzip member.
std::vector<std::byte> pack_gzip(std::span<const std::byte> in);

}  // namespace sg
