// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/volume/derivatives.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/all_ranks.h"
#include "base/parallel.h"
#include "data/lattice.h"
#include "data/ranks/over_all.h"
#include "filter/field/derivatives/derivatives.h"

namespace sg {

namespace {

SecondDerivatives from_matrix(const Mat3& m) {
  return {float(m.m[0][0]),
          float(m.m[1][1]),
          float(m.m[2][2]),
          float(0.5 * (m.m[0][1] + m.m[1][0])),
          float(0.5 * (m.m[0][2] + m.m[2][0])),
          float(0.5 * (m.m[1][2] + m.m[2][1]))};
}

DerivativeSample sample_of(double value, Vec3 gradient, const SecondDerivatives& h) {
  const Vec3f g(gradient);
  return {float(value), length(g), second_derivative_along(g, h), mean_curvature(g, h)};
}

template <class View>
double number(const View& v, size_t i, int component) {
  if (component >= 0 || v.components == 1) return double(v(i, std::max(component, 0)));
  double sum = 0;
  for (int c = 0; c < v.components; ++c) sum += double(v(i, c)) * double(v(i, c));
  return std::sqrt(sum);
}

// Differences of 27 neighbours in index space, carried to the world by the derivatives of the positions there.
std::vector<DerivativeSample> on_lattice(const Dataset& d, const Field& f, int component, size_t most) {
  const Lattice lattice(d.mesh());
  const LatticeView& view = lattice.view();
  const bool cells = f.association == Association::cell;
  const std::array<size_t, 3> n = cells ? view.cell_dims() : view.dims;
  if (std::min({n[0], n[1], n[2]}) < 3) return {};
  const size_t inner[3] = {n[0] - 2, n[1] - 2, n[2] - 2}, all = inner[0] * inner[1] * inner[2];
  // A step without a common factor with a row's length, so that samples do not line up.
  size_t step = std::max<size_t>(1, (all + most - 1) / most);
  while (step > 1 && std::gcd(step, inner[0]) > 1) ++step;
  const size_t count = (all + step - 1) / step;
  std::vector<DerivativeSample> samples(count);
  dispatch(f.array, [&](auto v) {
    parallel_for(count, 4096, [&](size_t begin, size_t end) {
      for (size_t s = begin; s < end; ++s) {
        const size_t at = s * step, i = 1 + at % inner[0], j = 1 + at / inner[0] % inner[1], k = 1 + at / inner[0] / inner[1];
        double w[3][3][3];
        bool finite = true;
        for (int c = 0; c < 3; ++c)
          for (int b = 0; b < 3; ++b)
            for (int a = 0; a < 3; ++a) {
              w[c][b][a] = number(v, (i + size_t(a) - 1) + n[0] * ((j + size_t(b) - 1) + n[1] * (k + size_t(c) - 1)), component);
              finite = finite && std::isfinite(w[c][b][a]);
            }
        samples[s].value = NAN;
        if (!finite) continue;
        const double g[3] = {0.5 * (w[1][1][2] - w[1][1][0]), 0.5 * (w[1][2][1] - w[1][0][1]), 0.5 * (w[2][1][1] - w[0][1][1])};
        Mat3 h;
        h.m[0][0] = w[1][1][2] - 2 * w[1][1][1] + w[1][1][0], h.m[1][1] = w[1][2][1] - 2 * w[1][1][1] + w[1][0][1];
        h.m[2][2] = w[2][1][1] - 2 * w[1][1][1] + w[0][1][1];
        h.m[0][1] = h.m[1][0] = 0.25 * (w[1][2][2] - w[1][2][0] - w[1][0][2] + w[1][0][0]);
        h.m[0][2] = h.m[2][0] = 0.25 * (w[2][1][2] - w[2][1][0] - w[0][1][2] + w[0][1][0]);
        h.m[1][2] = h.m[2][1] = 0.25 * (w[2][2][1] - w[2][0][1] - w[0][2][1] + w[0][0][1]);
        const Vec3 e[3] = {(view.position(i + 1, j, k) - view.position(i - 1, j, k)) * 0.5,
                           (view.position(i, j + 1, k) - view.position(i, j - 1, k)) * 0.5,
                           (view.position(i, j, k + 1) - view.position(i, j, k - 1)) * 0.5};
        Mat3 j3;  // columns: world per index
        for (int a = 0; a < 3; ++a) j3.m[0][a] = e[a].x, j3.m[1][a] = e[a].y, j3.m[2][a] = e[a].z;
        if (!(std::abs(determinant(j3)) > 1e-12 * length(e[0]) * length(e[1]) * length(e[2]))) continue;
        const Mat3 to_index = inverse(j3), to_world = transpose(to_index);
        samples[s] = sample_of(w[1][1][1], to_world * Vec3{g[0], g[1], g[2]}, from_matrix(to_world * h * to_index));
      }
    });
  });
  return samples;
}

std::vector<DerivativeSample> on_mesh(const DatasetPtr& data, const Field& field, int component, bool with_second, size_t most,
                                      Context& context) {
  // A field of its own, so that the operations take the right component and association.
  Field scalar{"value", field.association, {}, "", Role::scalars};
  std::vector<float> values(field.array.count());
  dispatch(field.array, [&](auto v) {
    for (size_t i = 0; i < values.size(); ++i) values[i] = float(number(v, i, component));
  });
  scalar.array = Array::from_vector(std::move(values));
  DatasetParts parts = data->parts();
  parts.fields = {};
  parts.fields.add(scalar);
  DatasetPtr d = make_dataset(std::move(parts));
  d = gradient(d, {{"value"}, "gradient"}, context);
  if (with_second) d = hessian(d, {{"value"}, "hessian"}, context);
  const Field& g = d->fields().require("gradient", field.association);
  const Field* h = with_second ? &d->fields().require("hessian", field.association) : nullptr;
  const size_t n = field.array.count(), step = std::max<size_t>(1, (n + most - 1) / most);
  std::vector<DerivativeSample> samples;
  for (size_t i = 0; i < n; i += step) {
    Mat3 m;
    for (int r = 0; r < 9; ++r) m.m[r / 3][r % 3] = h ? h->array.get(i, r) : 0;
    samples.push_back(sample_of(scalar.array.get(i), {g.array.get(i, 0), g.array.get(i, 1), g.array.get(i, 2)}, from_matrix(m)));
  }
  return samples;
}

}  // namespace

std::vector<DerivativeSample> sample_derivatives(const DatasetPtr& data, const Field& field, int component, bool with_second, size_t most,
                                                 Context& context) {
  std::vector<DerivativeSample> samples;
  if (is_lattice(data->mesh())) samples = on_lattice(*data, field, component, most);
  else if (!data->as<PointCloud>()) samples = on_mesh(data, field, component, with_second, most, context);
  std::erase_if(samples, [](const DerivativeSample& s) {
    return !std::isfinite(s.value) || !std::isfinite(s.gradient) || !std::isfinite(s.second_derivative) || !std::isfinite(s.curvature);
  });
  if (context.communicator) samples = all_concatenated(std::span<const DerivativeSample>(samples), context.communicator);
  return samples;
}

Range second_axis_range(const DatasetPtr& data, const Field& field, int component, SecondAxis axis, const Field* second, Context& context) {
  if (axis == SecondAxis::field && second) {
    Range r = range_over_all(*data, *second, second->components() > 1 ? -1 : 0, context);
    if (r.empty()) r = {0, 1};
    if (r.lo == r.hi) r.hi = r.lo + std::max(1.0, std::abs(r.lo));
    return r;
  }
  if (axis == SecondAxis::none || axis == SecondAxis::field) return {0, 1};
  std::vector<DerivativeSample> samples = sample_derivatives(data, field, component, axis != SecondAxis::gradient, 500000, context);
  std::vector<float> sizes;
  // Where nothing changes there is no level set: its curvature says nothing.
  float steep = 0;
  for (const DerivativeSample& s : samples) steep = std::max(steep, s.gradient);
  for (const DerivativeSample& s : samples) {
    if (axis == SecondAxis::curvature && !(s.gradient > 0.05f * steep)) continue;
    sizes.push_back(axis == SecondAxis::gradient ? s.gradient
                                                 : std::abs(axis == SecondAxis::curvature ? s.curvature : s.second_derivative));
  }
  double m = 0;
  if (!sizes.empty()) {
    const double share = axis == SecondAxis::gradient ? 0.999 : axis == SecondAxis::curvature ? 0.95 : 0.995;
    const size_t at = std::min(sizes.size() - 1, size_t(share * double(sizes.size())));
    std::nth_element(sizes.begin(), sizes.begin() + ptrdiff_t(at), sizes.end());
    m = double(sizes[at]);
    if (!(m > 0)) m = double(*std::max_element(sizes.begin(), sizes.end()));
  }
  if (!(m > 0)) m = 1;
  return axis == SecondAxis::gradient ? Range{0, m} : Range{-m, m};
}

}  // namespace sg
