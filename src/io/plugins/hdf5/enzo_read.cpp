// SPDX-License-Identifier: Apache-2.0
// ENZO output: grids of the hierarchy as an AMR grid, their fields from the HDF5 files next to it, in CGS units where the parameter
// file gives factors.
#include <fmt/core.h>

#include <algorithm>

#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "io/io.h"
#include "io/mesh/amr_cover.h"
#include "io/plugins/hdf5/enzo.h"
#include "io/plugins/hdf5/h5.h"
#include "io/vtk/vtk_cells.h"

namespace sg {

namespace {

AmrGrid amr_of(const EnzoHierarchy& h, const std::string& path) {
  AmrGrid amr;
  amr.dimension = h.rank;
  amr.origin = h.grids[0].left;
  for (const EnzoGrid& g : h.grids)
    if (g.level == 0)
      for (int a = 0; a < 3; ++a) amr.origin[a] = std::min(amr.origin[a], g.left[a]);
  for (const EnzoGrid& g : h.grids) {
    if (size_t(g.level) > amr.levels.size()) fail_data(fmt::format("has no grid of level {}", g.level - 1), path);
    const bool fresh = size_t(g.level) == amr.levels.size();
    if (fresh) amr.levels.emplace_back();
    AmrGrid::Level& level = amr.levels[size_t(g.level)];
    AmrGrid::Patch patch;
    const auto n = g.cells();
    for (int a = 0; a < h.rank; ++a) {
      const auto i = size_t(a);
      const double spacing = (g.right[a] - g.left[a]) / double(n[i]);
      if (fresh) level.spacing[a] = spacing;
      // Edges are written with few digits: positions are rounded to whole cells.
      if (std::fabs(spacing / level.spacing[a] - 1) > 1e-3)
        fail_data(fmt::format("grid {} has cells of {}, but others of its level have {}", g.number, spacing, level.spacing[a]), path);
      patch.lo[i] = std::llround((g.left[a] - amr.origin[a]) / level.spacing[a]);
      patch.hi[i] = patch.lo[i] + static_cast<long long>(n[i]) - 1;
      if (!fresh) continue;
      const double ratio = g.level == 0 ? 1 : std::round(amr.levels[size_t(g.level) - 1].spacing[a] / spacing);
      if (!(ratio >= 1 && ratio <= 4096)) fail_data(fmt::format("level {} is {} times as fine as the one above", g.level, ratio), path);
      level.ratio[i] = int(ratio);
    }
    if (h.rank == 2) level.ratio[2] = 1;
    level.patches.push_back(patch);
  }
  number_patches(amr);
  return amr;
}

// The files that hold the grids, opened one at a time: neighbouring grids mostly share one.
class GridFiles {
 public:
  explicit GridFiles(const std::string& hierarchy) : hierarchy_(hierarchy) {}
  const h5::File& file_of(const EnzoGrid& g) {
    const std::string path = named_file(hierarchy_, g.file);
    if (!open_ || open_->path() != path) open_.emplace(path);
    return *open_;
  }
  static std::string group_of(const h5::File& file, const EnzoGrid& g) {
    const std::string group = fmt::format("/Grid{:08}", g.number);
    return file.is_group(group) ? group : "";  // one file per grid: at the top
  }

 private:
  std::string hierarchy_;
  std::optional<h5::File> open_;
};

enum class Extent { none, own, with_ghosts };

// Dimensions are (z, y, x): the grid's own cells, or all with the ghost zones.
Extent extent_of(const h5::Dataset& set, const EnzoGrid& g, int rank) {
  if (!set.numeric() || set.dims().size() != size_t(rank)) return Extent::none;
  bool own = true, all = true;
  for (size_t a = 0; a < size_t(rank); ++a) {
    const uint64_t n = set.dims()[size_t(rank) - 1 - a];
    own = own && n == g.cells()[a];
    all = all && n == uint64_t(g.dims[a]);
  }
  return own ? Extent::own : all ? Extent::with_ghosts : Extent::none;
}

Array read_grid(const h5::File& file, const std::string& dataset, const EnzoGrid& g, int rank) {
  const h5::Dataset set(file, dataset);
  switch (extent_of(set, g, rank)) {
    case Extent::own: return set.read();
    case Extent::none: file.fail(fmt::format("does not have the shape of grid {}", g.number), dataset, "the file is damaged");
    case Extent::with_ghosts: break;
  }
  std::vector<uint64_t> start, count;
  for (size_t a = size_t(rank); a-- > 0;) start.push_back(uint64_t(g.start[a])), count.push_back(g.cells()[a]);
  return set.read_block(start, count, std::vector<uint64_t>(size_t(rank), 1));
}

// Numbers times a factor, each rounded once.
Array scaled(const Array& a, double factor) {
  const Array in = a.converted(a.type() == ElementType::f64 ? ElementType::f64 : ElementType::f32);
  return dispatch(in, [&](auto v) -> Array {
    using T = std::remove_cvref_t<decltype(v(0))>;
    if constexpr (std::is_floating_point_v<T>) {
      T* out = nullptr;
      Array r = Array::make<T>(v.count, 1, &out);
      for (size_t i = 0; i < v.count; ++i) out[i] = T(double(v(i)) * factor);
      return r;
    } else {
      return in;
    }
  });
}

std::string unit_of(const h5::File& file, const std::string& dataset, const std::string& name, bool cgs) {
  if (cgs && name.ends_with("elocity")) return "cm/s";
  if (cgs && name.ends_with("ensity")) return "g/cm^3";
  const auto unit = file.text_attribute(dataset, "Units");
  return unit && *unit != "none" ? *unit : "";
}

void read_enzo_fields(const EnzoHierarchy& h, const std::string& path, const ReadOptions& options, Context& context, DatasetParts& parts) {
  GridFiles files(path);
  const EnzoGrid& first = h.grids[0];
  if (first.file.empty() || options.header_only) return;
  std::vector<Field> fields;
  {
    const h5::File& file = files.file_of(first);
    const std::string group = GridFiles::group_of(file, first);
    for (const std::string& name : file.children(group.empty() ? "/" : group)) {
      const std::string dataset = group + "/" + name;
      if (!options.fields.empty() && std::find(options.fields.begin(), options.fields.end(), name) == options.fields.end()) continue;
      if (file.is_dataset(dataset) && extent_of(h5::Dataset(file, dataset), first, h.rank) != Extent::none)
        fields.push_back({name, Association::cell, {}, {}, Role::none});
    }
  }
  std::map<std::string, double> factors;
  const std::string parameters = path.substr(0, path.rfind('.'));
  if (file_exists(parameters) && !is_folder(parameters)) factors = enzo_factors(MappedFile(parameters).text());
  std::vector<std::vector<Array>> patches(fields.size());
  for (const EnzoGrid& g : h.grids) {
    context.check();
    if (g.file.empty()) fail_data(fmt::format("grid {} has no fields", g.number), path, "BaryonFileName");
    const h5::File& file = files.file_of(g);
    const std::string group = GridFiles::group_of(file, g);
    for (size_t i = 0; i < fields.size(); ++i) {
      const auto factor = factors.find(fields[i].name);
      Array a = read_grid(file, group + "/" + fields[i].name, g, h.rank);
      if (&g == &h.grids[0]) fields[i].unit = unit_of(file, group + "/" + fields[i].name, fields[i].name, factor != factors.end());
      if (!patches[i].empty() && a.type() != patches[i][0].type() && factor == factors.end()) a = a.converted(patches[i][0].type());
      patches[i].push_back(factor == factors.end() ? std::move(a) : scaled(a, factor->second));
    }
  }
  for (size_t i = 0; i < fields.size(); ++i) {
    for (Array& a : patches[i])
      if (a.type() != patches[i][0].type()) a = a.converted(patches[i][0].type());
    fields[i].array = vtk::concatenated(patches[i]);
    parts.fields.add(std::move(fields[i]));
  }
}

}  // namespace

Data read_enzo(const std::string& path, const ReadOptions& options, Context& context) {
  const h5::Turn turn;
  const EnzoHierarchy h = parse_enzo_hierarchy(MappedFile(path).text(), path);
  DatasetParts parts;
  parts.time = h.time;
  AmrGrid amr = amr_of(h, path);
  read_enzo_fields(h, path, options, context, parts);
  if (cell_count(amr) > (size_t(1) << 26) && parts.fields.empty() && !options.header_only && options.fields.empty())
    fail_data(fmt::format("announces {} cells, but there are no fields on them", cell_count(amr)), path);
  if (!parts.fields.empty() || cell_count(amr) <= (size_t(1) << 26)) parts.cell_ghost = refined_cells(amr);
  if (h.particles > 0) context.info(fmt::format("{}: its {} particles are ignored", path, h.particles));
  parts.mesh = std::move(amr);
  return make_dataset(std::move(parts));
}

std::vector<double> times_of_enzo(const std::string& path, const ReadOptions&, Context&) {
  const EnzoHierarchy h = parse_enzo_hierarchy(MappedFile(path).text(), path);
  return h.time ? std::vector<double>{*h.time} : std::vector<double>();
}

}  // namespace sg
