// SPDX-License-Identifier: Apache-2.0
// Steps in time, and what is shown of a room.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "simulate/fluid/lattice_sums.h"
#include "simulate/pde/side_values.h"

namespace sg::pde {

struct Steps {
  size_t count = 1;
  double length = 0;

  /// Where the last step before the end of a frame begins, by the sums with which it was taken.
  double last_before(size_t frames, double frame) const {
    return frames == 0 ? -length : double(frames - 1) * frame + double(count - 1) * length;
  }
};

/// The equal steps of a frame: none longer than `stated`, or `automatic` where that is open. Throws Error(usage) for lengths that are not
/// positive and finite, and for more than a million steps.
Steps steps_of_frame(double frame, const std::optional<double>& stated, double automatic, const std::string& who);

/// Throws Error(data), naming the step, where a value is not finite.
void check_finite(const Values& u, const std::string& who, size_t step, double time, const std::string& hint, const Context& context);

/// to[i] += scale * from[i], and the like: f(i) for all places.
template <class F>
void each_index(size_t count, const Context& context, F&& f) {
  parallel_for(
      count, fluid::values_at_once,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) f(i);
      },
      &context);
}

/// out = the Laplacian of u between the walls' values.
void laplacian(const Room& room, const Values& u, const SideValues& sides, Values& out, const Context& context);

DatasetPtr room_dataset(const Room& room, double time, std::vector<Field> fields);

/// A step of a third-order Runge-Kutta method that keeps what a forward step keeps (Shu, Osher 1988). rate(u, time, out) for a list of
/// fields: their derivatives. `base` and `slope` are places of as many fields.
template <class Rate>
void shu_osher_step(std::vector<Values>& u, std::vector<Values>& base, std::vector<Values>& slope, double time, double dt,
                    const Context& context, Rate&& rate) {
  base = u;
  constexpr double kept[3] = {0, 3.0 / 4, 1.0 / 3}, when[3] = {0, 1, 0.5};
  for (size_t stage = 0; stage < 3; ++stage) {
    rate(u, time + when[stage] * dt, slope);
    for (size_t f = 0; f < u.size(); ++f) {
      double* const to = u[f].values.data();
      const double *const from = base[f].values.data(), *const s = slope[f].values.data();
      const double k = kept[stage];
      each_index(u[f].values.size(), context, [=](size_t i) { to[i] = k * from[i] + (1 - k) * (to[i] + dt * s[i]); });
    }
  }
}

}  // namespace sg::pde
