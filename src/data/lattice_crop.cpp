// SPDX-License-Identifier: Apache-2.0
#include "data/lattice_crop.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "base/parallel.h"
#include "data/lattice.h"

namespace sg {

namespace {

constexpr std::array<size_t, 3> every_point{1, 1, 1};

// Values of one axis: an array of its own.
Array crop_axis(const Array& a, size_t lo, size_t count, size_t stride) {
  return crop_block(a, {a.count(), 1, 1}, {lo, 0, 0}, {count, 1, 1}, {stride, 1, 1});
}

struct Crop {
  std::array<size_t, 3> dims, lo, count, stride;
  Array points(const Array& a) const { return crop_block(a, dims, lo, count, stride); }
  Array cells(const Array& a) const {
    std::array<size_t, 3> cell_dims, cell_lo = lo, cell_count;
    for (size_t i = 0; i < 3; ++i) {
      cell_dims[i] = std::max<size_t>(dims[i], 2) - 1;
      cell_lo[i] = std::min(lo[i], cell_dims[i] - 1);  // a layer at the far end takes the cells before it
      cell_count[i] = std::max<size_t>(count[i], 2) - 1;
    }
    return crop_block(a, cell_dims, cell_lo, cell_count, every_point);
  }
  std::array<long long, 3> start(const std::array<long long, 3>& old) const {
    std::array<long long, 3> r;
    for (size_t i = 0; i < 3; ++i) r[i] = stride == every_point ? old[i] + static_cast<long long>(lo[i]) : 0;
    return r;
  }
};

Mesh crop_mesh(const Mesh& mesh, const Crop& c) {
  if (auto* u = std::get_if<UniformGrid>(&mesh)) {
    UniformGrid g = *u;
    g.origin =
        u->origin + u->direction * Vec3{u->spacing.x * double(c.lo[0]), u->spacing.y * double(c.lo[1]), u->spacing.z * double(c.lo[2])};
    g.spacing = {u->spacing.x * double(c.stride[0]), u->spacing.y * double(c.stride[1]), u->spacing.z * double(c.stride[2])};
    g.dims = c.count;
    g.extent_start = c.start(u->extent_start);
    return g;
  }
  if (auto* r = std::get_if<RectilinearGrid>(&mesh)) {
    RectilinearGrid g = *r;
    g.x = crop_axis(r->x, c.lo[0], c.count[0], c.stride[0]);
    g.y = crop_axis(r->y, c.lo[1], c.count[1], c.stride[1]);
    g.z = crop_axis(r->z, c.lo[2], c.count[2], c.stride[2]);
    g.extent_start = c.start(r->extent_start);
    return g;
  }
  CurvilinearGrid g = std::get<CurvilinearGrid>(mesh);
  g.points.xyz = c.points(g.points.xyz);
  g.dims = c.count;
  g.extent_start = c.start(g.extent_start);
  return g;
}

}  // namespace

Array crop_block(const Array& values, std::array<size_t, 3> dims, std::array<size_t, 3> lo, std::array<size_t, 3> count,
                 std::array<size_t, 3> stride) {
  const Array in = values.made_packed();
  const size_t tuple = size_t(in.components()) * element_size(in.type());
  std::byte* out = nullptr;
  Array result = Array::make_raw(in.type(), count[0] * count[1] * count[2], in.components(), &out);
  parallel_for(count[1] * count[2], std::max<size_t>(1, (size_t(1) << 16) / std::max<size_t>(count[0] * tuple, 1)),
               [&](size_t begin, size_t end) {
                 for (size_t row = begin; row < end; ++row) {
                   const size_t j = lo[1] + (row % count[1]) * stride[1], k = lo[2] + (row / count[1]) * stride[2];
                   const std::byte* from = in.raw() + (lo[0] + dims[0] * (j + dims[1] * k)) * tuple;
                   std::byte* to = out + row * count[0] * tuple;
                   if (stride[0] == 1) std::memcpy(to, from, count[0] * tuple);
                   else
                     for (size_t i = 0; i < count[0]; ++i) std::memcpy(to + i * tuple, from + i * stride[0] * tuple, tuple);
                 }
               });
  return result;
}

DatasetPtr crop_lattice(const Dataset& d, std::array<size_t, 3> lo, std::array<size_t, 3> hi, std::array<size_t, 3> stride) {
  if (!is_lattice(d.mesh())) fail_usage(fmt::format("cropping by indices needs a grid, not a mesh of kind {}", d.kind()), "crop");
  Crop c{lattice_dims(d.mesh()), lo, {}, stride};
  for (size_t i = 0; i < 3; ++i) {
    if (stride[i] == 0) fail_usage("the stride is 0", "crop", "use 1 to keep every point");
    const size_t last = std::min(hi[i], c.dims[i] - 1);
    if (lo[i] > last)
      fail_usage(fmt::format("points {} to {} along axis {} do not exist: the grid has {} points there", lo[i], hi[i], "xyz"[i], c.dims[i]),
                 "crop", fmt::format("0 to {}", c.dims[i] - 1));
    c.count[i] = (last - lo[i]) / stride[i] + 1;
  }
  DatasetParts parts;
  parts.mesh = crop_mesh(d.mesh(), c);
  bool keep_cells = true;
  for (size_t i = 0; i < 3; ++i) keep_cells = keep_cells && (stride[i] == 1 || c.dims[i] == 1);
  size_t dropped = 0;
  for (const Field& f : d.fields()) {
    Field g = f;
    if (f.association == Association::point) g.array = c.points(f.array);
    if (f.association == Association::cell) {
      if (!keep_cells) {
        ++dropped;
        continue;
      }
      g.array = c.cells(f.array);
    }
    parts.fields.add(std::move(g));
  }
  if (!d.point_ghost().empty()) parts.point_ghost = c.points(d.point_ghost());
  if (!d.cell_ghost().empty() && keep_cells) parts.cell_ghost = c.cells(d.cell_ghost());
  parts.notes = d.notes();
  if (dropped) parts.notes.emplace_back("crop", fmt::format("{} cell fields were left out: a stride keeps points, not cells", dropped));
  parts.time = d.time();
  return make_dataset(std::move(parts));
}

}  // namespace sg
