// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/volume/visible_box.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "data/lattice.h"

namespace sg {

namespace {

constexpr size_t most_samples = 4000000;
constexpr double haze = 0.1;  // of the largest opacity

// Indices of samples along each axis: first and last.
using Extent = std::array<std::array<size_t, 2>, 3>;

std::optional<Extent> visible_extent(const Field& field, int component, std::array<size_t, 3> n, const OpacityCurve& opacity) {
  double most = 0;
  for (const Vec2& p : opacity.points) most = std::max(most, p.y);
  // Rows are taken whole, of the others every few.
  const size_t step = size_t(std::ceil(std::sqrt(std::max(1.0, double(n[0]) * double(n[1]) * double(n[2]) / most_samples))));
  Extent e{{{n[0], 0}, {n[1], 0}, {n[2], 0}}};
  dispatch(field.array, [&](auto v) {
    const int c = v.components > 1 ? std::max(component, 0) : 0;
    for (size_t k = 0; k < n[2]; k += step)
      for (size_t j = 0; j < n[1]; j += step)
        for (size_t i = 0; i < n[0]; ++i) {
          if (!(opacity.at(double(v(i + n[0] * (j + n[1] * k), c))) > haze * most)) continue;
          const size_t at[3] = {i, j, k};
          for (size_t a = 0; a < 3; ++a) e[a] = {std::min(e[a][0], at[a]), std::max(e[a][1], at[a])};
        }
  });
  if (e[0][0] > e[0][1]) return {};
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
