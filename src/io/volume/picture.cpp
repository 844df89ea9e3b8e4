// SPDX-License-Identifier: Apache-2.0
// PNG and JPEG pictures as grids of one layer, y upwards: point (0,0) is the lower left pixel. Folders of pictures of one size, in the
// order of their names (numbers count), become volumes.
#include <fmt/core.h>
#include <png.h>
#include <turbojpeg.h>

#include <algorithm>
#include <csetjmp>

#include "base/bytes.h"
#include "base/file/file.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/lattice.h"
#include "io/formats.h"
#include "io/volume/lattice_part.h"

namespace sg {

namespace {

// Everything that must outlive a longjmp of libpng.
struct Png {
  std::span<const std::byte> bytes;
  size_t at = 0;
  std::string problem;
  png_structp png = nullptr;
  png_infop info = nullptr;
  size_t width = 0, height = 0, channels = 0, depth = 8;
  std::vector<png_bytep> rows;

  ~Png() { png_destroy_read_struct(&png, &info, nullptr); }
  static void read(png_structp png, png_bytep to, png_size_t n) {
    Png& s = *static_cast<Png*>(png_get_io_ptr(png));
    if (n > s.bytes.size() - s.at) png_error(png, "the file is cut off");
    std::memcpy(to, s.bytes.data() + s.at, n);
    s.at += n;
  }
  static void fail(png_structp png, png_const_charp what) {
    static_cast<Png*>(png_get_error_ptr(png))->problem = what;
    png_longjmp(png, 1);
  }
  bool head() {
    if (setjmp(png_jmpbuf(png))) return false;
    png_set_read_fn(png, this, read);
    png_set_user_limits(png, 1 << 20, 1 << 20);
    png_set_chunk_malloc_max(png, 64u << 20);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, reinterpret_cast<png_const_bytep>("tEXt\0zTXt\0iTXt"), 3);
    png_read_info(png, info);
    png_set_expand(png);
    if (png_get_bit_depth(png, info) == 16) png_set_swap(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    width = png_get_image_width(png, info), height = png_get_image_height(png, info);
    channels = png_get_channels(png, info), depth = png_get_bit_depth(png, info);
    return true;
  }
  bool pixels() {
    if (setjmp(png_jmpbuf(png))) return false;
    png_read_image(png, rows.data());
    png_read_end(png, nullptr);
    return true;
  }
};

DatasetPtr picture(size_t width, size_t height, const char* name, Array values, const LatticeRegion& region) {
  DatasetParts out;
  UniformGrid grid;
  grid.dims = {width, height, 1};
  const LatticePart part = cut_grid(grid, region);
  out.mesh = grid;
  if (!values.empty()) {
    if (!part.whole()) {
      std::byte* to = nullptr;
      const Array cut = Array::make_raw(values.type(), part.points(), values.components(), &to);
      copy_part(values.raw(), element_size(values.type()) * size_t(values.components()), part, to);
      values = cut;
    }
    const Role role = values.components() >= 3 ? Role::colors : Role::scalars;
    out.fields.add({name, Association::point, std::move(values), "", role});
  }
  return make_dataset(std::move(out));
}

bool is_picture(const std::string& name) {
  const std::string e = extension_of(name);
  return e == "png" || e == "jpg" || e == "jpeg" || e == "tif" || e == "tiff";
}

std::vector<std::string> pictures_in(const std::string& folder) {
  // Those with the most frequent extension: a preview among the slices does no harm.
  std::vector<std::string> names;
  std::vector<std::pair<std::string, size_t>> counts;
  for (const std::string& name : folder_entries(folder)) {
    if (!is_picture(name)) continue;
    names.push_back(name);
    const auto at = std::find_if(counts.begin(), counts.end(), [&](const auto& c) { return c.first == extension_of(name); });
    if (at == counts.end()) counts.emplace_back(extension_of(name), 1);
    else ++at->second;
  }
  if (counts.empty()) return {};
  const std::string most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; })->first;
  std::erase_if(names, [&](const std::string& n) { return extension_of(n) != most; });
  return names;
}

}  // namespace

bool sniff_png(std::span<const std::byte> head) { return head.size() >= 33 && std::memcmp(head.data(), "\x89PNG\r\n\x1a\n", 8) == 0; }
bool sniff_jpeg(std::span<const std::byte> head) {
  return head.size() >= 4 && std::memcmp(head.data(), "\xff\xd8\xff", 3) == 0 && uint8_t(head[3]) >= 0xc0;
}
bool sniff_tiff(std::span<const std::byte> head) {
  if (head.size() < 8) return false;
  for (const char* magic : {"II*\0", "II+\0", "MM\0*", "MM\0+"})
    if (std::memcmp(head.data(), magic, 4) == 0) return true;
  return false;
}

Data read_png_grid(const std::string& path, const ReadOptions& options, Context&) {
  const MappedFile file(path);
  Png p;
  p.bytes = {file.data(), file.size()};
  p.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &p, Png::fail, [](png_structp, png_const_charp) {});
  p.info = p.png ? png_create_info_struct(p.png) : nullptr;
  if (!p.info) fail_data("cannot start libpng", path);
  if (!p.head()) fail_data("damaged PNG: " + p.problem, path);
  // Deflate packs at most 1032 to 1: a larger picture cannot be in this file.
  const size_t row = p.width * p.channels * (p.depth / 8);
  uint64_t size = 0;
  if (!multiply(row, p.height, size) || size / 1040 > file.size())
    fail_data(fmt::format("damaged PNG: {} x {} pixels do not fit into {} bytes", p.width, p.height, file.size()), path);
  if (options.header_only) return picture(p.width, p.height, "PNGImage", {}, options.region);
  std::byte* to = nullptr;
  Array a = Array::make_raw(p.depth == 16 ? ElementType::u16 : ElementType::u8, p.width * p.height, int(p.channels), &to);
  for (size_t y = 0; y < p.height; ++y) p.rows.push_back(reinterpret_cast<png_bytep>(to + (p.height - 1 - y) * row));
  if (!p.pixels()) fail_data("damaged PNG: " + p.problem, path);
  return picture(p.width, p.height, "PNGImage", std::move(a), options.region);
}

Data read_jpeg_grid(const std::string& path, const ReadOptions& options, Context&) {
  const MappedFile file(path);
  const std::unique_ptr<void, int (*)(tjhandle)> tj(tjInitDecompress(), tjDestroy);
  if (!tj) fail_data("cannot start libjpeg", path);
  const auto* bytes = reinterpret_cast<const unsigned char*>(file.data());
  int width = 0, height = 0, sampling = 0, space = 0;
  if (tjDecompressHeader3(tj.get(), bytes, file.size(), &width, &height, &sampling, &space) != 0 || width < 1 || height < 1)
    fail_data(fmt::format("damaged JPEG: {}", tjGetErrorStr2(tj.get())), path);
  const bool grey = space == TJCS_GRAY;
  const size_t numbers = size_t(width) * size_t(height) * (grey ? 1 : 3);
  if (numbers / 4000 > file.size())
    fail_data(fmt::format("damaged JPEG: {} x {} pixels do not fit into {} bytes", width, height, file.size()), path);
  if (options.header_only) return picture(size_t(width), size_t(height), "JPEGImage", {}, options.region);
  uint8_t* to = nullptr;
  Array a = Array::make<uint8_t>(size_t(width) * size_t(height), grey ? 1 : 3, &to);
  if (tjDecompress2(tj.get(), bytes, file.size(), to, width, 0, height, grey ? TJPF_GRAY : TJPF_RGB,
                    TJFLAG_BOTTOMUP | TJFLAG_ACCURATEDCT) != 0)
    fail_data(fmt::format("damaged JPEG: {}", tjGetErrorStr2(tj.get())), path);
  return picture(size_t(width), size_t(height), "JPEGImage", std::move(a), options.region);
}

bool sniff_picture_folder(const std::string& path) { return pictures_in(path).size() >= 2; }

Data read_picture_stack(const std::string& path, const ReadOptions& options, Context& context) {
  const std::vector<std::string> names = pictures_in(path);
  if (names.size() < 2) fail_data("contains fewer than two pictures of one kind", path);
  auto read = [&](size_t i, bool header_only) {
    ReadOptions o;
    o.header_only = header_only;
    return single_dataset(read_data(path + "/" + names[i], o, context), "reading a stack of pictures");
  };
  const DatasetPtr first = read(0, false);
  const auto size = lattice_dims(first->mesh());
  if (size[2] != 1) fail_data(fmt::format("'{}' has {} layers, but each picture of a stack must have one", names[0], size[2]), path);
  if (first->fields().empty()) fail_data(fmt::format("'{}' contains no numbers", names[0]), path);
  const Field& like = first->fields()[0];
  UniformGrid grid = *first->as<UniformGrid>();
  grid.dims[2] = names.size();
  const LatticePart part = cut_grid(grid, options.region);
  DatasetParts out;
  out.mesh = grid;
  if (options.header_only) return make_dataset(std::move(out));
  const size_t tuple = element_size(like.array.type()) * size_t(like.components());
  const LatticePart layer{
      {size[0], size[1], 1}, {part.lo[0], part.lo[1], 0}, {part.count[0], part.count[1], 1}, {part.stride[0], part.stride[1], 1}};
  std::byte* to = nullptr;
  Array a;
  // Memory for the volume is allocated once the last picture is known to match the first, at least in its header.
  for (const size_t i : {names.size() / 2, names.size() - 1})
    if (lattice_dims(read(i, true)->mesh()) != size) fail_data(fmt::format("'{}' and '{}' differ in size", names[0], names[i]), path);
  a = Array::make_raw(like.array.type(), part.points(), like.components(), &to);
  parallel_for(
      part.count[2], 1,
      [&](size_t k, size_t) {
        const size_t i = part.lo[2] + k * part.stride[2];
        const DatasetPtr d = i == 0 ? first : read(i, false);
        const Field& f = d->fields()[0];
        if (lattice_dims(d->mesh()) != size || f.components() != like.components() || f.array.type() != like.array.type())
          fail_data(fmt::format("'{}' and '{}' differ in size or type", names[0], names[i]), path, "all pictures of a stack must be alike");
        copy_part(f.array.made_packed().raw(), tuple, layer, to + k * layer.points() * tuple);
      },
      &context);
  out.fields.add({like.name, Association::point, std::move(a), "", like.role});
  return make_dataset(std::move(out));
}

}  // namespace sg
