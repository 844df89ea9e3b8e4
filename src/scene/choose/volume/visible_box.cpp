// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/volume/visible_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "data/lattice.h"

namespace sg {

namespace {

constexpr size_t most_samples = 4000000;

// Indices of samples along each axis: first and last.
using Extent = std::array<std::array<size_t, 2>, 3>;

// Between which all of the opacity lies, but for a thousandth on each side.
std::optional<Extent> visible_extent(const Field& field, int component, std::array<size_t, 3> n, const OpacityCurve& opacity) {
  constexpr double left_out = 0.001;
  // Rows are taken whole, of the others every few.
  const size_t step = size_t(std::ceil(std::sqrt(std::max(1.0, double(n[0]) * double(n[1]) * double(n[2]) / most_samples))));
  std::array<std::vector<double>, 3> sums;
  for (size_t a = 0; a < 3; ++a) sums[a].resize(n[a]);
  double all = 0;
  dispatch(field.array, [&](auto v) {
    const int c = v.components > 1 ? std::max(component, 0) : 0;
    for (size_t k = 0; k < n[2]; k += step)
      for (size_t j = 0; j < n[1]; j += step) {
        double row = 0;
        for (size_t i = 0; i < n[0]; ++i) {
          const double value = double(v(i + n[0] * (j + n[1] * k), c)), o = std::isfinite(value) ? opacity.at(value) : 0;
          sums[0][i] += o, row += o;
        }
        sums[1][j] += row, sums[2][k] += row, all += row;
      }
  });
  if (!(all > 0)) return {};
  Extent e;
  for (size_t a = 0; a < 3; ++a) {
    size_t first = 0, last = n[a] - 1;
    for (double sum = 0; first < last && (sum += sums[a][first]) <= left_out * all;) ++first;
    for (double sum = 0; last > first && (sum += sums[a][last]) <= left_out * all;) --last;
    e[a] = {first, last};
  }
  for (size_t a = 1; a < 3; ++a) e[a] = {e[a][0] - std::min(e[a][0], step - 1), std::min(e[a][1] + step - 1, n[a] - 1)};
  return e;
}

}  // namespace

std::optional<Box3> visible_box(const Dataset& data, const Field& field, int component, const OpacityCurve& opacity) {
  constexpr double margin = 0.06, nearly_all = 0.8, most = 0.5;
  const bool box_grid = data.as<UniformGrid>() || data.as<RectilinearGrid>();
  if (!box_grid || (field.components() > 1 && component < 0)) return {};
  const Lattice lattice(data.mesh());
  const LatticeView& view = lattice.view();
  const bool cells = field.association == Association::cell;
  const std::array<size_t, 3> n = cells ? view.cell_dims() : view.dims;
  if (field.array.count() != n[0] * n[1] * n[2]) return {};
  auto extent = visible_extent(field, component, n, opacity);
  if (!extent) return {};
  Extent& e = *extent;
  if (cells)
    for (auto& [first, last] : e) ++last;  // from corner to corner
  Box3 seen;
  for (const size_t i : e[0])
    for (const size_t j : e[1])
      for (const size_t k : e[2]) seen.add(view.position(i, j, k));
  Box3 box = data.bounds();
  const Vec3 all = box.size(), size = seen.size();
  double share = 1;
  for (int a = 0; a < 3; ++a) {
    const double room = margin * std::max(size[a], 0.25 * std::max({size.x, size.y, size.z}));
    const double lo = std::max(box.lo[a], seen.lo[a] - room), hi = std::min(box.hi[a], seen.hi[a] + room);
    if (hi - lo > nearly_all * all[a]) continue;
    box.lo[a] = lo, box.hi[a] = hi, share *= (hi - lo) / all[a];
  }
  return share < most ? std::optional(box) : std::nullopt;
}

}  // namespace sg
