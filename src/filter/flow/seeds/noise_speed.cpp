// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/seeds/noise_speed.h"

#include <algorithm>
#include <cmath>

#include "base/vec.h"
#include "data/lattice.h"

namespace sg {

double noise_speed(const Dataset& data, const Field& velocity) {
  constexpr double part = 0.02, most_of_it = 0.75, agreement = 0.4;
  constexpr size_t apart = 4;
  if (!is_lattice(data.mesh()) || velocity.components() < 2 || velocity.components() > 3) return 0;
  std::array<size_t, 3> n = lattice_dims(data.mesh());
  if (std::min({n[0], n[1], n[2]}) < 3 || n[0] < 16) return 0;
  if (velocity.association == Association::cell)
    for (size_t& k : n) --k;
  const double largest = data.range(velocity, -1).hi, slow = part * largest;
  if (!(largest > 0)) return 0;
  return dispatch(velocity.array, [&](auto view) {
    const auto at = [&](size_t i) { return Vec3(double(view(i, 0)), double(view(i, 1)), view.components > 2 ? double(view(i, 2)) : 0.0); };
    // Sampled every few rows: of each point and one a few points before it along x, since scanner output is often smoothed.
    const size_t rows = view.count / n[0], step = std::max<size_t>(1, rows / 2000);
    size_t places = 0, still = 0, pairs = 0;
    double cosines = 0;
    for (size_t r = 0; r < rows; r += step)
      for (size_t i = 0; i < n[0]; ++i) {
        const Vec3 v = at(r * n[0] + i);
        const double speed = length(v);
        ++places, still += speed <= slow;
        if (i < apart || !(speed > 0) || speed > slow) continue;
        const Vec3 before = at(r * n[0] + i - apart);
        if (const double s = length(before); s > 0 && s <= slow) ++pairs, cosines += dot(v, before) / (s * speed);
      }
    const bool noise = double(still) >= most_of_it * double(places) && 4 * pairs >= places && cosines < agreement * double(pairs);
    return noise ? slow : 0.0;
  });
}

}  // namespace sg
