// SPDX-License-Identifier: Apache-2.0
// Zarr folders as datasets: whole, a part, or, when that is more than memory holds, the finest level that fits with a way to the rest.
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <numeric>

#include "base/file/file.h"
#include "base/text/text.h"
#include "data/bricked.h"
#include "io/formats.h"
#include "io/mesh/unread.h"
#include "io/zarr/zarr_image.h"

namespace sg {

namespace {

using zarr::Image;

// One point field: a channel, or all of them as components.
struct Planned {
  std::string name;
  std::vector<size_t> channels;
};

std::vector<Planned> fields_of(const Image& image, const ReadOptions& options) {
  std::vector<Planned> fields;
  if (image.vector) {
    std::vector<size_t> all(image.channels.size());
    std::iota(all.begin(), all.end(), size_t(0));
    if (is_wanted(options.fields, image.channels[0])) fields.push_back({image.channels[0], all});
    return fields;
  }
  for (size_t c = 0; c < image.channels.size(); ++c)
    if (is_wanted(options.fields, image.channels[c])) fields.push_back({image.channels[c], {c}});
  return fields;
}

// Without a stated limit, half of this machine's memory.
uint64_t allowed_bytes(const Context& context) {
  if (context.memory_limit) return context.memory_limit / 2;
  return uint64_t(::sysconf(_SC_PHYS_PAGES)) * uint64_t(::sysconf(_SC_PAGESIZE)) / 2;
}

Field read_field(const Image& image, size_t level, size_t step, const LatticePart& part, const Planned& planned, bool header_only,
                 Context& context) {
  const ElementType type = image.levels[level].array.type;
  const size_t n = planned.channels.size();
  const Role role = image.labels ? Role::labels : n == 3 && is_float(type) ? Role::vectors : Role::scalars;
  if (header_only) return {planned.name, Association::point, unread_values(type, part.points(), int(n)), image.unit, role};
  // Sparse arrays are fine, but a large array without any chunk is an error, and not worth the memory.
  if (part.points() > (size_t(1) << 22) && !any_chunk(box_of(image, level, step, planned.channels[0])))
    fail_data("no chunk of this array exists", image.levels[level].array.folder, "expected one file per chunk");
  std::byte* out = nullptr;
  Array values = Array::make_raw(type, part.points(), int(n), &out);
  for (size_t c = 0; c < n; ++c)
    read_part(box_of(image, level, step, planned.channels[c]), part, out + c * element_size(type), n, zarr::fresh_chunks(), &context, true);
  return {planned.name, Association::point, std::move(values), image.unit, role};
}

std::string size_text(const std::array<size_t, 3>& n) { return fmt::format("{}x{}x{}", n[0], n[1], n[2]); }

// The level to hold in memory for a volume that does not fit.
size_t level_in_memory(const Image& image, uint64_t tuple, uint64_t allowed) {
  const uint64_t most = std::min<uint64_t>(allowed / 8, uint64_t(256) << 20);
  for (size_t l = 0; l < image.levels.size(); ++l) {
    const auto n = image.dims(l);
    if (n[0] * n[1] * n[2] <= most / tuple) return l;
  }
  const auto n = image.dims(0);
  fail_usage(fmt::format("{} need {}, and the file has no coarser level", size_text(n), human_bytes(n[0] * n[1] * n[2] * tuple)),
             image.path,
             "read a part (--region, --stride), or create a file with levels: sightglass convert IN -o OUT.ome.zarr --memory 2G");
}

std::vector<double> times_in(const Image& image) {
  std::vector<double> times;
  if (image.time_axis >= 0 && image.steps() <= 1000000)
    for (size_t i = 0; i < image.steps(); ++i) times.push_back(image.first_time + double(i) * image.time_step);
  return times;
}

}  // namespace

bool sniff_zarr_folder(const std::string& path) {
  for (const char* name : {"/.zattrs", "/.zarray", "/.zgroup", "/zarr.json"})
    if (file_exists(path + name)) return true;
  return false;
}

std::vector<double> times_of_zarr(const std::string& path, const ReadOptions&, Context&) { return times_in(zarr::open_image(path)); }

Data read_zarr(const std::string& path, const ReadOptions& options, Context& context) {
  const auto image = std::make_shared<const Image>(zarr::open_image(path));
  const std::vector<double> times = times_in(*image);
  const size_t step = times.empty() ? 0 : chosen_step(times, options, path);
  const std::vector<Planned> planned = fields_of(*image, options);
  uint64_t tuple = 0;  // bytes per sample of what is wanted
  for (const Planned& p : planned) tuple += p.channels.size() * element_size(image->levels[0].array.type);
  const auto dims = image->dims(0);
  const uint64_t allowed = allowed_bytes(context);
  const bool too_large = tuple > 0 && dims[0] * dims[1] * dims[2] > allowed / tuple;
  const bool coarse = too_large && options.region.whole() && !options.header_only;
  const size_t level = coarse ? level_in_memory(*image, tuple, allowed) : 0;

  DatasetParts parts;
  UniformGrid grid = image->grid(level);
  const LatticePart part = cut_grid(grid, options.region);
  parts.mesh = grid;
  for (const Planned& p : planned) parts.fields.add(read_field(*image, level, step, part, p, options.header_only, context));
  if (!image->name.empty()) parts.notes.emplace_back("title", image->name);
  if (!image->length_unit.empty()) parts.notes.emplace_back("length unit", image->length_unit);
  if (!times.empty()) parts.time = times[step];
  if (coarse) {
    parts.notes.emplace_back("level",
                             fmt::format("{} of {}: {} of {} samples", level, image->levels.size(), size_text(grid.dims), size_text(dims)));
    const char* rest = planned.size() == 1 && !image->vector ? "the full resolution is drawn by bricks in volumes"
                                                             : "--fields with one name lets volumes be drawn by bricks";
    context.info(fmt::format("{}: {} do not fit into memory; reading level {} with {}, {}", path, size_text(dims), level,
                             size_text(grid.dims), rest));
  }
  if (!coarse || planned.size() != 1 || image->vector) return make_dataset(std::move(parts));
  const size_t cache = size_t(std::min<uint64_t>(allowed / 4, uint64_t(256) << 20));
  return make_dataset(std::move(parts), zarr::bricked(image, step, planned[0].channels[0], cache));
}

}  // namespace sg
