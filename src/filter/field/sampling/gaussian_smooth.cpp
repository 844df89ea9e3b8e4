// SPDX-License-Identifier: Apache-2.0
#include "filter/field/sampling/gaussian_smooth.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "data/fields/known_looks.h"
#include "filter/field/sampling/separable.h"
#include "filter/segment/samples.h"

namespace sg {

namespace {

constexpr size_t values_per_chunk = 1 << 16;

/// Shares of the samples at `at` around each of them, not divided by their sum.
std::vector<AxisSum> gaussian_sums(const std::vector<double>& at, double sigma) {
  const size_t n = at.size();
  std::vector<AxisSum> sums(n);
  if (!(sigma > 0) || n == 1) {
    for (size_t i = 0; i < n; ++i) sums[i] = {i, {1}};
    return sums;
  }
  const auto width = [&](size_t i) { return 0.5 * std::abs(at[std::min(i + 1, n - 1)] - at[i > 0 ? i - 1 : 0]); };
  // The outermost represent a full width: the other half lies beyond the border.
  const auto share = [&](size_t i) { return i == 0 || i + 1 == n ? 2 * width(i) : width(i); };
  size_t first = 0;
  for (size_t i = 0; i < n; ++i) {
    while (std::abs(at[i] - at[first]) > 4 * sigma) ++first;
    sums[i].first = first;
    const double here = share(i);
    for (size_t j = first; j < n && std::abs(at[j] - at[i]) <= 4 * sigma; ++j) {
      const double d = (at[j] - at[i]) / sigma;
      sums[i].weight.push_back(float(std::exp(-0.5 * d * d) * (here > 0 ? share(j) / here : 1)));
    }
  }
  return sums;
}

}  // namespace

void describe(Schema& s, GaussianSmoothParams& p) {
  s("field", p.field, "Scalar point or cell field; default: the active scalar.").takes(fields::scalars);
  s("sigma", p.sigma, "Standard deviation: one number or one per axis of the grid; default: the mean distance between neighbours.")
      .unit("length")
      .at_least(0);
  s("name", p.name, "Name of the new field; default: it replaces the old one.");
}

DatasetPtr gaussian_smooth(const DatasetPtr& in, const GaussianSmoothParams& p, Context& context) {
  if (p.sigma.size() > 1 && p.sigma.size() != 3)
    fail_usage(fmt::format("needs one or three numbers, not {}", p.sigma.size()), "gaussian_smooth sigma", "write e.g. 0.5 or 0.5,0.5,2");
  for (double s : p.sigma)
    if (!(s >= 0) || !std::isfinite(s))
      fail_usage(fmt::format("{} is not a valid length", s), "gaussian_smooth sigma", "give a length, or 0 for no smoothing");
  const SampleImage image = sample_image(*in, p.field, "gaussian_smooth");
  if (image.field.role == Role::labels)
    fail_usage(fmt::format("field '{}' holds labels, which cannot be averaged", image.field.name), "gaussian_smooth", "use morphology");
  const size_t n = image.count();
  const Range range = in->range(image.field, 0);
  const double base = range.empty() ? 0 : 0.5 * range.lo + 0.5 * range.hi;
  std::vector<float> value(n), weight(n), other(n);
  dispatch(image.field.array, [&](auto v) {
    parallel_for(n, values_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const double x = double(v[i]);
        const bool known = std::isfinite(x) && !image.hidden(i);
        value[i] = known ? float(x - base) : 0, weight[i] = known;
      }
    });
  });
  const std::vector<float> known = weight;
  for (size_t a = 0; a < 3; ++a) {
    double sigma = image.spacing(a);
    if (!p.sigma.empty()) sigma = p.sigma[p.sigma.size() == 3 ? a : 0];
    if (!(sigma > 0) || image.dims[a] == 1) continue;
    const std::vector<AxisSum> sums = gaussian_sums(image.at[a], sigma);
    sum_along(a, sums, value.data(), image.dims, other.data(), &context);
    value.swap(other);
    sum_along(a, sums, weight.data(), image.dims, other.data(), &context);
    weight.swap(other);
  }
  Field out = image.field;
  if (!p.name.empty()) out.name = p.name;
  const auto write = [&](auto* to) {
    parallel_for(n, values_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        to[i] = known[i] > 0 ? std::remove_reference_t<decltype(*to)>(base + double(value[i]) / double(weight[i])) : NAN;
    });
  };
  if (element_size(out.array.type()) == 8) {
    double* to = nullptr;
    out.array = Array::make<double>(n, 1, &to);
    write(to);
  } else {
    float* to = nullptr;
    out.array = Array::make<float>(n, 1, &to);
    write(to);
  }
  return with_result(in, std::move(out));
}

}  // namespace sg
