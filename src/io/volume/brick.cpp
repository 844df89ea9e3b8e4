// SPDX-License-Identifier: Apache-2.0
#include "io/volume/brick.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>

#include "base/bytes.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/lattice_crop.h"
#include "io/bytes/gzip_stream.h"
#include "io/bytes/inflate.h"
#include "io/text/text_scan.h"

namespace sg {

namespace {

std::span<const std::byte> stored(const BrickPart& p) {
  if (p.begin > p.file.size()) fail_data(fmt::format("ends before its data, which begins at byte {}", p.begin), p.file.path());
  std::span<const std::byte> s(p.file.data() + p.begin, p.file.size() - p.begin);
  if (p.packed > 0 && p.packed < s.size()) s = s.first(p.packed);
  return s;
}

// Where `need` raw bytes begin in the stored ones.
std::span<const std::byte> raw_window(const BrickPart& p, size_t need, Context& context) {
  const std::span<const std::byte> s = stored(p);
  size_t skip = 0;
  if (p.skip >= 0) {
    skip = size_t(p.skip);
  } else {
    if (need > s.size()) skip = 0;
    else if (const size_t after = size_t(-1 - p.skip); after <= s.size() - need) skip = s.size() - need - after;
    else
      context.warn(fmt::format("{}: byte skip {} needs {} bytes after the data, but there are {}; reading the last {} bytes", p.file.path(),
                               p.skip, after, s.size() - need, need)),
          skip = s.size() - need;
  }
  if (skip > s.size() || s.size() - skip < need)
    fail_data(fmt::format("too short: {} bytes are needed, but there are {}", need, s.size() - std::min(skip, s.size())), p.file.path());
  return s.subspan(skip, need);
}

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

void unpack_hex(std::string_view text, std::byte* out, size_t need, const std::string& where) {
  size_t n = 0;
  int high = -1;
  for (size_t i = 0; i < text.size() && n < need; ++i) {
    if (is_space(text[i])) continue;
    const int v = hex_value(text[i]);
    if (v < 0) fail_data(fmt::format("line {}: '{}' is not a hexadecimal digit", line_number(text, i), text[i]), where);
    if (high < 0) high = v;
    else out[n++] = std::byte(high * 16 + v), high = -1;
  }
  if (n < need) fail_data(fmt::format("has {} bytes as hexadecimal digits, but {} are needed", n, need), where);
}

// For text: what follows the skipped bytes.
std::string_view text_of(const BrickPart& p) {
  std::span<const std::byte> s = stored(p);
  if (p.skip < 0) fail_data("a negative byte skip is meaningless for text data", p.file.path());
  s = s.subspan(std::min(size_t(p.skip), s.size()));
  return {reinterpret_cast<const char*>(s.data()), s.size()};
}

size_t lines_before(const BrickPart& p) { return line_number(p.file.text(), p.begin) - 1; }

Codec codec_of(BrickEncoding e) { return e == BrickEncoding::zlib ? Codec::zlib : e == BrickEncoding::gzip ? Codec::gzip : Codec::bzip2; }

void fill(const BrickLayout& l, const BrickPart& p, std::byte* out, size_t need, Context& context) {
  switch (l.encoding) {
    case BrickEncoding::raw: {
      const auto from = raw_window(p, need, context);
      parallel_for(
          need, size_t(4) << 20, [&](size_t a, size_t b) { std::memcpy(out + a, from.data() + a, b - a); }, &context);
      return;
    }
    case BrickEncoding::hex: return unpack_hex(text_of(p), out, need, p.file.path());
    case BrickEncoding::text: {
      const size_t n = need / element_size(l.type);
      const Array a = parse_numbers(text_of(p), l.type, n, 1, p.file.path(), lines_before(p));
      std::memcpy(out, a.raw(), need);
      return;
    }
    default: {
      const auto from = stored(p);
      Window w;
      if (p.skip >= 0) w.skip = size_t(p.skip);
      else w.from_end = true, w.after = size_t(-1 - p.skip);
      unpack(codec_of(l.encoding), from, w, out, need, p.file.path());
    }
  }
}

}  // namespace

Array load_brick(const BrickLayout& l, const std::vector<BrickPart>& parts, Context& context) {
  if (parts.empty()) fail_data("there is no data file");
  const size_t size = element_size(l.type);
  uint64_t need = 0;
  if (!multiply(l.count, size_t(l.components) * size, need) || need > (uint64_t(1) << 60)) fail_data("the volume exceeds any memory");
  if (need % (parts.size() * size)) fail_data(fmt::format("{} bytes do not divide evenly among {} files", need, parts.size()));
  const size_t share = need / parts.size();

  // Everything that can be checked without memory is checked before allocating it.
  for (const BrickPart& p : parts) switch (l.encoding) {
      case BrickEncoding::raw: raw_window(p, share, context); break;
      case BrickEncoding::hex:
        if (text_of(p).size() / 2 < share)
          fail_data(fmt::format("{} bytes of hexadecimal text cannot hold {} bytes", text_of(p).size(), share), p.file.path());
        break;
      case BrickEncoding::text:
        if (text_of(p).size() / 2 + 1 < share / size)
          fail_data(fmt::format("{} bytes of text cannot hold {} numbers", text_of(p).size(), share / size), p.file.path());
        break;
      default: check_ratio(codec_of(l.encoding), stored(p).size(), share, p.file.path());
    }

  const bool swap = l.big_endian && size > 1 && l.encoding != BrickEncoding::text;
  if (parts.size() == 1 && l.encoding == BrickEncoding::raw && !swap) {
    const auto bytes = raw_window(parts[0], share, context);
    if (reinterpret_cast<uintptr_t>(bytes.data()) % size == 0)
      return Array({parts[0].file.owner(), bytes.data(), bytes.size()}, l.type, l.count, l.components);
  }
  if (parts.size() == 1 && l.encoding == BrickEncoding::text)
    return parse_numbers(text_of(parts[0]), l.type, l.count, l.components, parts[0].file.path(), lines_before(parts[0]));
  if (l.encoding == BrickEncoding::raw && need > (1 << 20))
    context.info(fmt::format("{}: {} copied ({})", parts[0].file.path(), human_bytes(need),
                             swap               ? "big-endian"
                             : parts.size() > 1 ? "several files"
                                                : "not aligned"));
  std::byte* out = nullptr;
  Array a = Array::make_raw(l.type, l.count, l.components, &out);
  if (parts.size() == 1) fill(l, parts[0], out, share, context);
  else
    parallel_for(
        parts.size(), 1, [&](size_t i, size_t) { fill(l, parts[i], out + i * share, share, context); }, &context);
  if (swap) swap_bytes(out, need / size, size);
  return a;
}

Array load_brick_part(const BrickLayout& l, const LatticePart& part, const std::vector<BrickPart>& files, Context& context) {
  if (part.whole()) return load_brick(l, files, context);
  const size_t size = element_size(l.type), tuple = size * size_t(l.components);
  uint64_t need = 0, row = 0;
  if (!multiply(l.count, tuple, need) || need > (uint64_t(1) << 60) || !multiply(part.dims[0], tuple, row))
    fail_data("the volume exceeds any memory");
  const size_t share = files.empty() ? 0 : need / files.size();
  const bool raw = l.encoding == BrickEncoding::raw && !files.empty() && need % files.size() == 0 && share % row == 0;
  const bool packed = (l.encoding == BrickEncoding::gzip || l.encoding == BrickEncoding::zlib) && files.size() == 1 && files[0].skip >= 0;
  if (!raw && !packed) return crop_block(load_brick(l, files, context), part.dims, part.lo, part.count, part.stride);

  std::vector<std::span<const std::byte>> windows;
  if (raw)
    for (const BrickPart& f : files) windows.push_back(raw_window(f, share, context));
  else check_ratio(codec_of(l.encoding), stored(files[0]).size(), need, files[0].file.path());
  std::byte* out = nullptr;
  Array a = Array::make_raw(l.type, part.points(), l.components, &out);
  if (packed) {
    GzipStream stream(stored(files[0]), files[0].file.path());
    stream.read(nullptr, size_t(files[0].skip));
    stream_part([&](std::byte* to, size_t n) { stream.read(to, n); }, tuple, part, out);
  } else {
    // Row by row: each lies in one file.
    const size_t out_row = part.count[0] * tuple;
    const LatticePart in_row{{part.dims[0], 1, 1}, {part.lo[0], 0, 0}, {part.count[0], 1, 1}, {part.stride[0], 1, 1}};
    parallel_for(part.count[1] * part.count[2], std::max<size_t>(1, (size_t(1) << 18) / std::max<size_t>(out_row, 1)),
                 [&](size_t begin, size_t end) {
                   size_t seen_file = SIZE_MAX;
                   const std::byte* seen = nullptr;
                   for (size_t r = begin; r < end; ++r) {
                     const size_t j = part.lo[1] + r % part.count[1] * part.stride[1], k = part.lo[2] + r / part.count[1] * part.stride[2];
                     const size_t at = (j + part.dims[1] * k) * row;
                     copy_part(windows[at / share].data() + at % share, tuple, in_row, out + r * out_row);
                     // The pages behind: the file may be larger than memory.
                     const size_t f = at / share;
                     if (f == seen_file) files[f].file.release(seen, windows[f].data() + at % share);
                     seen_file = f, seen = windows[f].data() + at % share;
                   }
                 });
  }
  if (l.big_endian && size > 1) swap_bytes(out, a.bytes() / size, size);
  return a;
}

size_t checked_product(const std::vector<size_t>& sizes, const std::string& where) {
  uint64_t n = 1;
  for (const size_t s : sizes)
    if (s == 0 || !multiply(n, s, n) || n > (uint64_t(1) << 60)) fail_data(s == 0 ? "a size is 0" : "the sizes are too large", where);
  return n;
}

std::vector<std::string> pattern_names(const std::string& pattern, int64_t first, int64_t last, int64_t step, const std::string& where) {
  const size_t percent = pattern.find('%');
  size_t d = percent == std::string::npos ? percent : percent + 1;
  size_t width = 0;
  bool zero = false;
  if (d < pattern.size() && pattern[d] == '0') zero = true, ++d;
  while (d < pattern.size() && is_digit(pattern[d]) && width < 100) width = width * 10 + size_t(pattern[d++] - '0');
  if (d >= pattern.size() || (pattern[d] != 'd' && pattern[d] != 'i' && pattern[d] != 'u') || width > 20 ||
      pattern.find('%', d) != std::string::npos)
    fail_data(fmt::format("'{}' is not a pattern of file names", pattern), where, "write e.g. slice%03d.raw 1 93 1");
  constexpr int64_t most = 1000000000;
  bool good = step != 0;
  for (const int64_t v : {first, last, step}) good = good && v >= -most && v <= most;
  if (good && first != last) good = (step > 0) == (last > first) && (last - first) / step < 1000000;
  if (!good) fail_data(fmt::format("files numbered {} to {} in steps of {}", first, last, step), where);
  std::vector<std::string> names;
  for (int64_t i = first; step > 0 ? i <= last : i >= last; i += step) {
    const std::string number = zero ? fmt::format("{:0{}}", i, width) : fmt::format("{:{}}", i, width);
    names.push_back(pattern.substr(0, percent) + number + pattern.substr(d + 1));
    if (first == last) break;
  }
  return names;
}

}  // namespace sg
