// SPDX-License-Identifier: Apache-2.0
#include "simulate/tissue_phantom.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"

namespace sg {

void describe(Schema& s, TissuePhantomParams& p) {
  describe_grid(s, p.grid);
  s("noise", p.noise, "Standard deviation of the noise, in per cent of the brightest tissue.").at_least(0);
  s("bias", p.bias, "Range of the multiplicative bias, in per cent: 40 is from 0.8 to 1.2.").range(0, 190);
  s("means", p.means, "Signal of background, fluid, grey and white matter.").at_least(0);
  s("partial_volume", p.partial_volume, "Mix the tissues in voxels on their borders.");
  s("seed", p.seed, "Seed of the noise.");
}

namespace {

constexpr double box = 85;  // mm

// About the distance in mm to an ellipsoid, negative inside.
double ellipsoid(Vec3 p, Vec3 center, Vec3 semi) {
  const Vec3 q = p - center;
  return (length(Vec3(q.x / semi.x, q.y / semi.y, q.z / semi.z)) - 1) * std::min({semi.x, semi.y, semi.z});
}

struct Place {
  uint8_t tissue;
  double margin;  // no border is nearer than margin / steepest
};
constexpr double steepest = 3.5;

Place tissue_at(Vec3 p) {
  const double head = (length(Vec3(p.x / 62, p.y / 78, p.z / 58)) - 1) * 64;
  double margin = std::abs(head);
  if (head >= 0) return {0, margin};
  constexpr double k = 2 * M_PI / 32;
  const double sx = std::sin(k * p.x), cx = std::cos(k * p.x), sy = std::sin(k * p.y), cy = std::cos(k * p.y), sz = std::sin(k * p.z),
               cz = std::cos(k * p.z);
  const double pial = head + 9 + 4 * (sx * cy + sy * cz + sz * cx);
  const Vec3 half{std::abs(p.x), p.y, p.z};  // left and right alike
  const double ventricle = ellipsoid(half, {12, 0, 5}, {7, 24, 10}), nucleus = ellipsoid(half, {26, 4, -6}, {8, 14, 11});
  margin = std::min({margin, std::abs(pial), std::abs(pial + 6), std::abs(ventricle), std::abs(nucleus)});
  if (pial >= 0 || ventricle < 0) return {1, margin};
  return {uint8_t(pial + 6 >= 0 || nucleus < 0 ? 2 : 3), margin};
}

// Shares of the tissues in the box of `size` around p.
std::array<float, 4> shares(Vec3 p, Vec3 size, bool mix) {
  std::array<float, 4> f{};
  const Place here = tissue_at(p);
  if (!mix || here.margin > steepest * length(size) / 2) {
    f[here.tissue] = 1;
    return f;
  }
  int n[3];
  for (int a = 0; a < 3; ++a) n[a] = size[a] > 0 ? 4 : 1;
  const float part = 1.0f / float(n[0] * n[1] * n[2]);
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        const Vec3 t{(i + 0.5) / n[0] - 0.5, (j + 0.5) / n[1] - 0.5, (k + 0.5) / n[2] - 0.5};
        f[tissue_at(p + size * t).tissue] += part;
      }
  return f;
}

double bias_shape(Vec3 p) {
  const Vec3 u = p / box;
  return std::sin(1.6 * (0.9 * u.x + 0.8 * u.y - 0.6 * u.z + 0.5 * u.x * u.y));
}

}  // namespace

DatasetPtr tissue_phantom(const TissuePhantomParams& p, Context& context) {
  if (p.means.size() != 4)
    fail_usage(fmt::format("{} means were given", p.means.size()), "tissue_phantom means",
               "give four: background, fluid, grey and white matter");
  const UniformGrid g = analytic_grid(p.grid, {{-box, -box, -box}, {box, box, box}}, "tissue_phantom", context);
  const size_t nx = g.dims[0], ny = g.dims[1], rows = ny * g.dims[2], n = nx * rows;
  Vec3 voxel;
  for (int a = 0; a < 3; ++a) voxel[a] = g.dims[size_t(a)] > 1 ? g.spacing[a] : 0.0;

  FieldSet fields;
  uint8_t* truth = nullptr;
  float *fraction[3], *bias = nullptr;
  Array truth_array = Array::make<uint8_t>(n, 1, &truth), bias_array = Array::make<float>(n, 1, &bias), fraction_array[3];
  for (int t = 0; t < 3; ++t) fraction_array[t] = Array::make<float>(n, 1, &fraction[t]);
  std::byte* signal = nullptr;
  const bool wide = p.grid.type == FieldType::f64;
  Array signal_array = Array::make_raw(wide ? ElementType::f64 : ElementType::f32, n, 1, &signal);
  const double sigma = p.noise / 100 * p.means[3];
  parallel_for(
      rows, 8,
      [&](size_t begin, size_t end) {
        for (size_t r = begin; r < end; ++r)
          for (size_t i = 0; i < nx; ++i) {
            const size_t id = r * nx + i;
            const Vec3 at = g.origin + g.spacing * Vec3(double(i), double(r % ny), double(r / ny));
            const auto f = shares(at, voxel, p.partial_volume);
            truth[id] = uint8_t(std::max_element(f.begin(), f.end()) - f.begin());
            for (size_t t = 0; t < 3; ++t) fraction[t][id] = f[t + 1];
            const double b = 1 + p.bias / 200 * bias_shape(at);
            bias[id] = float(b);
            double s = 0;
            for (size_t t = 0; t < 4; ++t) s += double(f[t]) * p.means[t];
            s *= b;
            if (sigma > 0) {  // two normal numbers (Box and Muller 1958): the two channels
              const double radius = sigma * std::sqrt(-2 * std::log(1 - random_unit(uint64_t(p.seed), 2 * id)));
              const double angle = 2 * M_PI * random_unit(uint64_t(p.seed), 2 * id + 1);
              s = std::hypot(s + radius * std::cos(angle), radius * std::sin(angle));
            }
            if (wide) reinterpret_cast<double*>(signal)[id] = s;
            else reinterpret_cast<float*>(signal)[id] = float(s);
          }
      },
      &context);
  fields.add({"intensity", Association::point, std::move(signal_array), "", Role::scalars});
  fields.add({"truth", Association::point, std::move(truth_array), "", Role::labels});
  for (int t = 0; t < 3; ++t)
    fields.add({fmt::format("truth_fraction_{}", t + 1), Association::point, std::move(fraction_array[t]), "", Role::none});
  fields.add({"truth_bias", Association::point, std::move(bias_array), "", Role::none});
  return make_dataset(g, std::move(fields));
}

}  // namespace sg
