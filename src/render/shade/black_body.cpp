// SPDX-License-Identifier: Apache-2.0
#include "render/shade/black_body.h"

#include <cmath>

#include "color/cie.h"

namespace sg {

namespace {

/// A lobe with one width on each side.
double lobe(double x, double middle, double below, double above) {
  const double t = (x - middle) / (x < middle ? below : above);
  return std::exp(-0.5 * t * t);
}

Vec3 observer(double nm) {
  return {1.056 * lobe(nm, 599.8, 37.9, 31.0) + 0.362 * lobe(nm, 442.0, 16.0, 26.7) - 0.065 * lobe(nm, 501.1, 20.4, 26.2),
          0.821 * lobe(nm, 568.8, 46.9, 40.5) + 0.286 * lobe(nm, 530.9, 16.3, 31.1),
          1.217 * lobe(nm, 437.0, 11.8, 36.0) + 0.681 * lobe(nm, 459.0, 26.0, 13.8)};
}

}  // namespace

Vec3 black_body_xyz(double kelvin) {
  if (!(kelvin >= 100)) return {};
  constexpr double c2 = 1.438776877e7;  // h c / k in nm K
  Vec3 sum;
  for (double nm = 360; nm <= 830; nm += 5) {
    const double wave = 560 / nm, square = wave * wave;
    sum += observer(nm) * (square * square * wave / std::expm1(c2 / (nm * kelvin)));
  }
  return sum;
}

Vec3 black_body(double kelvin, double reference) {
  const double y = black_body_xyz(reference).y;
  return y > 0 ? xyz_to_linear(black_body_xyz(kelvin) / y) : Vec3();
}

}  // namespace sg
