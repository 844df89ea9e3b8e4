// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/lines/tractography.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/point_positions.h"
#include "data/lattice.h"
#include "filter/tensor/lines/line_sections.h"
#include "filter/tensor/tensor_measures.h"
#include "filter/tensor/tensor_shape.h"

namespace sg {

namespace {

double fa_of(const Eigen3& e, int dimension) { return dimension == 2 ? fractional_anisotropy_2d(e.value) : fractional_anisotropy(e.value); }

// The points of the data that lie on the stride and in the mask.
std::vector<Vec3> points_as_seeds(const DatasetPtr& in, const TractographyParams& p) {
  const Array xyz = point_positions(in->mesh());
  Array mask;
  if (!p.mask.empty()) mask = in->fields().require(p.mask.name, Association::point).array;
  const bool grid = is_lattice(in->mesh());
  const auto dims = lattice_dims(in->mesh());
  const size_t stride = size_t(p.stride);
  std::vector<Vec3> r;
  for (size_t i = 0; i < xyz.count(); ++i) {
    const size_t at[3] = {i % dims[0], i / dims[0] % dims[1], i / (dims[0] * dims[1])};
    if (grid ? at[0] % stride || at[1] % stride || at[2] % stride : i % stride != 0) continue;
    if (!mask.empty() && !(mask.get(i) > 0)) continue;
    r.push_back({xyz.get(i, 0), xyz.get(i, 1), xyz.get(i, 2)});
  }
  return r;
}

std::vector<Vec3> seeds_for(const DatasetPtr& in, const DatasetPtr& second, const TractographyParams& p) {
  if (!p.seeds.empty()) return listed_places(p.seeds, "tractography");
  if (!second) return points_as_seeds(in, p);
  const Array xyz = point_positions(second->mesh());
  std::vector<Vec3> r(xyz.count());
  for (size_t i = 0; i < r.size(); ++i) r[i] = {xyz.get(i, 0), xyz.get(i, 1), xyz.get(i, 2)};
  return r;
}

std::vector<Vec3> anisotropic(const std::vector<Vec3>& seeds, const TensorSampler& sampler, double least, Context& ctx) {
  std::vector<uint8_t> good(seeds.size());
  parallel_for(
      seeds.size(), 256,
      [&](size_t begin, size_t end) {
        TensorCursor cursor(sampler);
        Eigen3 e;
        for (size_t i = begin; i < end; ++i) good[i] = cursor.eigen(seeds[i], e) && fa_of(e, sampler.dimension()) >= least;
      },
      &ctx);
  std::vector<Vec3> r;
  for (size_t i = 0; i < seeds.size(); ++i)
    if (good[i]) r.push_back(seeds[i]);
  return r;
}

// Only the lines that are long enough.
TensorLines long_ones(TensorLines all, double least) {
  TensorLines r;
  for (size_t l = 0; l < all.lines(); ++l) {
    const size_t b = all.begin[l], e = all.begin[l + 1];
    if (e - b < 2 || all.arc[e - 1] - all.arc[b] < least) continue;
    auto take = [&](auto& to, const auto& from) { to.insert(to.end(), from.begin() + ptrdiff_t(b), from.begin() + ptrdiff_t(e)); };
    take(r.points, all.points), take(r.tangent, all.tangent), take(r.eigen, all.eigen), take(r.arc, all.arc);
    r.begin.push_back(r.points.size());
    r.seed.push_back(all.seed[l]), r.stop_forward.push_back(all.stop_forward[l]), r.stop_backward.push_back(all.stop_backward[l]);
  }
  return r;
}

FieldSet line_fields(const TensorLines& lines, int dimension, const std::string& unit) {
  const size_t n = lines.points.size();
  uint8_t* rgb = nullptr;
  float *fa = nullptr, *md = nullptr, *length = nullptr;
  const Array colors = Array::make<uint8_t>(n, 3, &rgb), fas = Array::make<float>(n, 1, &fa), mds = Array::make<float>(n, 1, &md),
              lengths = Array::make<float>(n, 1, &length);
  std::vector<float> whole, mean_fa;
  std::vector<int64_t> number;
  for (size_t l = 0; l < lines.lines(); ++l) {
    double sum = 0, at = 0;
    for (size_t i = lines.begin[l]; i < lines.begin[l + 1]; ++i) {
      direction_color(lines.tangent[i], 1, rgb + 3 * i);
      const double* v = lines.eigen[i].value;
      at = lines.arc[i] - lines.arc[lines.begin[l]];
      fa[i] = float(fa_of(lines.eigen[i], dimension)), md[i] = float(dimension == 2 ? (v[0] + v[1]) / 2 : mean_of(v)),
      length[i] = float(at);
      sum += double(fa[i]);
    }
    whole.push_back(float(at)), mean_fa.push_back(float(sum / double(lines.begin[l + 1] - lines.begin[l])));
    number.push_back(int64_t(l));
  }
  FieldSet f;
  f.add({"direction", Association::point, colors, "", Role::colors});
  f.add({"FA", Association::point, fas, "", Role::none});
  f.add({"MD", Association::point, mds, unit, Role::none});
  f.add({"length", Association::point, lengths, "", Role::none});
  f.add({"line length", Association::cell, Array::from_vector(std::move(whole)), "", Role::none});
  f.add({"mean FA", Association::cell, Array::from_vector(std::move(mean_fa)), "", Role::none});
  f.add({"line", Association::cell, Array::from_vector(std::move(number)), "", Role::labels});
  return f;
}

}  // namespace

void describe(Schema& s, TractographyParams& p) {
  describe_tensors(s, p.tensors);
  s("seeds", p.seeds, "Seed points x,y,z,x,y,z,...; default: the points of a second input, else every point of the data.");
  s("mask", p.mask, "Point field that is above 0 where lines may start.").takes(fields::on_points);
  s("stride", p.stride, "Start lines at every n-th point along each axis.").at_least(1);
  s("seed_fa", p.seed_fa, "Start lines only where the fractional anisotropy is at least this.").range(0, 1);
  s("min_fa", p.min_fa, "End lines where the fractional anisotropy falls below this.").range(0, 1);
  s("max_angle", p.max_angle, "End lines where they turn by more than this within one cell length.").range(0, 180).unit("deg");
  s("step", p.step, "Length of a step.").positive().unit("cells");
  s("min_length", p.min_length, "Leave out shorter lines.").at_least(0).unit("length");
  s("max_length", p.max_length, "Maximum length of each half of a line; default: four times the diagonal of the data.")
      .positive()
      .unit("length");
  s("interpolation", p.interpolation, "Interpolate the components of the tensor, or its logarithm (positive tensors only).");
}

DatasetPtr tractography(const DatasetPtr& in, const DatasetPtr& second, const TractographyParams& p, Context& ctx) {
  const TensorSampler sampler(in, p.tensors, p.interpolation, "tractography", ctx);
  if (!sampler.logarithmic()) {
    size_t negative = 0;
    for (size_t i = 0; i < sampler.tensors().d.size(); ++i) {
      const Eigen3 e = sampler.tensors().eigen(i);
      negative += e.value[sampler.tensors().dimension - 1] < -1e-6 * std::abs(e.value[0]);
    }
    warn_negative(negative, sampler.tensors().d.size(), sampler.tensors(), "tractography", "kept", ctx);
  }
  const std::vector<Vec3> all = seeds_for(in, second, p), seeds = anisotropic(all, sampler, p.seed_fa, ctx);
  TensorLineOptions o;
  o.step = p.step, o.min_fa = p.min_fa, o.min_gap = 0;
  o.max_angle = std::min(180.0, p.max_angle * std::min(1.0, p.step));
  o.max_length = p.max_length.value_or(4 * in->bounds().diagonal());
  TensorLines lines = trace_tensor_lines(sampler, seeds, o, ctx);
  const size_t traced = lines.lines();
  lines = long_ones(std::move(lines), p.min_length);
  ctx.info(fmt::format("tractography: {} seeds, {} with FA of {} or more; {} lines, {} of them long enough", all.size(), seeds.size(),
                       p.seed_fa, traced, lines.lines()));
  DatasetParts parts;
  parts.mesh = lines_as_mesh(lines);
  parts.fields = line_fields(lines, sampler.dimension(), sampler.tensors().field.unit);
  parts.time = in->time();
  return make_dataset(std::move(parts));
}

}  // namespace sg
