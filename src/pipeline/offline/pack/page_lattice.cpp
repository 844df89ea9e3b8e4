// SPDX-License-Identifier: Apache-2.0
#include "pipeline/offline/pack/page_lattice.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "filter/probe/resample.h"
#include "render/volume/sources/item_checks.h"
#include "render/volume/sources/lattice/lattice_volume.h"

namespace sg::offline {

namespace {

constexpr size_t most_samples = 1024;  // along an axis, of what every browser takes as a texture

struct Share {
  size_t index;
  float weight;
};

// Of each new sample the old ones in its part of the axis.
std::vector<std::vector<Share>> shares_along(size_t from, size_t to) {
  std::vector<std::vector<Share>> all(to);
  const double width = double(from) / double(to);
  for (size_t j = 0; j < to; ++j) {
    const double lo = double(j) * width, hi = lo + width;
    for (size_t i = size_t(lo); i < from && double(i) < hi - 1e-9; ++i) {
      const double part = std::min(hi, double(i + 1)) - std::max(lo, double(i));
      if (part > 1e-9) all[j].push_back({i, float(part / width)});
    }
  }
  return all;
}

std::vector<float> nearest_samples(const std::vector<float>& values, std::array<size_t, 3> from, std::array<size_t, 3> to) {
  std::vector<float> out(to[0] * to[1] * to[2]);
  const auto at = [&](size_t j, size_t a) { return std::min(from[a] - 1, size_t((double(j) + 0.5) * double(from[a]) / double(to[a]))); };
  parallel_for(to[2], 1, [&](size_t k, size_t) {
    for (size_t j = 0; j < to[1]; ++j)
      for (size_t i = 0; i < to[0]; ++i) out[i + to[0] * (j + to[1] * k)] = values[at(i, 0) + from[0] * (at(j, 1) + from[1] * at(k, 2))];
  });
  return out;
}

// u of places between the coordinates of an uneven axis, evenly spread.
void spread_evenly(const volume::Volume& v, PageLattice& out) {
  const std::array<size_t, 3> n = out.samples;
  std::vector<float> even(out.values.size());
  std::vector<Share> below[3];
  for (size_t a = 0; a < 3; ++a) {
    const std::vector<double>& c = v.coordinates[a];
    for (size_t i = 0; i < n[a]; ++i) {
      const double u = v.u(int(a), c.front() + (c.back() - c.front()) * double(i) / double(n[a] - 1));
      const size_t cell = std::min(size_t(u), n[a] - 2);
      below[a].push_back({cell, float(u - double(cell))});
    }
  }
  parallel_for(n[2], 1, [&](size_t k, size_t) {
    for (size_t j = 0; j < n[1]; ++j)
      for (size_t i = 0; i < n[0]; ++i) {
        float sum = 0;
        for (size_t corner = 0; corner < 8; ++corner) {
          const size_t at[3] = {i, j, k};
          size_t index = 0, step = 1;
          float weight = 1;
          for (size_t a = 0; a < 3; ++a) {
            const Share s = below[a][at[a]];
            const size_t high = corner >> a & 1;
            index += step * (s.index + high), step *= n[a], weight *= high ? s.weight : 1 - s.weight;
          }
          if (weight > 0) sum += weight * out.values[index];
        }
        even[i + n[0] * (j + n[1] * k)] = sum;
      }
  });
  out.values = std::move(even);
}

// A lattice over the box of any other mesh.
VolumeItem on_lattice(const VolumeItem& item, PageLattice& out, Context& context) {
  const Field& field = volume::field_of(item);
  ResampleParams params;
  params.size = std::clamp<int64_t>(int64_t(1.5 * std::cbrt(double(item.data->cell_count()))), 64, 256);
  DatasetParts parts = item.data->parts();
  FieldSet one;
  for (const Field& f : parts.fields)  // it, and what tells of cells that are not there
    if (&f == &field || f.array.raw() == item.data->cell_ghost().raw() || f.array.raw() == item.data->point_ghost().raw()) one.add(f);
  if (!one.find(field.name, field.association)) one.add(field);
  parts.fields = one;
  VolumeItem even = item;
  even.data = resample(make_dataset(std::move(parts)), params, context);
  even.association = Association::point;
  const auto& dims = even.data->as<UniformGrid>()->dims;
  out.note = fmt::format("a volume of {} cells was sampled at {}x{}x{} points", item.data->cell_count(), dims[0], dims[1], dims[2]);
  return even;
}

}  // namespace

std::vector<float> box_means(const std::vector<float>& values, std::array<size_t, 3> from, std::array<size_t, 3> to, bool labels) {
  if (labels) return nearest_samples(values, from, to);
  const auto x = shares_along(from[0], to[0]), y = shares_along(from[1], to[1]), z = shares_along(from[2], to[2]);
  std::vector<float> out(to[0] * to[1] * to[2]);
  parallel_for(to[2], 1, [&](size_t k, size_t) {
    std::vector<float> sum(to[0] * to[1]), weight(to[0] * to[1]), row(from[0]), row_weight(from[0]);
    for (const Share& sz : z[k])
      for (size_t j = 0; j < to[1]; ++j) {
        std::fill(row.begin(), row.end(), 0.0f), std::fill(row_weight.begin(), row_weight.end(), 0.0f);
        for (const Share& sy : y[j]) {
          const float* in = &values[from[0] * (sy.index + from[1] * sz.index)];
          const float w = sy.weight * sz.weight;
          for (size_t i = 0; i < from[0]; ++i)
            if (in[i] == in[i]) row[i] += w * in[i], row_weight[i] += w;
        }
        for (size_t i = 0; i < to[0]; ++i)
          for (const Share& sx : x[i])
            sum[i + to[0] * j] += sx.weight * row[sx.index], weight[i + to[0] * j] += sx.weight * row_weight[sx.index];
      }
    for (size_t i = 0; i < sum.size(); ++i) out[k * sum.size() + i] = weight[i] >= 0.499f ? sum[i] / weight[i] : NAN;
  });
  return out;
}

PageLattice page_lattice(const VolumeItem& given, double share, Context& context) {
  PageLattice out;
  VolumeItem item = given;
  if (!item.data->as<UniformGrid>() && !item.data->as<RectilinearGrid>()) item = on_lattice(given, out, context);
  item.sampling.step = 0;
  item.mode = RayFunction::maximum;  // without what only skips
  item.light = {};                   // which that has none of
  item.levels.clear();
  const volume::Volume v = volume::prepare(item, 1, {});
  const double diagonal = std::max(given.data->bounds().diagonal(), v.edge);
  out.unit = given.unit_distance > 0 ? given.unit_distance : 0.01 * diagonal;
  out.range = given.data->range(volume::field_of(given), given.component);
  if (!(v.hi.x > v.lo.x && v.hi.y > v.lo.y && v.hi.z > v.lo.z)) return out;
  out.samples = out.dims = v.voxels.dims, out.base = double(v.base), out.cells = v.dual, out.edge = v.edge;
  const Array values = v.voxels.array.converted(ElementType::f32);
  const auto* raw = reinterpret_cast<const float*>(values.raw());
  out.values.assign(raw, raw + values.count());
  for (float& x : out.values)
    if (!std::isfinite(x)) x = NAN;
  out.hidden = v.hidden();

  // q -> u
  out.origin = v.origin, out.to_u = v.to_q, out.lo = v.lo, out.hi = v.hi;
  if (!v.affine) {
    spread_evenly(v, out);
    Vec3 shift;
    for (int a = 0; a < 3; ++a) {
      const std::vector<double>& c = v.coordinates[a];
      const double per = double(c.size() - 1) / (c.back() - c.front());
      for (int k = 0; k < 3; ++k) out.to_u.m[a][k] *= per;
      out.lo[a] = (v.lo[a] - c.front()) * per, out.hi[a] = (v.hi[a] - c.front()) * per, shift[a] = c.front() * per;
    }
    out.origin += inverse(out.to_u) * shift;
    out.note = "a volume on uneven axes was sampled evenly";
  }
  std::array<size_t, 3> to = out.dims;
  for (size_t& n : to) n = std::min(most_samples, std::max<size_t>(2, size_t(std::lround(double(n) * share))));
  if (to != out.dims) {
    const std::array<size_t, 3> from = out.dims;
    out.values = box_means(out.values, from, to, !given.color.labels.empty());
    if (!out.hidden.empty()) {
      std::vector<uint8_t> hidden((to[0] - 1) * (to[1] - 1) * (to[2] - 1));
      const auto at = [&](size_t i, size_t a) {
        return std::min(from[a] - 2, size_t((double(i) + 0.5) * double(from[a] - 1) / double(to[a] - 1)));
      };
      for (size_t k = 0, n = 0; k + 1 < to[2]; ++k)
        for (size_t j = 0; j + 1 < to[1]; ++j)
          for (size_t i = 0; i + 1 < to[0]; ++i)
            hidden[n++] = out.hidden[at(i, 0) + (from[0] - 1) * (at(j, 1) + (from[1] - 1) * at(k, 2))] ? 1 : 0;
      out.hidden = std::move(hidden);
    }
    out.dims = to;
  }
  return out;
}

}  // namespace sg::offline
