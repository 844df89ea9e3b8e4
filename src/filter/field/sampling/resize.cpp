// SPDX-License-Identifier: Apache-2.0
#include "filter/field/sampling/resize.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "data/field_ops.h"
#include "data/lattice.h"
#include "data/memory/memory_budget.h"
#include "filter/field/sampling/reconstruction.h"
#include "filter/field/sampling/separable.h"
#include "filter/segment/samples.h"

namespace sg {

namespace {

using Dims = std::array<size_t, 3>;
constexpr size_t samples_per_chunk = 1 << 16;

/// Places of `to` results among `from` samples.
struct AxisPlaces {
  size_t from, to;
  bool cells;
  double operator()(size_t i) const {
    if (cells) return (double(i) + 0.5) * double(from) / double(to) - 0.5;
    return to == 1 ? 0 : double(i) * double(from - 1) / double(to - 1);
  }
  /// Samples per result.
  double step() const { return cells ? double(from) / double(to) : to == 1 ? 1 : double(from - 1) / double(to - 1); }
  size_t nearest(size_t i) const { return size_t(std::clamp<double>(std::floor((*this)(i) + 0.5), 0, double(from - 1))); }
};

/// Adds the share w of sample i, which may lie beyond the border: s[-i] = 2 s[0] - s[i].
void add_share(std::vector<double>& shares, long i, double w) {
  const long last = long(shares.size()) - 1;
  if (last == 0) i = 0;
  if (i >= 0 && i <= last) {
    shares[size_t(i)] += w;
    return;
  }
  add_share(shares, i < 0 ? 0 : last, 2 * w);
  add_share(shares, i < 0 ? -i : 2 * last - i, -w);
}

std::vector<AxisSum> kernel_sums(const AxisPlaces& places, Kernel kernel) {
  const double wide = std::max(1.0, places.step());
  const int radius = traits(kernel).radius;
  std::vector<AxisSum> sums(places.to);
  std::vector<double> shares(places.from);
  for (size_t i = 0; i < places.to; ++i) {
    const double u = places(i);
    std::fill(shares.begin(), shares.end(), 0.0);
    const long first = long(std::floor(u - radius * wide)), last = long(std::ceil(u + radius * wide));
    double sum = 0;
    for (long j = first; j <= last; ++j) sum += kernel_value(kernel, (u - double(j)) / wide);
    for (long j = first; j <= last; ++j)
      if (const double w = kernel_value(kernel, (u - double(j)) / wide); w != 0) add_share(shares, j, w / sum);
    size_t from = 0, to = shares.size();
    while (from + 1 < to && shares[from] == 0) ++from;
    while (to > from + 1 && shares[to - 1] == 0) --to;
    sums[i].first = from, sums[i].weight.assign(shares.begin() + long(from), shares.begin() + long(to));
  }
  return sums;
}

std::array<AxisPlaces, 3> axis_places(const Dims& from, const Dims& to, bool cells) {
  std::array<AxisPlaces, 3> p{};
  for (size_t a = 0; a < 3; ++a) {
    p[a] = {from[a], to[a], cells};
    if (cells) p[a].from = std::max<size_t>(from[a], 2) - 1, p[a].to = std::max<size_t>(to[a], 2) - 1;
  }
  return p;
}

std::vector<size_t> nearest_ids(const std::array<AxisPlaces, 3>& p) {
  std::vector<size_t> ids(p[0].to * p[1].to * p[2].to);
  parallel_for(p[1].to * p[2].to, 64, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const size_t j = p[1].nearest(row % p[1].to), k = p[2].nearest(row / p[1].to);
      for (size_t i = 0; i < p[0].to; ++i) ids[row * p[0].to + i] = p[0].nearest(i) + p[0].from * (j + p[1].from * k);
    }
  });
  return ids;
}

Array picked(const Array& a, const std::vector<size_t>& ids) {
  std::byte* to = nullptr;
  Array r = Array::make_raw(a.type(), ids.size(), a.components(), &to);
  const Array from = a.made_packed();
  const size_t size = element_size(a.type()) * size_t(a.components());
  parallel_for(ids.size(), samples_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) std::copy_n(from.raw() + ids[i] * size, size, to + i * size);
  });
  return r;
}

/// One component by the kernel, into every `stride`-th number of `out`.
void resize_component(const Array& a, const std::vector<uint8_t>& state, const std::array<AxisPlaces, 3>& p, const std::vector<size_t>& ids,
                      Kernel kernel, double* out, size_t stride, const Context& context) {
  const Range range = field_stats(a).range[0];
  const double base = range.empty() ? 0 : 0.5 * range.lo + 0.5 * range.hi;
  Dims dims{p[0].from, p[1].from, p[2].from};
  std::vector<float> value(a.count()), next;
  dispatch(a, [&](auto v) {
    parallel_for(v.count, samples_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) value[i] = !state.empty() && state[i] == sample_hidden ? NAN : float(double(v[i]) - base);
    });
  });
  double widest = 1;
  for (const AxisPlaces& axis : p) widest = std::max(widest, axis.step());
  const int reach = int(std::min(64.0, std::ceil(traits(kernel).radius * widest))) + 1;
  const std::vector<uint8_t> missing = fill_holes(value.data(), dims, traits(kernel).prefilter ? std::max(reach, 8) : reach, &context);
  for (size_t axis = 0; axis < 3; ++axis) {
    if (p[axis].from == 1 && p[axis].to == 1) continue;
    if (traits(kernel).prefilter && p[axis].step() <= 1) bspline_coefficients_along(axis, value.data(), dims, &context);
    Dims after = dims;
    after[axis] = p[axis].to;
    next.resize(after[0] * after[1] * after[2]);
    sum_along(axis, kernel_sums(p[axis], kernel), value.data(), dims, next.data(), &context);
    value.swap(next), dims = after;
  }
  for (size_t i = 0; i < ids.size(); ++i) out[i * stride] = !missing.empty() && missing[ids[i]] ? NAN : base + double(value[i]);
}

Mesh resized_mesh(const Mesh& mesh, const Dims& to) {
  if (const auto* u = std::get_if<UniformGrid>(&mesh)) {
    UniformGrid g = *u;
    for (size_t a = 0; a < 3; ++a)
      if (to[a] > 1) g.spacing[int(a)] *= double(u->dims[a] - 1) / double(to[a] - 1);
    g.dims = to, g.extent_start = {0, 0, 0};
    return g;
  }
  RectilinearGrid g = std::get<RectilinearGrid>(mesh);
  Array* axes[3] = {&g.x, &g.y, &g.z};
  for (size_t a = 0; a < 3; ++a) {
    const AxisPlaces place{axes[a]->count(), to[a], false};
    std::vector<double> at;
    for (size_t i = 0; i < to[a]; ++i) {
      const double u = place(i);
      const size_t j = std::min(size_t(u), place.from - 1), k = std::min(j + 1, place.from - 1);
      at.push_back(axes[a]->get(j) + (u - double(j)) * (axes[a]->get(k) - axes[a]->get(j)));
    }
    *axes[a] = Array::from_vector(std::move(at));
  }
  g.extent_start = {0, 0, 0};
  return g;
}

Dims wanted_dims(const Dims& from, const std::vector<int64_t>& wanted) {
  if (wanted.size() != 1 && wanted.size() != 3)
    fail_usage(fmt::format("needs one or three numbers, not {}", wanted.size()), "resize dims", "write e.g. 256 or 256,256,100");
  Dims to = from;
  const size_t longest = *std::max_element(from.begin(), from.end());
  for (size_t a = 0; a < 3; ++a) {
    const int64_t n = wanted[wanted.size() == 3 ? a : 0];
    if (n < 1 || n > 1 << 20) fail_usage(fmt::format("{} is not a valid number of points", n), "resize dims", "give 2 to 1048576");
    if (from[a] == 1 && wanted.size() == 3 && n != 1)
      fail_usage(fmt::format("axis {} has one point and cannot be given {}", "xyz"[a], n), "resize dims", "give 1 for that axis");
    if (from[a] == 1) continue;
    if (n < 2) fail_usage(fmt::format("axis {} would lose its extent", "xyz"[a]), "resize dims", "give 2 or more, or use slice");
    to[a] = wanted.size() == 3 ? size_t(n)
                               : std::max<size_t>(2, size_t(std::llround(double(n - 1) * double(from[a] - 1) / double(longest - 1))) + 1);
  }
  if (double(to[0]) * double(to[1]) * double(to[2]) > 1e12)
    fail_usage(fmt::format("{} x {} x {} points exceed any memory", to[0], to[1], to[2]), "resize dims", "give fewer points");
  return to;
}

}  // namespace

void describe(Schema& s, ResizeParams& p) {
  s("dims", p.dims, "Number of points along x, y and z, or one number for the longest axis.").at_least(1);
  s("kernel", p.kernel, "Reconstruction kernel between the samples.");
}

DatasetPtr resize(const DatasetPtr& in, const ResizeParams& p, Context& context) {
  if (!in->as<UniformGrid>() && !in->as<RectilinearGrid>())
    fail_usage(fmt::format("works on uniform and rectilinear grids, not on a {} mesh", in->kind()), "resize", "use resample");
  const Kernel kernel = p.kernel;
  const Dims from = lattice_dims(in->mesh()), to = wanted_dims(from, p.dims);
  double bytes = 40;  // a point: where it comes from
  for (const Field& f : in->fields()) bytes = std::max(bytes, 40 + double(f.components()) * 24);
  need_memory(double(to[0]) * double(to[1]) * double(to[2]) * bytes, fmt::format("{}x{}x{} points", to[0], to[1], to[2]), "resize",
              "give smaller dims");
  DatasetParts out = in->parts();
  out.mesh = resized_mesh(in->mesh(), to);
  out.fields = {};
  for (const Association association : {Association::point, Association::cell}) {
    const std::array<AxisPlaces, 3> places = axis_places(from, to, association == Association::cell);
    const std::vector<size_t> ids = nearest_ids(places);
    const std::vector<uint8_t> state = sample_states(*in, association);
    Array& ghost = association == Association::cell ? out.cell_ghost : out.point_ghost;
    if (!ghost.empty()) ghost = picked(ghost, ids);
    for (const Field& f : in->fields()) {
      context.check();
      if (f.association != association) continue;
      Field r = f;
      if (f.role == Role::labels || f.role == Role::global_ids || kernel == Kernel::nearest) {
        r.array = picked(f.array, ids);
        out.fields.add(std::move(r));
        continue;
      }
      double* values = nullptr;
      const size_t components = size_t(f.components());
      const Array wide = Array::make<double>(ids.size(), f.components(), &values);
      for (size_t c = 0; c < components; ++c)
        resize_component(f.array.component(int(c)), state, places, ids, kernel, values + c, components, context);
      r.array = wide.converted(f.array.type());
      out.fields.add(std::move(r));
    }
  }
  for (const Field& f : in->fields())
    if (f.association == Association::whole) out.fields.add(f);
  return make_dataset(std::move(out));
}

}  // namespace sg
