// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <unordered_map>

#include "base/text/text.h"
#include "data/fields/axis_notes.h"
#include "io/plugins/netcdf/cf.h"

namespace sg::nc {

namespace {

std::vector<double> values_of(const NcFile& file, const Variable& v) {
  std::vector<size_t> start(v.shape.size()), count = v.shape;
  // Positions that change in time (WRF) are those of the first step.
  if (v.shape.size() > 2) std::fill(count.begin(), count.end() - 2, size_t(1));
  const Array a = decoded(file, v, file.read(v, start, count, v.element())).converted(ElementType::f64);
  const double* p = a.view<double>().data;
  return {p, p + a.count()};
}

struct Axis {
  std::vector<double> at{0};
  bool single = true;  // stored as f32
};

// Coordinates along a dimension: its variable's numbers, or 0, 1, 2, ... when it has none that will do.
Axis axis_of(const NcFile& file, const CfModel& model, int dim, CfMesh& out, Context& context) {
  const Dimension& d = file.dimensions()[size_t(dim)];
  Axis axis;
  if (const Variable* v = model.coordinate(dim)) {
    axis.at = values_of(file, *v);
    axis.single = v->element() == ElementType::f32;
    bool good = true;
    for (size_t i = 0; i < axis.at.size(); ++i) {
      good = good && std::isfinite(axis.at[i]);
      if (i > 0) good = good && (axis.at[i] - axis.at[i - 1]) * (axis.at[1] - axis.at[0]) > 0;
    }
    if (good) {
      out.used.push_back(v);
      return axis;
    }
    if (axis.at.size() > 1)
      context.warn(fmt::format("{}: variable {} is not monotone; its axis is numbered 0, 1, 2, ...", file.path(), v->name));
  }
  axis.at.resize(d.length);
  axis.single = false;
  for (size_t i = 0; i < d.length; ++i) axis.at[i] = double(i);
  return axis;
}

bool regular(const std::vector<double>& at) {
  if (at.size() < 2) return true;
  const double h = (at.back() - at[0]) / double(at.size() - 1);
  for (size_t i = 0; i < at.size(); ++i)
    if (!(std::fabs(at[i] - (at[0] + double(i) * h)) <= 1e-4 * std::fabs(h))) return false;
  return h > 0;
}

Array axis_array(const Axis& axis) {
  if (!axis.single) return Array::from_vector(axis.at);
  return Array::from_vector(std::vector<float>(axis.at.begin(), axis.at.end()));
}

void note_axis(const NcFile& file, const Variable& v, int axis, CfMesh& out) {
  sg::note_axis(out.notes, axis, {v.name, file.text(&v, "units"), file.text(&v, "positive")});
}

// Which dimension goes along x, y, z: as their letters indicate; those without one take what is left, the fastest first.
std::vector<int> axis_order(const CfModel& model, const CfGrid& grid) {
  std::vector<int> order(3, -1), rest;
  for (size_t k = grid.dims.size(); k-- > 0;) {
    const char l = model.letter(grid.dims[k]);
    if (l >= 'x' && l <= 'z' && order[size_t(l - 'x')] < 0) order[size_t(l - 'x')] = int(k);
    else rest.push_back(int(k));
  }
  for (const int k : rest)
    for (int& o : order)
      if (o < 0) {
        o = k;
        break;
      }
  return order;
}

void lattice(const NcFile& file, const CfModel& model, const CfGrid& grid, CfMesh& out, Context& context) {
  out.order = axis_order(model, grid);
  Axis axes[3];
  bool uniform = true;
  for (size_t a = 0; a < 3; ++a) {
    if (out.order[a] < 0) continue;
    const int dim = grid.dims[size_t(out.order[a])];
    axes[a] = axis_of(file, model, dim, out, context);
    uniform = uniform && regular(axes[a].at);
    if (const Variable* v = model.coordinate(dim)) note_axis(file, *v, int(a), out);
  }
  if (uniform) {
    UniformGrid g;
    for (size_t a = 0; a < 3; ++a) {
      const auto& at = axes[a].at;
      g.dims[a] = at.size();
      g.origin[int(a)] = at[0];
      if (at.size() > 1) g.spacing[int(a)] = (at.back() - at[0]) / double(at.size() - 1);
    }
    out.mesh = g;
  } else {
    RectilinearGrid g;
    g.x = axis_array(axes[0]), g.y = axis_array(axes[1]), g.z = axis_array(axes[2]);
    out.mesh = std::move(g);
  }
}

// Longitude and latitude of each point of the two fastest dimensions; the third, if any, has coordinates of its own.
void curvilinear(const NcFile& file, const CfModel& model, const CfGrid& grid, CfMesh& out, Context& context) {
  const std::vector<double> lon = values_of(file, *grid.lon), lat = values_of(file, *grid.lat);
  const size_t n = grid.dims.size(), nx = file.dimensions()[size_t(grid.dims[n - 1])].length,
               ny = file.dimensions()[size_t(grid.dims[n - 2])].length;
  if (lon.size() != nx * ny || lat.size() != nx * ny)
    file.fail(fmt::format("has {} and {} positions for {} x {} points", lon.size(), lat.size(), nx, ny), grid.lon->name);
  out.order = {int(n) - 1, int(n) - 2, n > 2 ? int(n) - 3 : -1};
  Axis z;
  if (n > 2) z = axis_of(file, model, grid.dims[n - 3], out, context);
  double* xyz = nullptr;
  CurvilinearGrid g;
  g.dims = {nx, ny, z.at.size()};
  uint64_t points = 0;
  if (!__builtin_mul_overflow(nx * ny, z.at.size(), &points) && points > (uint64_t(1) << 40)) file.fail("has too many points");
  g.points.xyz = Array::make<double>(points, 3, &xyz);
  uint8_t* hidden = nullptr;
  Array ghost = Array::make<uint8_t>(points, 1, &hidden);
  bool any = false;
  for (size_t k = 0; k < z.at.size(); ++k) {
    double last[2] = {0, 0};  // points without a position lie on the one before, and are hidden
    for (size_t i = 0; i < nx * ny; ++i) {
      const bool good = std::isfinite(lon[i]) && std::isfinite(lat[i]);
      if (good) last[0] = lon[i], last[1] = lat[i];
      any = any || !good;
      const size_t p = i + nx * ny * k;
      hidden[p] = good ? 0 : ghost_hidden_point;
      xyz[3 * p] = last[0], xyz[3 * p + 1] = last[1], xyz[3 * p + 2] = z.at[k];
    }
  }
  if (any) {
    out.point_ghost = ghost;
    const size_t cx = std::max<size_t>(nx - 1, 1), cy = std::max<size_t>(ny - 1, 1), cz = std::max<size_t>(z.at.size() - 1, 1);
    uint8_t* cell = nullptr;
    out.cell_ghost = Array::make<uint8_t>(cx * cy * cz, 1, &cell);
    for (size_t c = 0; c < cx * cy * cz; ++c) {
      const size_t i = c % cx, j = c / cx % cy, i1 = std::min(i + 1, nx - 1), j1 = std::min(j + 1, ny - 1);
      cell[c] = hidden[i + nx * j] | hidden[i1 + nx * j] | hidden[i + nx * j1] | hidden[i1 + nx * j1] ? ghost_hidden_cell : 0;
    }
  }
  out.used.push_back(grid.lon), out.used.push_back(grid.lat);
  note_axis(file, *grid.lon, 0, out), note_axis(file, *grid.lat, 1, out);
  if (n > 2)
    if (const Variable* v = model.coordinate(grid.dims[n - 3])) note_axis(file, *v, 2, out);
  out.mesh = std::move(g);
}

// Places in a list: polygons where both coordinates have bounds, else points. Equal corners become one point.
void listed(const NcFile& file, const CfGrid& grid, CfMesh& out) {
  const Variable* bounds[2] = {file.find(file.text(grid.lon, "bounds")), file.find(file.text(grid.lat, "bounds"))};
  out.used = {grid.lon, grid.lat};
  out.order = {0, -1, -1};
  note_axis(file, *grid.lon, 0, out), note_axis(file, *grid.lat, 1, out);
  const size_t n = grid.points;
  for (const Variable* b : bounds)
    if (!b || !b->is_number() || b->shape.size() != 2 || b->shape[0] != n || b->shape[1] < 3 || b->shape != bounds[0]->shape) {
      const std::vector<double> lon = values_of(file, *grid.lon), lat = values_of(file, *grid.lat);
      if (lon.size() != n || lat.size() != n) file.fail(fmt::format("must hold {} positions", n), grid.lon->name);
      double* xyz = nullptr;
      PointCloud cloud;
      cloud.points.xyz = Array::make<double>(n, 3, &xyz);
      for (size_t i = 0; i < n; ++i) xyz[3 * i] = lon[i], xyz[3 * i + 1] = lat[i], xyz[3 * i + 2] = 0;
      out.mesh = std::move(cloud);
      return;
    }
  const std::vector<double> x = values_of(file, *bounds[0]), y = values_of(file, *bounds[1]);
  const size_t corners = bounds[0]->shape[1];
  struct Hash {
    size_t operator()(const std::array<double, 2>& p) const {
      uint64_t a = 0, b = 0;
      std::memcpy(&a, &p[0], 8), std::memcpy(&b, &p[1], 8);
      return size_t((a * 0x9e3779b97f4a7c15ull ^ b) * 0xff51afd7ed558ccdull >> 7);
    }
  };
  std::unordered_map<std::array<double, 2>, int64_t, Hash> known;
  std::vector<double> xyz;
  std::vector<int64_t> ids, offsets{0};
  for (size_t c = 0; c < n; ++c) {
    const size_t first = ids.size();
    for (size_t k = 0; k < corners; ++k) {
      const std::array<double, 2> p = {x[c * corners + k] + 0.0, y[c * corners + k] + 0.0};
      if (!std::isfinite(p[0]) || !std::isfinite(p[1])) continue;  // polygons of fewer corners are filled up
      const auto [at, fresh] = known.emplace(p, int64_t(known.size()));
      if (fresh) xyz.insert(xyz.end(), {p[0], p[1], 0.0});
      if (ids.size() == first || ids.back() != at->second) ids.push_back(at->second);
    }
    if (ids.size() > first + 1 && ids.back() == ids[first]) ids.pop_back();
    offsets.push_back(int64_t(ids.size()));
  }
  UnstructuredMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.cells.connectivity = Array::from_vector(std::move(ids));
  mesh.cells.offsets = Array::from_vector(std::move(offsets));
  mesh.single_type = CellType::polygon;
  out.mesh = std::move(mesh);
  out.association = Association::cell;
  out.used.push_back(bounds[0]), out.used.push_back(bounds[1]);
}

}  // namespace

CfMesh cf_mesh(const NcFile& file, const CfModel& model, const CfGrid& grid, Context& context) {
  CfMesh out;
  const size_t long_dims =
      size_t(std::count_if(grid.dims.begin(), grid.dims.end(), [&](int d) { return file.dimensions()[size_t(d)].length > 1; }));
  if (grid.lon && long_dims == 1 && grid.dims.size() == 1) listed(file, grid, out);
  else if (grid.lon) curvilinear(file, model, grid, out, context);
  else lattice(file, model, grid, out, context);
  return out;
}

}  // namespace sg::nc
