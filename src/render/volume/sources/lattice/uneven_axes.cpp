// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/lattice/uneven_axes.h"

namespace sg::volume {

namespace {
constexpr double most_smallest = 16384;  // cells as small as the smallest, side by side: floats tell a thousandth of one
}  // namespace

bool UnevenAxes::fits(const Volume& v) {
  for (const std::vector<double>& c : v.coordinates) {
    if (c.size() < 2) return false;
    const double least = (c.back() - c.front()) / most_smallest;
    for (size_t i = 0; i + 1 < c.size(); ++i)
      if (!(c[i + 1] - c[i] >= least && least > 0)) return false;
  }
  return true;
}

UnevenAxes::UnevenAxes(const Volume& v) {
  for (size_t a = 0; a < 3; ++a) {
    const std::vector<double>& c = v.coordinates[a];
    const size_t n = c.size();
    for (size_t i = 0; i < n; ++i) {
      weights[a].push_back(derivative_weights(i > 0 ? c[i] - c[i - 1] : 0, i + 1 < n ? c[i + 1] - c[i] : 0));
      // The width between the rounded samples: shares of the edge are whole at both.
      cells[a].push_back({float(c[i]), i + 1 < n ? 1 / (float(c[i + 1]) - float(c[i])) : 0});
    }
    slices[a] = v.first_cell[a];
    first[a] = float(c.front()), slices_per_q[a] = float(v.slices_per_q[a]);
  }
}

}  // namespace sg::volume
