// SPDX-License-Identifier: Apache-2.0
// TIFF through libtiff: one page is a grid of one layer, pages of one size are a volume; y upwards. 8 to 64 bits, whole or float, as
// stored; bits, palettes and packed colours become RGB.
#include <fmt/core.h>
#include <tiffio.h>

#include "base/bytes.h"
#include "base/error.h"
#include "base/file/file.h"
#include "base/parallel.h"
#include "io/isolated/isolated.h"
#include "io/plausible.h"
#include "io/plugin.h"
#include "io/volume/lattice_part.h"

namespace sg {

namespace {

struct Page {
  uint32_t width = 0, height = 0;
  uint16_t bits = 8, samples = 1, format = SAMPLEFORMAT_UINT, planar = PLANARCONFIG_CONTIG, photometric = PHOTOMETRIC_MINISBLACK;
  uint16_t packing = COMPRESSION_NONE;
  bool as_rgb = false;  ///< no plain numbers
  ElementType type = ElementType::u8;

  int components() const { return as_rgb ? 3 : samples; }
  size_t row() const { return size_t(width) * size_t(components()) * element_size(type); }
  bool like(const Page& o) const { return width == o.width && height == o.height && type == o.type && components() == o.components(); }
};

struct Tiff {
  std::string path, problem;
  TIFF* t = nullptr;

  Tiff(const std::string& p, size_t file_size) : path(p) {
    TIFFOpenOptions* o = TIFFOpenOptionsAlloc();
    TIFFOpenOptionsSetMaxSingleMemAlloc(o, tmsize_t(std::min<uint64_t>(plausible_memory(file_size), uint64_t(1) << 31)));
    TIFFOpenOptionsSetErrorHandlerExtR(o, note, this);
    TIFFOpenOptionsSetWarningHandlerExtR(
        o, [](TIFF*, void*, const char*, const char*, va_list) { return 1; }, nullptr);
    t = TIFFOpenExt(path.c_str(), "rm", o);
    TIFFOpenOptionsFree(o);
    if (!t) fail("cannot open it");
  }
  ~Tiff() {
    if (t) TIFFClose(t);
  }
  Tiff(const Tiff&) = delete;
  Tiff& operator=(const Tiff&) = delete;

  static int note(TIFF*, void* self, const char*, const char* format, va_list args) {
    char text[256];
    std::vsnprintf(text, sizeof text, format, args);
    static_cast<Tiff*>(self)->problem = text;
    return 1;
  }
  [[noreturn]] void fail(const std::string& what) const {
    fail_data(fmt::format("damaged TIFF: {}{}", what, problem.empty() ? "" : " (" + problem + ")"), path);
  }
};

Page read_head(const Tiff& f) {
  Page p;
  TIFFGetField(f.t, TIFFTAG_IMAGEWIDTH, &p.width);
  TIFFGetField(f.t, TIFFTAG_IMAGELENGTH, &p.height);
  TIFFGetFieldDefaulted(f.t, TIFFTAG_BITSPERSAMPLE, &p.bits);
  TIFFGetFieldDefaulted(f.t, TIFFTAG_SAMPLESPERPIXEL, &p.samples);
  TIFFGetFieldDefaulted(f.t, TIFFTAG_SAMPLEFORMAT, &p.format);
  TIFFGetFieldDefaulted(f.t, TIFFTAG_PLANARCONFIG, &p.planar);
  TIFFGetField(f.t, TIFFTAG_PHOTOMETRIC, &p.photometric);
  TIFFGetFieldDefaulted(f.t, TIFFTAG_COMPRESSION, &p.packing);
  if (p.width == 0 || p.height == 0) f.fail(fmt::format("a page has {} x {} pixels", p.width, p.height));
  const bool is_float = p.format == SAMPLEFORMAT_IEEEFP, is_signed = p.format == SAMPLEFORMAT_INT;
  p.as_rgb = p.photometric == PHOTOMETRIC_PALETTE || p.photometric == PHOTOMETRIC_YCBCR || p.bits < 8;
  using enum ElementType;
  if (p.as_rgb) p.type = u8;
  else if (is_float && p.bits == 32) p.type = f32;
  else if (is_float && p.bits == 64) p.type = f64;
  else if (!is_float && p.bits == 8) p.type = is_signed ? i8 : u8;
  else if (!is_float && p.bits == 16) p.type = is_signed ? i16 : u16;
  else if (!is_float && p.bits == 32) p.type = is_signed ? i32 : u32;
  else if (!is_float && p.bits == 64) p.type = is_signed ? i64 : u64;
  else fail_data(fmt::format("{} numbers of {} bits are not supported", is_float ? "floating-point" : "whole", p.bits), f.path);
  if (p.samples < 1 || p.samples > 1024) f.fail(fmt::format("{} samples per pixel", p.samples));
  return p;
}

// Pages like the first, by number; previews and others are left out.
std::vector<tdir_t> pages_like(Tiff& f, Page& first, size_t file_size, Context& context) {
  std::vector<tdir_t> pages;
  size_t others = 0, n = 0;
  do {
    uint32_t kind = 0;
    TIFFGetField(f.t, TIFFTAG_SUBFILETYPE, &kind);
    const Page p = read_head(f);
    if (pages.empty()) first = p;
    if (kind & FILETYPE_REDUCEDIMAGE || !p.like(first)) ++others;
    else pages.push_back(tdir_t(n));
    if (++n > file_size / 16) f.fail("has more pages than fit in it");
  } while (TIFFReadDirectory(f.t));
  if (pages.empty()) f.fail("has no page with a picture");
  if (others) context.warn(fmt::format("{}: {} pages of a different size or type are left out", f.path, others));
  return pages;
}

// One page, rows upwards.
void read_page(Tiff& f, tdir_t number, const Page& first, size_t file_size, std::byte* out) {
  if (!TIFFSetDirectory(f.t, number)) f.fail(fmt::format("page {} cannot be found", number + 1));
  const Page p = read_head(f);
  if (!p.like(first)) f.fail(fmt::format("page {} has changed", number + 1));
  const size_t row = p.row(), size = element_size(p.type);
  auto fail = [&] { f.fail(fmt::format("page {} cannot be decompressed", number + 1)); };
  if (p.as_rgb) {
    check_plausible(uint64_t(p.width) * p.height, 4, file_size, f.path);
    std::vector<uint32_t> raster(size_t(p.width) * p.height);
    if (!TIFFReadRGBAImageOriented(f.t, p.width, p.height, raster.data(), ORIENTATION_BOTLEFT, 1)) fail();
    for (size_t i = 0; i < raster.size(); ++i)
      out[3 * i] = std::byte(TIFFGetR(raster[i])), out[3 * i + 1] = std::byte(TIFFGetG(raster[i])),
              out[3 * i + 2] = std::byte(TIFFGetB(raster[i]));
    return;
  }
  uint16_t orientation = ORIENTATION_TOPLEFT;
  TIFFGetFieldDefaulted(f.t, TIFFTAG_ORIENTATION, &orientation);
  const bool up = orientation == ORIENTATION_BOTLEFT || orientation == ORIENTATION_BOTRIGHT;
  auto place = [&](size_t y) { return out + (up ? y : p.height - 1 - y) * row; };
  const bool separate = p.planar == PLANARCONFIG_SEPARATE && p.samples > 1;
  const int planes = separate ? p.samples : 1;
  const size_t pixel = size * size_t(separate ? 1 : p.samples), whole = size * size_t(p.samples);
  auto put = [&](const std::byte* from, size_t x, size_t y, size_t n, int plane) {
    std::byte* to = place(y) + x * whole + size_t(plane) * size;
    if (!separate) std::memcpy(to, from, n * pixel);
    else
      for (size_t i = 0; i < n; ++i) std::memcpy(to + i * whole, from + i * pixel, pixel);
  };
  if (TIFFIsTiled(f.t)) {
    uint32_t w = 0, h = 0;
    TIFFGetField(f.t, TIFFTAG_TILEWIDTH, &w);
    TIFFGetField(f.t, TIFFTAG_TILELENGTH, &h);
    const tmsize_t bytes = TIFFTileSize(f.t);
    if (w == 0 || h == 0 || bytes <= 0 || size_t(bytes) < size_t(w) * h * pixel || bytes > (tmsize_t(1) << 31)) fail();
    check_plausible(uint64_t(bytes), file_size, f.path);
    std::vector<std::byte> tile(static_cast<size_t>(bytes));
    for (int s = 0; s < planes; ++s)
      for (uint32_t y = 0; y < p.height; y += std::min(h, p.height - y))
        for (uint32_t x = 0; x < p.width; x += std::min(w, p.width - x)) {
          if (TIFFReadTile(f.t, tile.data(), x, y, 0, uint16_t(s)) < 0) fail();
          for (uint32_t r = 0; r < std::min(h, p.height - y); ++r)
            put(tile.data() + size_t(r) * w * pixel, x, y + r, std::min(w, p.width - x), s);
        }
    return;
  }
  const tmsize_t bytes = TIFFScanlineSize(f.t);
  if (bytes <= 0 || size_t(bytes) < p.width * pixel || bytes > (tmsize_t(1) << 31)) fail();
  check_plausible(uint64_t(bytes), file_size, f.path);
  std::vector<std::byte> line(static_cast<size_t>(bytes));
  for (int s = 0; s < planes; ++s)
    for (uint32_t y = 0; y < p.height; ++y) {
      if (TIFFReadScanline(f.t, line.data(), y, uint16_t(s)) < 0) fail();
      put(line.data(), 0, y, p.width, s);
    }
}

Data read_here(const std::string& path, size_t file_size, const ReadOptions& options, Context& context) {
  Tiff f(path, file_size);
  Page first;
  const std::vector<tdir_t> pages = pages_like(f, first, file_size, context);
  uint64_t bytes = 0;
  const size_t ratio = first.packing == COMPRESSION_NONE ? first.as_rgb ? 24 : 1 : 5000;
  if (!multiply(first.row(), first.height, bytes) || bytes / ratio > file_size || bytes > uint64_t(1) << 40)
    f.fail(fmt::format("{} x {} pixels do not fit into {} bytes", first.width, first.height, file_size));
  // Pages have their own bytes each.
  if (uint64_t all = 0; !multiply(bytes, pages.size(), all) || all / ratio > file_size)
    f.fail(fmt::format("{} pages of {} x {} pixels do not fit into {} bytes", pages.size(), first.width, first.height, file_size));
  UniformGrid grid;
  grid.dims = {first.width, first.height, pages.size()};
  const LatticePart part = cut_grid(grid, options.region);
  DatasetParts out;
  out.mesh = grid;
  if (options.header_only) return make_dataset(std::move(out));
  check_plausible(part.points(), element_size(first.type) * size_t(first.components()), file_size, path);
  std::byte* to = nullptr;
  Array a = Array::make_raw(first.type, part.points(), first.components(), &to);
  const LatticePart layer{
      {part.dims[0], part.dims[1], 1}, {part.lo[0], part.lo[1], 0}, {part.count[0], part.count[1], 1}, {part.stride[0], part.stride[1], 1}};
  const size_t tuple = element_size(first.type) * size_t(first.components());
  if (!layer.whole()) check_plausible(bytes, file_size, path);
  std::vector<std::byte> whole(layer.whole() ? 0 : size_t(bytes));
  for (size_t k = 0; k < part.count[2]; ++k) {
    context.check();
    const tdir_t page = pages[part.lo[2] + k * part.stride[2]];
    std::byte* place = to + k * layer.points() * tuple;
    read_page(f, page, first, file_size, layer.whole() ? place : whole.data());
    if (!layer.whole()) copy_part(whole.data(), tuple, layer, place);
  }
  const Role role = first.components() >= 3 && first.type == ElementType::u8 ? Role::colors : Role::scalars;
  out.fields.add({"Tiff Scalars", Association::point, std::move(a), "", role});
  return make_dataset(std::move(out));
}

// What the library does with damaged files, it does in a process of its own.
Data read_tiff(const std::string& path, const ReadOptions& options, Context& context) {
  const size_t file_size = MappedFile(path).size();
  return read_isolated(
      path, [&](Context& c) { return read_here(path, file_size, options, c); }, context);
}

}  // namespace

}  // namespace sg

SG_PLUGIN_FORMATS({"tiff", sg::read_tiff, nullptr, nullptr})
