// SPDX-License-Identifier: Apache-2.0
// SLC, the volumes of VolVis: a header in text that ends with 'X', a small picture, then the slices of bytes, each packed separately by run
// lengths (a byte with the top bit set and n below: n bytes follow; without: the next byte n times; 0 ends).
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/file/file.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/text/text_scan.h"
#include "io/volume/lattice_part.h"

namespace sg {

namespace {

struct Words {
  const MappedFile& file;
  size_t at = 0;

  double number(const char* what) {
    const char *base = file.text().data(), *end = base + file.size(), *p = base + at;
    while (p < end && is_space(*p)) ++p;
    double v = 0;
    const char* before = p;
    if (!scan_number(p, end, v) || !std::isfinite(v))
      fail_data(fmt::format("byte {}: expected {} in the header", size_t(before - base), what), file.path());
    at = size_t(p - base);
    return v;
  }
  size_t whole(const char* what, double most) {
    const double v = number(what);
    if (v < 0 || v > most || v != std::floor(v)) fail_data(fmt::format("byte {}: {} is {}", at, what, v), file.path());
    return size_t(v);
  }
  // The X that ends a text part, and the blank before it.
  void mark(const char* what) {
    while (at < file.size() && is_space(file.text()[at])) ++at;
    if (at >= file.size() || file.text()[at] != 'X') fail_data(fmt::format("byte {}: expected an 'X' to end {}", at, what), file.path());
    ++at;
  }
};

// Returns how many bytes are missing at the end, at most `forgiven`; they become 0.
size_t unpack_slice(std::span<const std::byte> in, std::byte* out, size_t need, size_t forgiven, size_t at, const std::string& where) {
  size_t i = 0, n = 0;
  auto fail = [&] { fail_data(fmt::format("byte {}: the run lengths of this slice make {} of {} bytes", at + i, n, need), where); };
  while (i < in.size()) {
    const auto c = uint8_t(in[i++]);
    const size_t run = c & 127;
    if (run == 0) break;
    if (run > need - n) fail();
    if (c & 128) {
      const size_t there = std::min(run, in.size() - i);
      std::memcpy(out + n, in.data() + i, there);
      i += there;
      if (there < run) {  // cut off
        n += there;
        break;
      }
    } else {
      if (i >= in.size()) fail();
      std::memset(out + n, int(in[i++]), run);
    }
    n += run;
  }
  if (need - n > forgiven) fail();
  std::memset(out + n, 0, need - n);
  return need - n;
}

// Writers have left the last samples out; other readers do not even look.
void tell_of_short_slices(const std::vector<size_t>& missing, const LatticePart& part, const std::string& path, Context& context) {
  const auto first = std::find_if(missing.begin(), missing.end(), [](size_t n) { return n > 0; });
  if (first == missing.end()) return;
  const auto count = std::count_if(first, missing.end(), [](size_t n) { return n > 0; });
  const size_t k = part.lo[2] + size_t(first - missing.begin()) * part.stride[2];
  context.log(LogLevel::warning, fmt::format("{}: slice {} is {} byte{} short{}; read as 0", path, k, *first, *first == 1 ? "" : "s",
                                             count > 1 ? fmt::format(", and so are {} more", count - 1) : ""));
}

}  // namespace

bool sniff_slc(std::span<const std::byte> head) {
  const std::string_view text(reinterpret_cast<const char*>(head.data()), std::min<size_t>(head.size(), 400));
  if (!text.starts_with("11111") || text.size() < 16 || !is_space(text[5])) return false;
  const size_t x = text.find('X');
  if (x == std::string_view::npos) return false;
  const auto w = words(text.substr(0, x));
  if (w.size() != 14) return false;
  for (std::string_view s : w)
    if (!parse_double(s)) return false;
  return true;
}

Data read_slc(const std::string& path, const ReadOptions& options, Context& context) {
  const MappedFile file(path);
  Words w{file};
  if (w.number("11111") != 11111) fail_data("byte 0: an SLC file begins with 11111", path);
  UniformGrid grid;
  for (size_t a = 0; a < 3; ++a) {
    grid.dims[a] = w.whole("a size", 1e6);
    if (grid.dims[a] == 0) fail_data("a size of 0", path);
  }
  if (const size_t bits = w.whole("the bits per voxel", 64); bits != 8) fail_data(fmt::format("{} bits per voxel", bits), path, "8");
  for (int a = 0; a < 3; ++a)
    if ((grid.spacing[a] = w.number("a spacing")) <= 0) fail_data(fmt::format("byte {}: the spacing is {}", w.at, grid.spacing[a]), path);
  w.whole("the unit", 100);
  w.whole("the origin of the data", 100);
  w.whole("the change of the data", 100);
  const size_t packing = w.whole("the compression", 100);
  if (packing > 1) fail_data(fmt::format("byte {}: compression {} is unknown", w.at, packing), path, "supported: 0 none, 1 run-length");
  const size_t width = w.whole("the icon's width", 1e5), height = w.whole("the icon's height", 1e5);
  w.mark("the header");
  if (3 * width * height > file.size() - w.at) fail_data("the file ends inside its icon", path);
  w.at += 3 * width * height;

  // Where each slice lies, before memory is allocated.
  const size_t row = grid.dims[0], slice = row * grid.dims[1];
  std::vector<std::span<const std::byte>> slices;
  const std::span<const std::byte> bytes(file.data(), file.size());
  for (size_t k = 0; k < grid.dims[2]; ++k) {
    size_t n = slice;
    if (packing) {
      n = w.whole("the packed size of a slice", 1e12);
      w.mark("the packed size of a slice");
      if (slice / 64 > n + 1) fail_data(fmt::format("byte {}: {} bytes cannot decompress to {}", w.at, n, slice), path);
    }
    const size_t left = file.size() - w.at;
    if (packing && k + 1 == grid.dims[2] && n > left && n - left <= row) n = left;  // what that lacks is told below
    if (n > left)
      fail_data(fmt::format("too short: slice {} needs {} bytes from byte {} on, but there are {}", k, n, w.at, file.size() - w.at), path);
    slices.push_back(bytes.subspan(w.at, n));
    w.at += n;
  }

  DatasetParts out;
  const LatticePart part = cut_grid(grid, options.region);
  out.mesh = grid;
  if (options.header_only) return make_dataset(std::move(out));
  std::byte* to = nullptr;
  Array a = Array::make_raw(ElementType::u8, part.points(), 1, &to);
  const LatticePart in_slice{
      {part.dims[0], part.dims[1], 1}, {part.lo[0], part.lo[1], 0}, {part.count[0], part.count[1], 1}, {part.stride[0], part.stride[1], 1}};
  std::vector<size_t> missing(part.count[2]);  // bytes, of each slice that is read
  parallel_for(part.count[2], 1, [&](size_t begin, size_t) {
    const auto& in = slices[part.lo[2] + begin * part.stride[2]];
    std::byte* place = to + begin * part.count[0] * part.count[1];
    const auto unpack = [&](std::byte* out) { return unpack_slice(in, out, slice, row, size_t(in.data() - file.data()), path); };
    if (packing && in_slice.whole()) {
      missing[begin] = unpack(place);
      return;
    }
    std::vector<std::byte> whole;
    if (packing) {
      whole.resize(slice);
      missing[begin] = unpack(whole.data());
    }
    copy_part(packing ? whole.data() : in.data(), 1, in_slice, place);
  });
  tell_of_short_slices(missing, part, path, context);
  out.fields.add({"SLCImage", Association::point, std::move(a), "", Role::scalars});
  return make_dataset(std::move(out));
}

}  // namespace sg
