// SPDX-License-Identifier: Apache-2.0
// Directions into which matter scatters light.
#include <algorithm>
#include <cmath>

#include "media_support.h"

#include "render/trace/media/collision.h"
#include "support/statistics.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using doctest::Approx;

namespace {

/// Of 40 000 directions drawn about a slanting ray (seed 5), in 24 bins of the cosine and 8 around it, against density().
double chance_of_turns(const PhaseFunction& phase) {
  Collision c;
  c.phase = phase;
  constexpr int n = 40'000, bins = 24, around = 8, fine = 400;
  const Vec3 along = normalize(Vec3{0.3, -0.5, 0.8}), x = normalize(cross(along, {0, 0, 1})), y = cross(along, x);
  std::vector<double> observed(bins * around), expected(bins * around);
  Sampler s(SamplerKind::independent, 5, 1);
  for (int i = 0; i < n; ++i) {
    s.start(uint32_t(i), 0, 0);
    const Vec3 d(c.sample(Vec3f(along), s.next2()));
    const double turn = std::atan2(dot(d, y), dot(d, x)) / (2 * M_PI) + 0.5;
    const int row = std::clamp(int((dot(d, along) + 1) / 2 * bins), 0, bins - 1), column = std::clamp(int(turn * around), 0, around - 1);
    ++observed[size_t(row * around + column)];
  }
  double whole = 0;
  for (int i = 0; i < bins * fine; ++i) {
    const double cosine = -1 + 2 * (i + 0.5) / (bins * fine), sine = std::sqrt(1 - cosine * cosine);
    for (int k = 0; k < around; ++k) {
      const double turn = 2 * M_PI * ((k + 0.5) / around - 0.5);
      const Vec3 d = along * cosine + (x * std::cos(turn) + y * std::sin(turn)) * sine;
      const double part = double(c.density(Vec3f(along), Vec3f(d))) * 4 * M_PI / (bins * fine * around);
      whole += part, expected[size_t(i / fine * around + k)] += n * part;
    }
  }
  CHECK(whole == Approx(1).epsilon(1e-3));
  return sg::test::chi_square_chance(observed, expected);
}

}  // namespace

TEST_CASE("media: directions of every phase function come as often as their density says (chi-square)") {
  VolumeScattering s;
  for (const PhaseKind kind : {PhaseKind::isotropic, PhaseKind::rayleigh, PhaseKind::henyey_greenstein}) {
    s.phase = kind;
    CAPTURE(int(kind));
    CHECK(chance_of_turns(PhaseFunction(s)) > 1e-4);
  }
  struct Lobes {
    double forward, back, share;
  };
  s.phase = PhaseKind::two_lobe;
  for (const Lobes& l : {Lobes{0.6, -0.3, 0.3}, Lobes{0.8, -0.7, 0.5}, Lobes{0.5, -0.5, 0.04}, Lobes{0.2, 0.7, 0.9}, Lobes{0.6, -0.6, 0},
                         Lobes{0.6, -0.6, 1}}) {
    s.anisotropy = l.forward, s.back_anisotropy = l.back, s.back_share = l.share;
    CAPTURE(l.share);
    CHECK(chance_of_turns(PhaseFunction(s)) > 1e-4);
  }
}
