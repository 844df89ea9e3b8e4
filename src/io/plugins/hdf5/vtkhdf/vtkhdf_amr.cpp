// SPDX-License-Identifier: Apache-2.0
// VTKHDF: overlapping AMR. Groups Level0, Level1, ... hold the spacing, the boxes and the fields of all boxes one after the other.
#include <fmt/core.h>

#include "base/bytes.h"
#include "io/mesh/amr_cover.h"
#include "io/plugins/hdf5/vtkhdf/vtkhdf.h"
#include "io/vtk/vtk_cells.h"

namespace sg::vtkhdf {

namespace {

constexpr size_t most_levels = 64;

std::string level_name(size_t l) { return fmt::format("Level{}", l); }

void read_level(const Group& g, size_t l, AmrGrid& grid) {
  const Group level{g.file, g.at(level_name(l)), g.options, g.context, {}};
  AmrGrid::Level out;
  const std::vector<double> spacing = g.file.number_attribute(level.path, "Spacing");
  if (spacing.size() != 3) g.file.fail("has no attribute 'Spacing' of 3 numbers", level.path);
  for (size_t a = 0; a < 3; ++a) {
    out.spacing[int(a)] = spacing[a];
    const bool flat = grid.dimension == 2 && a == 2;
    if (!flat && !(spacing[a] > 0 && std::isfinite(spacing[a]))) g.file.fail(fmt::format("has the spacing {}", spacing[a]), level.path);
    const double ratio = l == 0 || flat ? 1 : std::round(grid.levels.back().spacing[int(a)] / spacing[a]);
    if (!(ratio >= 1 && ratio <= 4096)) g.file.fail(fmt::format("has {} times the spacing of the level above", 1 / ratio), level.path);
    out.ratio[a] = int(ratio);
  }
  const h5::Dataset boxes(g.file, level.at("AMRBox"));
  const uint64_t from = g.step_entry(level_name(l) + "/AMRBoxOffset", 0);
  const uint64_t n = g.step_entry(level_name(l) + "/NumberOfAMRBox", boxes.rows());
  if (n > 0 && boxes.row_size() != 6) g.file.fail(fmt::format("has {} numbers for each box", boxes.row_size()), boxes.path(), "6");
  const Array box = n > 0 ? boxes.read_rows(from, n).converted(ElementType::i64) : Array();
  for (size_t i = 0; i < box.count(); ++i) {
    const auto v = box.view<int64_t>();
    AmrGrid::Patch p;
    for (int a = 0; a < 3; ++a) p.lo[size_t(a)] = v(i, 2 * a), p.hi[size_t(a)] = v(i, 2 * a + 1);
    if (grid.dimension == 2) p.hi[2] = p.lo[2];  // flat boxes end before they begin
    out.patches.push_back(p);
  }
  grid.levels.push_back(std::move(out));
}

// A field of one association, level after level; nothing when it is not in all levels with one type.
std::optional<Array> read_levels(const Group& g, const AmrGrid& grid, const std::string& data, const std::string& name) {
  std::vector<Array> parts;
  const bool points = data == "PointData";
  for (size_t l = 0; l < grid.levels.size(); ++l) {
    const std::string level = level_name(l), path = g.at(level + "/" + data + "/" + name);
    uint64_t n = 0;
    for (const auto& p : grid.levels[l].patches) {
      const auto c = p.cells();
      n += points ? (c[0] + 1) * (c[1] + 1) * (grid.dimension == 2 ? 1 : c[2] + 1) : c[0] * c[1] * c[2];
    }
    if (n == 0) continue;
    if (!g.file.is_dataset(path)) return {};
    const h5::Dataset set(g.file, path);
    Array a = set.read_rows(g.step_entry(level + "/" + data + "Offsets/" + name, 0), n);
    if (!parts.empty() && (a.type() != parts[0].type() || a.components() != parts[0].components())) return {};
    parts.push_back(std::move(a));
  }
  return vtk::concatenated(parts);
}

// Whether every level has a cell field of the length that its boxes imply: memory per cell must not be allocated on the word of the boxes
// alone.
bool fields_back(const Group& g, const AmrGrid& grid) {
  for (size_t l = 0; l < grid.levels.size(); ++l) {
    uint64_t n = 0;
    for (const auto& p : grid.levels[l].patches) n += p.cells()[0] * p.cells()[1] * p.cells()[2];
    const std::string data = g.at(level_name(l) + "/CellData");
    bool found = n == 0;
    if (!found && g.file.is_group(data))
      for (const std::string& name : g.file.children(data)) {
        if (found || !g.file.is_dataset(data + "/" + name)) continue;
        const h5::Dataset d(g.file, data + "/" + name);
        found = d.rows() >= n && d.backed();
      }
    if (!found) return false;
  }
  return true;
}

}  // namespace

void read_amr(const Group& g, DatasetParts& parts) {
  AmrGrid grid;
  const std::string plane = g.file.text_attribute(g.path, "GridDescription").value_or("XYZ");
  if (plane != "XYZ" && plane != "XY") g.file.fail(fmt::format("is an AMR grid in '{}'", plane), g.path, "use XYZ or XY");
  grid.dimension = plane == "XY" ? 2 : 3;
  const std::vector<double> origin = g.file.number_attribute(g.path, "Origin");
  if (origin.size() != 3) g.file.fail("has no attribute 'Origin' of 3 numbers", g.path);
  grid.origin = {origin[0], origin[1], origin[2]};
  for (size_t l = 0; l < most_levels && g.file.is_group(g.at(level_name(l))); ++l) read_level(g, l, grid);
  if (grid.levels.empty()) g.file.fail("has no 'Level0'", g.path, "the file is not complete");
  number_patches(grid);
  for (const auto& [data, association] : {std::pair("PointData", Association::point), std::pair("CellData", Association::cell)}) {
    const Group first{g.file, g.at(level_name(0)), g.options, g.context, {}};
    for (const std::string& name : field_names(first, data)) {
      if (auto a = read_levels(g, grid, data, name)) parts.fields.add(field_of(first, data, name, association, std::move(*a)));
      else g.context.warn(fmt::format("{}: array '{}' differs between levels and is left out", g.file.path(), name));
    }
  }
  // Files without ghosts mean that finer levels cover coarser ones.
  const bool marked = parts.fields.find("vtkGhostType", Association::cell) != nullptr;
  const size_t cells = cell_count(grid);
  if (!marked) {
    if (cells > (size_t(1) << 26) && !fields_back(g, grid))
      g.file.fail(fmt::format("has boxes of {} cells, but no fields on them", cells), g.path, "the file is damaged");
    parts.cell_ghost = refined_cells(grid);
  }
  parts.mesh = std::move(grid);
}

}  // namespace sg::vtkhdf
