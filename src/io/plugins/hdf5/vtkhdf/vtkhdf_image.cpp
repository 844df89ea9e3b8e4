// SPDX-License-Identifier: Apache-2.0
// VTKHDF: image data. Arrays have the dimensions (z, y, x[, components]), in series with the step in front; of a region only its
// block is read.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "data/lattice_crop.h"
#include "io/plugins/hdf5/vtkhdf/vtkhdf.h"

namespace sg::vtkhdf {

namespace {

std::vector<double> numbers(const Group& g, const char* name, size_t n, std::optional<double> otherwise = {}) {
  std::vector<double> v = g.file.number_attribute(g.path, name);
  if (v.empty() && otherwise) v.assign(n, *otherwise);
  if (v.size() != n) g.file.fail(fmt::format("has an attribute '{}' of {} numbers", name, v.size()), g.path, fmt::format("{}", n));
  return v;
}

UniformGrid whole_grid(const Group& g) {
  UniformGrid grid;
  const std::vector<double> extent = numbers(g, "WholeExtent", 6), origin = numbers(g, "Origin", 3, 0.0),
                            spacing = numbers(g, "Spacing", 3, 1.0);
  for (size_t a = 0; a < 3; ++a) {
    const double lo = extent[2 * a], hi = extent[2 * a + 1];
    if (!(hi >= lo) || std::fabs(lo) > 1e12 || std::fabs(hi) > 1e12)
      g.file.fail(fmt::format("has a WholeExtent from {} to {} along {}", lo, hi, "xyz"[a]), g.path, "the file is damaged");
    grid.dims[a] = size_t(hi - lo) + 1;
    grid.extent_start[a] = static_cast<long long>(lo);
    grid.spacing[int(a)] = spacing[a];
  }
  const std::vector<double> direction = g.file.number_attribute(g.path, "Direction");
  if (direction.size() == 9)
    for (size_t i = 0; i < 9; ++i) grid.direction.m[i / 3][i % 3] = direction[i];
  const Vec3 steps{double(grid.extent_start[0]) * spacing[0], double(grid.extent_start[1]) * spacing[1],
                   double(grid.extent_start[2]) * spacing[2]};
  grid.origin = Vec3{origin[0], origin[1], origin[2]} + grid.direction * steps;
  return grid;
}

// What is read of an array that has `dims` (x first) tuples: the block at lo, count tuples, every stride-th.
struct Block {
  std::array<size_t, 3> dims, lo, count, stride;
  bool whole() const { return count == dims; }
};

// Whether d[from..] are the dimensions (z, y, x); then `components` gets the product of what follows.
bool matches(const std::vector<uint64_t>& d, size_t from, const std::array<size_t, 3>& dims, uint64_t& components) {
  if (d.size() < from + 3 || d[from] != dims[2] || d[from + 1] != dims[1] || d[from + 2] != dims[0]) return false;
  components = 1;
  for (size_t i = from + 3; i < d.size(); ++i) components *= d[i];
  return components > 0 && components <= 1 << 16;
}

Array read_array(const Group& g, const std::string& data, const std::string& name, const Block& b) {
  const h5::Dataset set(g.file, g.at(data + "/" + name));
  const auto& d = set.dims();
  uint64_t components = 1;
  size_t from = 0;  // position of z
  if (g.step.any && matches(d, 1, b.dims, components)) from = 1;
  else if (!matches(d, 0, b.dims, components)) {
    // Flat pictures may leave dimensions out, and lists may run over all tuples.
    uint64_t tuples = 1;
    for (const size_t n : b.dims)
      if (!multiply(tuples, n, tuples)) tuples = 0;
    components = tuples ? set.count() / tuples : 0;
    if (components == 0 || components > 1 << 16 || set.count() != tuples * components)
      g.file.fail(fmt::format("has {} numbers, which do not fill {}x{}x{}", set.count(), b.dims[0], b.dims[1], b.dims[2]), set.path(),
                  "the file is not complete");
    const Array all = set.read(int(components));
    return b.whole() ? all : crop_block(all, b.dims, b.lo, b.count, b.stride);
  }
  if (from == 0 && b.whole()) return set.read(int(components));
  std::vector<uint64_t> start(d.size(), 0), count = d, stride(d.size(), 1);
  if (from == 1) start[0] = g.step_entry(data + "Offsets/" + name, g.step.index), count[0] = 1;
  for (size_t a = 0; a < 3; ++a) start[from + 2 - a] = b.lo[a], count[from + 2 - a] = b.count[a], stride[from + 2 - a] = b.stride[a];
  return set.read_block(start, count, stride, int(components));
}

}  // namespace

void read_image(const Group& g, DatasetParts& parts) {
  const UniformGrid grid = whole_grid(g);
  Block points{grid.dims, {}, grid.dims, {1, 1, 1}}, cells = points;
  bool with_cells = true;
  for (size_t a = 0; a < 3; ++a) cells.dims[a] = cells.count[a] = std::max<size_t>(grid.dims[a] - 1, 1);
  parts.mesh = grid;
  if (!g.options.region.whole()) {
    const auto& r = g.options.region;
    const DatasetPtr part = crop_lattice(*make_dataset(grid), r.lo, r.hi, r.stride);
    parts.mesh = part->mesh();
    points.lo = cells.lo = r.lo, points.stride = r.stride;
    points.count = part->as<UniformGrid>()->dims;
    for (size_t a = 0; a < 3; ++a) {
      with_cells = with_cells && (r.stride[a] == 1 || grid.dims[a] == 1);
      cells.count[a] = std::max<size_t>(points.count[a] - 1, 1);
      cells.lo[a] = std::min(r.lo[a], cells.dims[a] - 1);  // a plane at the far side takes the preceding cells
    }
  }
  for (const std::string& name : field_names(g, "PointData"))
    parts.fields.add(field_of(g, "PointData", name, Association::point, read_array(g, "PointData", name, points)));
  if (!with_cells) {
    parts.notes.emplace_back("crop", "cell fields were left out: a stride keeps points, not cells");
    return;
  }
  for (const std::string& name : field_names(g, "CellData"))
    parts.fields.add(field_of(g, "CellData", name, Association::cell, read_array(g, "CellData", name, cells)));
}

}  // namespace sg::vtkhdf
