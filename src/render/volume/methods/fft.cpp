// SPDX-License-Identifier: Apache-2.0
#include "render/volume/methods/fft.h"

#include <cmath>

#include <fmt/core.h>

#include "base/error.h"

namespace sg::volume {

namespace {

size_t without_small_factors(size_t n) {
  for (const size_t p : {2, 3, 5})
    while (n % p == 0) n /= p;
  return n;
}

/// Taylor's series; |x| <= pi/4.
void small_cos_sin(double x, double& c, double& s) {
  const double x2 = x * x;
  c = s = 1;
  for (int n = 18; n > 0; n -= 2) c = 1 - c * x2 / double(n * (n - 1)), s = 1 - s * x2 / double(n * (n + 1));
  s *= x;
}

}  // namespace

size_t fft_size(size_t n) {
  n = n < 2 ? 2 : n + (n & 1);
  while (without_small_factors(n) != 1) n += 2;
  return n;
}

void cos_sin_turns(double turns, double& cos, double& sin) {
  constexpr double two_pi = 6.28318530717958647692528676655900577;
  turns -= std::floor(turns);
  // Eighths: to the nearest quarter, then turned back.
  const int quarter = int(std::floor(4 * turns + 0.5));
  double c, s;
  small_cos_sin(two_pi * (turns - 0.25 * quarter), c, s);
  switch (quarter & 3) {
    case 0: cos = c, sin = s; break;
    case 1: cos = -s, sin = c; break;
    case 2: cos = -c, sin = -s; break;
    default: cos = s, sin = -c;
  }
}

template <class S>
Fft<S>::Fft(size_t size) : size_(size) {
  if (size == 0 || without_small_factors(size) != 1) fail_internal(fmt::format("a Fourier transform of {} points", size));
  for (size_t n = size; n > 1;)
    for (const int r : {4, 2, 3, 5})
      if (n % size_t(r) == 0) {
        radices_.push_back(r), n /= size_t(r);
        break;
      }
  cos_.resize(size), sin_.resize(size);
  for (size_t t = 0; t < size; ++t) {
    double c, s;
    cos_sin_turns(double(t) / double(size), c, s);
    cos_[t] = S(c), sin_[t] = S(-s);
  }
}

template class Fft<float>;
template class Fft<double>;

}  // namespace sg::volume
