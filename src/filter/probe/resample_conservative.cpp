// SPDX-License-Identifier: Apache-2.0
// Averages that keep integrals: every solid cell is cut along the grid, and each part's content is added to its grid cell.
#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "filter/probe/cell_pieces.h"
#include "filter/probe/cell_slabs.h"
#include "filter/probe/resample.h"
#include "filter/probe/tet_clip.h"

namespace sg {

namespace {

struct Target {
  const Field* field;
  Array values;  // f64, packed
  Array out;
  std::byte* to;
};

// The grid cells [lo, hi) that one mesh cell may reach within a slab, and for each the integrals of its nodes' weights.
struct LocalBox {
  std::array<ptrdiff_t, 3> lo, hi;
  size_t nodes = 0;
  std::vector<double> weights;
  void open(size_t n) {
    nodes = n;
    weights.assign(n * size_t(hi[0] - lo[0]) * size_t(hi[1] - lo[1]) * size_t(hi[2] - lo[2]), 0.0);
  }
  double* at(ptrdiff_t i, ptrdiff_t j, ptrdiff_t k) {
    return &weights[nodes * size_t((i - lo[0]) + (hi[0] - lo[0]) * ((j - lo[1]) + (hi[1] - lo[1]) * (k - lo[2])))];
  }
};

bool along_axes(std::span<const Vec3> p) {
  const Vec3 a = p[1] - p[0], b = p[2] - p[0], c = p[4] - p[0];
  const Vec3 opposite = p[0] + a + b + c - p[7];
  const double small = 1e-12 * length(a + b + c);
  return a.y == 0 && a.z == 0 && b.x == 0 && b.z == 0 && c.x == 0 && c.y == 0 && length(opposite) <= small;
}

// One slab of grid cells and the sums in it.
class SlabSums {
 public:
  SlabSums(const GridScan& scan, const std::vector<Target>& targets, double tolerance, size_t k0, size_t k1)
      : scan_(scan), targets_(targets), tolerance_(tolerance), map_(scan.map), k0_(k0), k1_(k1) {
    for (size_t a = 0; a < 3; ++a) cells_[a] = scan.dims[a] - 1;
    const size_t n = cells_[0] * cells_[1] * (k1 - k0);
    covered_.assign(n, 0);
    for (const Target& t : targets) sums_.emplace_back(n * size_t(t.field->components()), 0.0);
  }

  void add(size_t cell) {
    map_.open(cell);
    const CellReader& reader = map_.reader();
    if (reader.dimension() != 3) return;
    const auto at = reader.at();
    const Box3 box = cell_box(reader);
    const Vec3 from = scan_.to_grid(box.lo), to = scan_.to_grid(box.hi);
    for (int a = 0; a < 3; ++a) {
      const double first = a == 2 ? double(k0_) : 0.0, last = a == 2 ? double(k1_) : double(cells_[size_t(a)]);
      local_.lo[size_t(a)] = ptrdiff_t(GridScan::within(std::floor(from[a]) - 1, first, last));
      local_.hi[size_t(a)] = ptrdiff_t(GridScan::within(std::ceil(to[a]) + 1, first, last));
      if (local_.lo[size_t(a)] >= local_.hi[size_t(a)]) return;
    }
    local_.open(at.size());
    if (reader.type() == CellType::tetra) add_tetra(at);
    else if (reader.type() == CellType::voxel && along_axes(at)) add_voxel(at);
    else add_pieces();
    spread(cell, reader.ids());
  }

  void write(float* coverage) {
    for (size_t i = 0; i < covered_.size(); ++i) coverage[first() + i] = float(covered_[i]);
    for (size_t t = 0; t < targets_.size(); ++t) {
      const size_t at = first() * size_t(targets_[t].field->components());
      for (size_t i = 0; i < sums_[t].size(); ++i)
        if (targets_[t].out.type() == ElementType::f64) reinterpret_cast<double*>(targets_[t].to)[at + i] = sums_[t][i];
        else reinterpret_cast<float*>(targets_[t].to)[at + i] = float(sums_[t][i]);
    }
  }

 private:
  size_t first() const { return cells_[0] * cells_[1] * k0_; }
  void add_tetra(std::span<const Vec3> at) {
    Vec3 p[4];
    for (size_t m = 0; m < 4; ++m) p[m] = scan_.to_grid(at[m]);
    auto emit = [&](double volume, const double* mean, ptrdiff_t i, ptrdiff_t j, ptrdiff_t k) {
      double* w = local_.at(i, j, k);
      for (int m = 0; m < 4; ++m) w[m] += volume * mean[m];
    };
    TetClipper(local_.lo, local_.hi, emit).clip(p);
  }
  // A multilinear function over a box: its volume times the value in the middle.
  void add_voxel(std::span<const Vec3> at) {
    const Vec3 a = scan_.to_grid(at[0]), b = scan_.to_grid(at[7]);
    for (ptrdiff_t k = local_.lo[2]; k < local_.hi[2]; ++k)
      for (ptrdiff_t j = local_.lo[1]; j < local_.hi[1]; ++j)
        for (ptrdiff_t i = local_.lo[0]; i < local_.hi[0]; ++i) {
          const double cell[3] = {double(i), double(j), double(k)};
          double volume = 1, r[3];
          for (int m = 0; m < 3; ++m) {
            const double lo = std::max(std::min(a[m], b[m]), cell[m]), hi = std::min(std::max(a[m], b[m]), cell[m] + 1);
            volume *= std::max(hi - lo, 0.0);
            r[m] = ((lo + hi) / 2 - a[m]) / (b[m] - a[m]);
          }
          if (!(volume > 0)) continue;
          double* w = local_.at(i, j, k);
          for (int c = 0; c < 8; ++c) w[c] += volume * (c & 1 ? r[0] : 1 - r[0]) * (c & 2 ? r[1] : 1 - r[1]) * (c & 4 ? r[2] : 1 - r[2]);
        }
  }
  void add_pieces() {
    pieces_.make(map_, tolerance_);
    const size_t n = pieces_.nodes;
    for (size_t c = 0; c + 3 < pieces_.corners.size(); c += 4) {
      const uint32_t* corner = &pieces_.corners[c];
      Vec3 p[4];
      const double* row[4];
      for (size_t m = 0; m < 4; ++m) p[m] = scan_.to_grid(pieces_.at[corner[m]]), row[m] = &pieces_.rows[corner[m] * n];
      auto emit = [&](double volume, const double* mean, ptrdiff_t i, ptrdiff_t j, ptrdiff_t k) {
        double* w = local_.at(i, j, k);
        for (size_t s = 0; s < n; ++s)
          w[s] += volume * (mean[0] * row[0][s] + mean[1] * row[1][s] + mean[2] * row[2][s] + mean[3] * row[3][s] + pieces_.correction[s]);
      };
      TetClipper(local_.lo, local_.hi, emit).clip(p);
    }
  }
  // From integrals of the nodes' weights to sums of the fields.
  void spread(size_t cell, std::span<const int64_t> ids) {
    const size_t n = local_.nodes;
    for (ptrdiff_t k = local_.lo[2]; k < local_.hi[2]; ++k)
      for (ptrdiff_t j = local_.lo[1]; j < local_.hi[1]; ++j)
        for (ptrdiff_t i = local_.lo[0]; i < local_.hi[0]; ++i) {
          const double* w = local_.at(i, j, k);
          double volume = 0;
          for (size_t s = 0; s < n; ++s) volume += w[s];
          if (volume == 0) continue;
          const size_t out = size_t(i) + cells_[0] * (size_t(j) + cells_[1] * (size_t(k) - k0_));
          covered_[out] += volume;
          for (size_t t = 0; t < targets_.size(); ++t) {
            const auto v = targets_[t].values.view<double>();
            double* sum = &sums_[t][out * size_t(v.components)];
            const bool of_points = targets_[t].field->association == Association::point;
            for (int c = 0; c < v.components; ++c) {
              if (!of_points) sum[c] += volume * v(cell, c);
              else
                for (size_t s = 0; s < n; ++s) sum[c] += w[s] * v(size_t(ids[s]), c);
            }
          }
        }
  }
  const GridScan& scan_;
  const std::vector<Target>& targets_;
  double tolerance_;
  CellMap map_;
  size_t k0_, k1_;
  size_t cells_[3];
  std::vector<double> covered_;
  std::vector<std::vector<double>> sums_;
  LocalBox local_;
  CellPieces pieces_;
};

bool has_solids(const Dataset& d) {
  if (d.as<PointCloud>() || d.as<SurfaceMesh>()) return false;
  for (const auto& [name, count] : cell_type_counts(d.mesh()))
    for (int t = 0; t < 256; ++t)
      if (const CellTypeInfo* info = cell_type_info(uint8_t(t)); info && info->name == name && info->dimension == 3) return true;
  return false;
}

}  // namespace

DatasetPtr resample_conservative(const DatasetPtr& input, const UniformGrid& grid, double tolerance, Context& context) {
  if (!has_solids(*input))
    fail_usage(fmt::format("a mesh of kind '{}' without solid cells has no volume to conserve", input->kind()), "resample",
               "use mode=linear");
  for (size_t n : grid.dims)
    if (n < 2) fail_usage("conservative mode needs grid cells along all axes", "resample", "give 2 points or more along each");
  const Mesh mesh = grid;
  const Lattice lattice(mesh);
  const GridScan scan(input, lattice.view());
  const size_t cells = cell_count(mesh);
  std::vector<Target> targets;
  DatasetParts parts;
  for (const Field& f : input->fields()) {
    if (f.association == Association::whole) {
      parts.fields.add(f);
      continue;
    }
    Target t{&f, f.array.converted(ElementType::f64), {}, nullptr};
    t.out = Array::make_raw(element_size(f.array.type()) == 8 ? ElementType::f64 : ElementType::f32, cells, f.components(), &t.to);
    targets.push_back(std::move(t));
  }
  float* coverage = nullptr;
  Field covered{"coverage", Association::cell, Array::make<float>(cells, 1, &coverage), "", Role::none};
  const size_t layers = grid.dims[2] - 1, thickness = std::max<size_t>(1, layers / 64);
  const CellSlabs slabs = scan.slabs(thickness, true, context);
  parallel_for(
      slabs.size(), 1,
      [&](size_t s, size_t) {
        SlabSums sums(scan, targets, tolerance, s * thickness, std::min((s + 1) * thickness, layers));
        for (size_t c = slabs.begin[s]; c < slabs.begin[s + 1]; ++c) sums.add(slabs.cells[c]);
        sums.write(coverage);
      },
      &context);
  for (const Target& t : targets) {
    const bool twice = t.field->association == Association::cell && input->fields().find(t.field->name, Association::point);
    parts.fields.add({twice ? t.field->name + "_cell" : t.field->name, Association::cell, t.out, t.field->unit, t.field->role});
  }
  parts.fields.add(std::move(covered));
  parts.mesh = grid;
  parts.time = input->time();
  parts.notes = input->notes();
  return make_dataset(std::move(parts));
}

}  // namespace sg
