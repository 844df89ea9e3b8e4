// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/transform/mirror_lattice.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "data/field_ops.h"
#include "data/lattice.h"

namespace sg {

namespace {

using Axes = std::array<bool, 3>;
using Dims = std::array<size_t, 3>;

// ids of a box of `dims` samples from `first` on, backwards along some axes, put at the same places of `out`.
void reversed_ids(Dims dims, Axes axes, size_t first, std::vector<int64_t>& out) {
  parallel_for(dims[1] * dims[2], std::max<size_t>(1, (1 << 14) / std::max<size_t>(dims[0], 1)), [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const size_t j = row % dims[1], k = row / dims[1];
      const size_t from = dims[0] * ((axes[1] ? dims[1] - 1 - j : j) + dims[1] * (axes[2] ? dims[2] - 1 - k : k));
      for (size_t i = 0; i < dims[0]; ++i) out[first + dims[0] * row + i] = int64_t(first + from + (axes[0] ? dims[0] - 1 - i : i));
    }
  });
}

void carry(DatasetParts& parts, const std::vector<int64_t>& points, const std::vector<int64_t>& cells) {
  FieldSet fields;
  for (const Field& f : parts.fields) {
    Field g = f;
    if (f.association == Association::point) g.array = gather(f.array, points);
    if (f.association == Association::cell) g.array = gather(f.array, cells);
    fields.add(std::move(g));
  }
  parts.fields = std::move(fields);
  if (!parts.point_ghost.empty()) parts.point_ghost = gather(parts.point_ghost, points);
  if (!parts.cell_ghost.empty()) parts.cell_ghost = gather(parts.cell_ghost, cells);
}

// -1, 0 or 1: which way the cells of a solid lattice turn (curvilinear ones: most of their volume).
int handedness(const LatticeView& v) {
  if (v.mode == LatticeView::Mode::affine) {
    const double d = dot(cross(normalize(v.step[0]), normalize(v.step[1])), normalize(v.step[2]));
    return (d > 0) - (d < 0);
  }
  const double sum = parallel_reduce(
      v.dims[2] - 1, 1, 0.0,
      [&](size_t begin, size_t end) {
        double s = 0;
        for (size_t k = begin; k < end; ++k)
          for (size_t j = 0; j + 1 < v.dims[1]; ++j)
            for (size_t i = 0; i + 1 < v.dims[0]; ++i) {
              const Vec3 p = v.position(i, j, k);
              const double d = dot(cross(v.position(i + 1, j, k) - p, v.position(i, j + 1, k) - p), v.position(i, j, k + 1) - p);
              if (std::isfinite(d)) s += d;
            }
        return s;
      },
      [](double a, double b) { return a + b; });
  return (sum > 0) - (sum < 0);
}

bool descends(const Mesh& mesh, int axis) {
  if (auto* u = std::get_if<UniformGrid>(&mesh)) return u->spacing[axis] < 0;
  if (auto* r = std::get_if<RectilinearGrid>(&mesh)) {
    const Array& x = axis == 0 ? r->x : axis == 1 ? r->y : r->z;
    return x.count() > 1 && x.get(x.count() - 1) < x.get(0);
  }
  return false;
}

Axes axes_to_reverse(const Mesh& mesh) {
  const Lattice lattice(mesh);
  const LatticeView& v = lattice.view();
  Axes axes{false, false, false};
  int extended = 0, descending = 0, first = -1;
  for (int a = 0; a < 3; ++a) {
    if (v.dims[size_t(a)] < 2) continue;
    ++extended;
    if (first < 0) first = a;
    axes[size_t(a)] = descends(mesh, a);
    descending += axes[size_t(a)];
  }
  if (extended < 2 || (extended == 3 && handedness(v) >= 0)) return {false, false, false};
  // An odd number of axes makes the change.
  if (descending % 2 == 0) axes = {false, false, false}, axes[size_t(first)] = true;
  return axes;
}

void reverse(UniformGrid& g, Axes axes) {
  for (int a = 0; a < 3; ++a) {
    if (!axes[size_t(a)]) continue;
    g.origin += g.direction.column(a) * (g.spacing[a] * double(g.dims[size_t(a)] - 1));
    g.spacing[a] = -g.spacing[a];
  }
  // The axis across a flat grid follows, so that the directions stay right-handed.
  for (int a = 0; a < 3; ++a)
    if (g.dims[size_t(a)] == 1) g.spacing[a] = std::abs(g.spacing[a]);
  for (int a = 0; a < 3; ++a) {
    if (!(g.spacing[a] < 0) || !axes[size_t(a)]) continue;
    g.spacing[a] = -g.spacing[a];
    for (auto& row : g.direction.m) row[a] = -row[a];
  }
  const bool left = determinant(g.direction) * g.spacing.x * g.spacing.y * g.spacing.z < 0;
  for (int a = 0; a < 3 && left; ++a)
    if (g.dims[size_t(a)] == 1) {
      for (auto& row : g.direction.m) row[a] = -row[a];
      break;
    }
}

Array backwards(const Array& a) {
  std::vector<int64_t> ids(a.count());
  reversed_ids({a.count(), 1, 1}, {true, false, false}, 0, ids);
  return gather(a, ids);
}

void reverse(RectilinearGrid& g, Axes axes) {
  if (axes[0]) g.x = backwards(g.x);
  if (axes[1]) g.y = backwards(g.y);
  if (axes[2]) g.z = backwards(g.z);
}

// The whole extent of a grid in pieces turns about 0, so that pieces still meet.
template <class Grid>
void reverse_extent(Grid& g, Dims dims, Axes axes) {
  for (size_t a = 0; a < 3; ++a)
    if (axes[a]) g.extent_start[a] = -(g.extent_start[a] + static_cast<long long>(dims[a]) - 1);
}

// The fields of a lattice of `dims` points, backwards along some axes.
void carry_backwards(DatasetParts& parts, Dims dims, Axes axes, std::vector<int64_t>& points) {
  points.resize(dims[0] * dims[1] * dims[2]);
  reversed_ids(dims, axes, 0, points);
  const Dims of_cells{std::max<size_t>(dims[0] - 1, 1), std::max<size_t>(dims[1] - 1, 1), std::max<size_t>(dims[2] - 1, 1)};
  std::vector<int64_t> cells(of_cells[0] * of_cells[1] * of_cells[2]);
  reversed_ids(of_cells, axes, 0, cells);
  carry(parts, points, cells);
}

}  // namespace

void number_backwards(DatasetParts& parts, Axes axes) {
  auto* u = std::get_if<UniformGrid>(&parts.mesh);
  auto* r = std::get_if<RectilinearGrid>(&parts.mesh);
  if ((!u && !r) || (!axes[0] && !axes[1] && !axes[2])) return;
  const Dims dims = lattice_dims(parts.mesh);
  std::vector<int64_t> points;
  carry_backwards(parts, dims, axes, points);
  if (r) {
    reverse(*r, axes), r->extent_start = {};
    return;
  }
  for (int a = 0; a < 3; ++a)
    if (axes[size_t(a)]) {
      u->origin += u->direction.column(a) * (u->spacing[a] * double(dims[size_t(a)] - 1));
      u->spacing[a] = -u->spacing[a];
    }
  u->extent_start = {};
}

void turn_mirrored_lattice(DatasetParts& parts) {
  if (std::holds_alternative<AmrGrid>(parts.mesh)) return ascend_amr(parts);
  if (!is_lattice(parts.mesh)) return;
  const Axes axes = axes_to_reverse(parts.mesh);
  if (!axes[0] && !axes[1] && !axes[2]) return;
  const Dims dims = lattice_dims(parts.mesh);
  std::vector<int64_t> points;
  carry_backwards(parts, dims, axes, points);
  if (auto* u = std::get_if<UniformGrid>(&parts.mesh)) reverse(*u, axes), reverse_extent(*u, dims, axes);
  else if (auto* r = std::get_if<RectilinearGrid>(&parts.mesh)) reverse(*r, axes), reverse_extent(*r, dims, axes);
  else {
    auto& c = std::get<CurvilinearGrid>(parts.mesh);
    c.points.xyz = gather(c.points.xyz, points);
    reverse_extent(c, dims, axes);
  }
}

void ascend_amr(DatasetParts& parts) {
  auto* g = std::get_if<AmrGrid>(&parts.mesh);
  if (!g || g->levels.empty()) return;
  Axes axes;
  for (int a = 0; a < 3; ++a) axes[size_t(a)] = g->levels[0].spacing[a] < 0;
  if (g->dimension == 2 && axes[2]) {  // nothing lies along it
    for (auto& level : g->levels) level.spacing.z = -level.spacing.z;
    axes[2] = false;
  }
  if (!axes[0] && !axes[1] && !axes[2]) return;
  std::vector<int64_t> points(point_count(parts.mesh)), cells(cell_count(parts.mesh));
  for (size_t a = 0; a < 3; ++a) {
    if (!axes[a]) continue;
    // Cell i of a level becomes n - 1 - i, where n cells reach from the origin to the far end of all patches.
    long long ratio = 1, far = 0;
    for (size_t l = 0; l < g->levels.size(); ++l) {
      if (l > 0) ratio *= std::max(g->levels[l].ratio[a], 1);
      for (const auto& patch : g->levels[l].patches) far = std::max(far, (patch.hi[a] + ratio) / ratio);
    }
    g->origin[int(a)] += g->levels[0].spacing[int(a)] * double(far);
    ratio = 1;
    for (size_t l = 0; l < g->levels.size(); ++l) {
      if (l > 0) ratio *= std::max(g->levels[l].ratio[a], 1);
      g->levels[l].spacing[int(a)] = -g->levels[l].spacing[int(a)];
      for (auto& patch : g->levels[l].patches) {
        const long long lo = patch.lo[a], last = far * ratio - 1;
        patch.lo[a] = last - patch.hi[a], patch.hi[a] = last - lo;
      }
    }
  }
  for (const auto& level : g->levels)
    for (const auto& patch : level.patches) {
      const Dims n = patch.cells();
      reversed_ids(n, axes, patch.cell_offset, cells);
      reversed_ids({n[0] + 1, n[1] + 1, g->dimension == 3 ? n[2] + 1 : 1}, axes, patch.point_offset, points);
    }
  carry(parts, points, cells);
}

}  // namespace sg
