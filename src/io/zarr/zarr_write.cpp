// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>

#include "base/error.h"
#include "base/file/file.h"
#include "base/file/partial_file.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/bricked.h"
#include "io/formats.h"
#include "io/zarr/zarr.h"
#include "io/zarr/zarr_codec.h"
#include "io/zarr/zarr_halve.h"

namespace sg {

namespace {

namespace fs = std::filesystem;

// A folder that is whole or not there.
class AtomicFolder {
 public:
  explicit AtomicFolder(std::string path) : path_(std::move(path)) {
    while (path_.size() > 1 && path_.back() == '/') path_.pop_back();
    if (file_exists(path_) && !(is_folder(path_) && sniff_zarr_folder(path_)))
      fail_usage("exists already and is not a Zarr folder", path_, "remove it first, or choose another name");
    partial_ = make_partial_folder(path_, false);
  }
  ~AtomicFolder() {
    const CleaningUp busy;
    std::error_code ignored;
    if (!partial_.empty()) fs::remove_all(partial_, ignored);
  }
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  const std::string& partial() const { return partial_; }
  void commit() {
    const std::string old = partial_ + "-old";
    std::error_code ignored;
    const bool replace = file_exists(path_);
    if (replace && ::rename(path_.c_str(), old.c_str()) != 0) fail_data(std::string("cannot be replaced: ") + std::strerror(errno), path_);
    if (::rename(partial_.c_str(), path_.c_str()) != 0) {
      const int error = errno;
      if (replace) fs::rename(old, path_, ignored);
      fail_data(std::string("cannot be written: ") + std::strerror(error), path_);
    }
    partial_.clear();
    if (replace) fs::remove_all(old, ignored);
  }

 private:
  std::string path_, partial_;
};

void make_folder(const std::string& path) {
  if (::mkdir(path.c_str(), 0777) != 0 && errno != EEXIST) fail_data(std::string("cannot be created: ") + std::strerror(errno), path);
}

// The folder around it becomes whole by its rename; its files need none.
void put_file(const std::string& path, std::span<const std::byte> bytes) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  int error = fd < 0 ? errno : 0;
  for (size_t at = 0; fd >= 0 && at < bytes.size() && !error;) {
    const ssize_t n = ::write(fd, bytes.data() + at, bytes.size() - at);
    if (n > 0) at += size_t(n);
    else if (errno != EINTR) error = errno ? errno : EIO;
  }
  if (fd >= 0 && ::close(fd) != 0 && !error) error = errno;
  if (error) fail_data(std::string("cannot be written: ") + std::strerror(error), path);
}
void put_text(const std::string& path, std::string_view text) { put_file(path, std::as_bytes(std::span(text))); }

constexpr const char* dtypes[] = {"|u1", "|i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f4", "<f8"};  // in the order of ElementType

std::string list(const std::vector<size_t>& numbers) {
  std::string s;
  for (const size_t n : numbers) s += (s.empty() ? "" : ", ") + std::to_string(n);
  return "[" + s + "]";
}

struct Level {
  std::array<size_t, 3> dims{}, chunk{};
  Vec3 spacing, origin;
  std::array<bool, 3> halved{};  // along which axes the next level is coarser
  std::string folder, chunks;    // where its description and its chunks are
  Array slab;                    // slices that wait until a layer of chunks is full
  std::byte* values = nullptr;
  size_t filled = 0, layer = 0;
};

class Writer {
 public:
  /// `step`: of a series, whose steps before it are there.
  Writer(const std::string& folder, const SlabSource& source, const ZarrOptions& options, std::optional<zarr::SeriesStep> step,
         Context& context)
      : source_(source),
        step_(step),
        direction_(source.grid.direction),
        packing_{options.compression},
        context_(context),
        folder_(folder),
        tuple_(element_size(source.type) * size_t(source.components)) {
    plan(options.chunk);
    for (int c = 0; c < source.components; ++c) extremes_.emplace_back(source.grid.dims);
    for (Level& l : levels_) {
      make_folder(l.folder);
      if (step_) {
        l.chunks += std::to_string(step_->step) + "/";
        std::error_code ignored;
        fs::remove_all(l.chunks, ignored);  // of a run that was broken off
        make_folder(l.chunks);
      }
      if (source.components > 1)
        for (int c = 0; c < source.components; ++c) make_folder(fmt::format("{}{}", l.chunks, c));
    }
  }

  size_t layer() const { return levels_[0].chunk[2]; }
  const std::vector<Level>& levels() const { return levels_; }

  void add(const Array& slab, size_t count) {
    for (int c = 0; c < source_.components; ++c) extremes_[size_t(c)].add(slab, c, count);
    push(0, slab.raw(), count);
  }

  void finish() {
    for (size_t l = 0; l < levels_.size(); ++l)
      if (levels_[l].filled > 0) flush(l, levels_[l].values, std::exchange(levels_[l].filled, 0));
    // The finest level says how many steps there are: it comes last.
    for (size_t l = levels_.size(); l-- > 0;) write_file(levels_[l].folder + ".zarray", array_text(levels_[l]));
    write_file(folder_ + "/.zgroup", "{\n  \"zarr_format\": 2\n}\n");
    write_file(folder_ + "/.zattrs", attributes());
    if (!step_) write_extremes();
  }

 private:
  // Levels, and layers of chunks thin enough for the memory allowed.
  void plan(size_t edge) {
    const UniformGrid& g = source_.grid;
    size_t thick = edge;
    const size_t slice = g.dims[0] * g.dims[1] * tuple_;
    while (context_.memory_limit && thick > 8 && slice * thick > context_.memory_limit / 4) thick /= 2;
    if (thick < edge) context_.info(fmt::format("chunks are {} slices thick, to stay within the allowed memory while writing", thick));
    Level l;
    l.dims = g.dims;
    l.spacing = g.spacing;
    for (int a = 0; a < 3; ++a) {  // scales are above 0; a turned axis becomes a direction
      if (l.spacing[a] == 0) l.spacing[a] = 1;
      if (l.spacing[a] > 0) continue;
      l.spacing[a] = -l.spacing[a];
      for (int r = 0; r < 3; ++r) direction_.m[r][a] = -direction_.m[r][a];
    }
    l.origin = transpose(direction_) * g.origin;
    for (;;) {
      bool more = false;
      for (size_t a = 0; a < 3; ++a) {
        l.chunk[a] = std::min(a == 2 ? thick : edge, l.dims[a]);
        if (a == 2 && l.dims[2] > thick) l.chunk[a] = thick;
        l.halved[a] = l.dims[a] > std::min<size_t>(32, edge);  // or a level other than the last would not be coarser
        more = more || l.dims[a] > edge;
      }
      if (!more) l.halved = {};
      l.folder = l.chunks = fmt::format("{}/{}/", folder_, levels_.size());
      levels_.push_back(l);
      if (!more || levels_.size() == 60) break;
      for (size_t a = 0; a < 3; ++a)
        if (l.halved[a]) {
          l.dims[a] = (l.dims[a] + 1) / 2;
          l.origin[int(a)] += 0.5 * l.spacing[int(a)], l.spacing[int(a)] *= 2;
        }
    }
  }

  // Takes slices of level l; writes chunks, and hands means on, whenever a layer is full.
  void push(size_t l, const std::byte* slices, size_t count) {
    Level& level = levels_[l];
    const size_t slice = level.dims[0] * level.dims[1] * tuple_, layer = level.chunk[2];
    while (count > 0) {
      if (level.filled == 0 && count >= layer) {  // straight from where it lies
        flush(l, slices, layer);
        slices += layer * slice, count -= layer;
        continue;
      }
      if (!level.values) level.slab = Array::make_raw(ElementType::u8, slice * layer, 1, &level.values);
      const size_t n = std::min(count, layer - level.filled);
      std::memcpy(level.values + level.filled * slice, slices, n * slice);
      level.filled += n, slices += n * slice, count -= n;
      if (level.filled == layer) flush(l, level.values, std::exchange(level.filled, 0));
    }
  }

  void flush(size_t l, const std::byte* values, size_t count) {
    Level& level = levels_[l];
    write_layer(level, values, count);
    if (l + 1 == levels_.size()) return;
    const Level& next = levels_[l + 1];
    const size_t means = level.halved[2] ? (count + 1) / 2 : count;
    std::byte* out = nullptr;
    const Array held = Array::make_raw(ElementType::u8, next.dims[0] * next.dims[1] * means * tuple_, 1, &out);
    zarr::halve({source_.type, source_.components, source_.role == Role::labels}, values, {level.dims[0], level.dims[1], count},
                level.halved, out);
    push(l + 1, out, means);
  }

  void write_layer(Level& level, const std::byte* values, size_t count) {
    const size_t nx = (level.dims[0] + level.chunk[0] - 1) / level.chunk[0], ny = (level.dims[1] + level.chunk[1] - 1) / level.chunk[1];
    const size_t components = size_t(source_.components), element = element_size(source_.type);
    for (size_t c = 0; c < components; ++c) {
      const std::string top =
          components > 1 ? fmt::format("{}{}/{}/", level.chunks, c, level.layer) : fmt::format("{}{}/", level.chunks, level.layer);
      make_folder(top);
      for (size_t j = 0; j < ny; ++j) make_folder(fmt::format("{}{}", top, j));
      parallel_for(
          nx * ny, 1,
          [&](size_t begin, size_t end) {
            std::vector<std::byte> chunk(level.chunk[0] * level.chunk[1] * level.chunk[2] * element), packed;
            for (size_t n = begin; n < end; ++n) {
              const size_t i = n % nx, j = n / nx;
              gather(level, values, count, c, i, j, chunk.data());
              zarr::encode(packing_, chunk, element, packed);
              put_file(fmt::format("{}{}/{}", top, j, i), packed);
            }
          },
          &context_);
    }
    ++level.layer;
  }

  // One component of a chunk; what lies beyond the grid is 0.
  void gather(const Level& level, const std::byte* values, size_t count, size_t component, size_t ci, size_t cj, std::byte* out) const {
    const size_t element = element_size(source_.type), x0 = ci * level.chunk[0], y0 = cj * level.chunk[1];
    const size_t n = std::min(level.chunk[0], level.dims[0] - x0), rows = std::min(level.chunk[1], level.dims[1] - y0);
    if (n < level.chunk[0] || rows < level.chunk[1] || count < level.chunk[2])
      std::memset(out, 0, level.chunk[0] * level.chunk[1] * level.chunk[2] * element);
    for (size_t k = 0; k < count; ++k)
      for (size_t j = 0; j < rows; ++j) {
        const std::byte* from = values + ((k * level.dims[1] + y0 + j) * level.dims[0] + x0) * tuple_ + component * element;
        std::byte* to = out + (k * level.chunk[1] + j) * level.chunk[0] * element;
        if (tuple_ == element) std::memcpy(to, from, n * element);
        else
          for (size_t i = 0; i < n; ++i) std::memcpy(to + i * element, from + i * tuple_, element);
      }
  }

  std::string array_text(const Level& l) const {
    const auto shape = [&](const std::array<size_t, 3>& n, size_t c, size_t steps) {
      std::vector<size_t> all;
      if (step_) all.push_back(steps);
      if (source_.components > 1) all.push_back(c);
      all.insert(all.end(), {n[2], n[1], n[0]});
      return list(all);
    };
    return fmt::format(
        "{{\n  \"zarr_format\": 2,\n  \"shape\": {},\n  \"chunks\": {},\n  \"dtype\": \"{}\",\n  \"compressor\": {},\n  \"fill_value\": "
        "0,\n"
        "  \"filters\": null,\n  \"order\": \"C\",\n  \"dimension_separator\": \"/\"\n}}\n",
        shape(l.dims, size_t(source_.components), step_ ? step_->step + 1 : 1), shape(l.chunk, 1, 1), dtypes[size_t(source_.type)],
        packing_.json());
  }

  std::string attributes() const {
    constexpr std::pair<const char*, const char*> units[] = {{"m", "meter"},          {"mm", "millimeter"}, {"um", "micrometer"},
                                                             {"nm", "nanometer"},     {"cm", "centimeter"}, {"km", "kilometer"},
                                                             {"angstrom", "angstrom"}};
    std::string unit;
    for (const auto& [ours, name] : units)
      if (source_.length_unit == ours) unit = fmt::format(", \"unit\": \"{}\"", name);
    const bool many = source_.components > 1;
    std::string axes = step_ ? "{\"name\": \"t\", \"type\": \"time\"}, " : "";
    if (many) axes += "{\"name\": \"c\", \"type\": \"channel\"}, ";
    for (const char* a : {"z", "y", "x"})
      axes += fmt::format("{}{{\"name\": \"{}\", \"type\": \"space\"{}}}", a[0] == 'z' ? "" : ", ", a, unit);
    std::string datasets;
    for (size_t l = 0; l < levels_.size(); ++l) {
      const auto vec = [&](Vec3 v, const char* channel, double time) {
        return fmt::format("[{}{}{}, {}, {}]", step_ ? exact_number(time) + ", " : "", many ? channel : "", exact_number(v.z),
                           exact_number(v.y), exact_number(v.x));
      };
      datasets += fmt::format(
          "{}\n        {{\"path\": \"{}\", \"coordinateTransformations\": [{{\"type\": \"scale\", \"scale\": {}}}, "
          "{{\"type\": \"translation\", \"translation\": {}}}]}}",
          l ? "," : "", l, vec(levels_[l].spacing, "1, ", step_ ? step_->interval : 0),
          vec(levels_[l].origin, "0, ", step_ ? step_->first : 0));
    }
    std::string channels;
    for (int c = 0; c < source_.components; ++c) channels += fmt::format("{}{{\"label\": {}}}", c ? ", " : "", json_string(source_.field));
    std::string direction;
    if (!(direction_ == Mat3{})) {
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) direction += (direction.empty() ? "" : ", ") + exact_number(direction_.m[r][c]);
      direction = fmt::format(", \"direction\": [{}]", direction);
    }
    // The extremes are those of a lone volume.
    const std::string ours = step_ ? fmt::format("\"recipe\": {}", json_string(step_->recipe)) : "\"minmax\": \"minmax\"";
    return fmt::format(
        "{{\n  \"multiscales\": [\n    {{\n      \"version\": \"0.4\",\n      \"name\": {},\n      \"type\": \"{}\",\n      \"axes\": "
        "[{}],\n"
        "      \"datasets\": [{}\n      ]\n    }}\n  ],\n  \"omero\": {{\"channels\": [{}]}},\n"
        "  \"sightglass\": {{{}, \"unit\": {}, \"vector\": {}, \"labels\": {}{}}}\n}}\n",
        json_string(source_.title), source_.role == Role::labels ? "most frequent" : "mean", axes, datasets, channels, ours,
        json_string(source_.unit), many, source_.role == Role::labels, direction);
  }

  // minmax/: an array [component, z, y, x, lowest and highest] of one chunk per component.
  void write_extremes() {
    const std::string folder = folder_ + "/minmax/";
    make_folder(folder);
    BrickedVolume shape;
    shape.levels.push_back({source_.grid.dims, {}, {}, {1, 1, 1}});
    const auto n = shape.blocks();
    put_text(folder + ".zarray",
             fmt::format("{{\n  \"zarr_format\": 2,\n  \"shape\": {},\n  \"chunks\": {},\n  \"dtype\": \"<f4\",\n  \"compressor\": {},\n"
                         "  \"fill_value\": 0,\n  \"filters\": null,\n  \"order\": \"C\",\n  \"dimension_separator\": \".\"\n}}\n",
                         list({extremes_.size(), n[2], n[1], n[0], 2}), list({1, n[2], n[1], n[0], 2}), packing_.json()));
    std::vector<std::byte> packed;
    for (size_t c = 0; c < extremes_.size(); ++c) {
      const auto values = extremes_[c].take();
      zarr::encode(packing_, std::as_bytes(std::span(values)), 4, packed);
      put_file(fmt::format("{}{}.0.0.0.0", folder, c), packed);
    }
  }

  const SlabSource& source_;
  std::optional<zarr::SeriesStep> step_;
  Mat3 direction_;
  zarr::Packing packing_;
  Context& context_;
  std::string folder_;
  size_t tuple_;
  std::vector<Level> levels_;
  std::vector<BlockExtremes> extremes_;
};

void check(const std::string& path, const SlabSource& source, const ZarrOptions& options) {
  zarr::check_packing({options.compression}, path);
  if (options.chunk < 8 || options.chunk > 512 || options.chunk % 2)
    fail_usage(fmt::format("chunks of {} samples", options.chunk), path, "give an even number from 8 to 512, e.g. 64");
  for (const size_t n : source.grid.dims)
    if (n == 0) fail_usage("there are no points to write", path);
}

void write_all(Writer& writer, const std::string& path, const SlabSource& source, Context& context) {
  const size_t all = source.grid.dims[2], at_once = source.best_slab ? source.best_slab : std::min(writer.layer(), all);
  for (size_t first = 0; first < all; first += at_once) {
    context.check();
    const size_t count = std::min(at_once, all - first);
    const Array slab = source.slab(first, count).made_packed();
    if (slab.count() != source.grid.dims[0] * source.grid.dims[1] * count || slab.type() != source.type ||
        slab.components() != source.components)
      fail_internal("a slab differs in size or type from what was announced", path);
    writer.add(slab, count);
    context.progress(double(first + count) / double(all), "writing chunks");
  }
  writer.finish();
}

}  // namespace

void write_zarr_slabs(const std::string& path, const SlabSource& source, const ZarrOptions& options, Context& context) {
  check(path, source, options);
  AtomicFolder folder(path);
  Writer writer(folder.partial(), source, options, {}, context);
  write_all(writer, path, source, context);
  folder.commit();
}

void zarr::write_step(const std::string& path, const SlabSource& source, const ZarrOptions& options, const SeriesStep& step,
                      Context& context) {
  check(path, source, options);
  Writer writer(path, source, options, step, context);
  write_all(writer, path, source, context);
}

}  // namespace sg
