// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/march.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "base/text/text.h"
#include "simulate/pde/stencil.h"

namespace sg::pde {

Steps steps_of_frame(double frame, const std::optional<double>& stated, double automatic, const std::string& who) {
  if (!(frame > 0) || !std::isfinite(frame))
    fail_usage(fmt::format("frames of {}", exact_number(frame)), who + " frame", "give a positive, finite time");
  if (stated && (!(*stated > 0) || !std::isfinite(*stated)))
    fail_usage(fmt::format("steps of {}", exact_number(*stated)), who + " step", "give a positive, finite time");
  const double count = std::max(1.0, std::ceil(frame / stated.value_or(automatic) * (1 - 1e-12) - 1e-9));
  if (!(count <= 1e6))
    fail_usage(fmt::format("a frame of {} takes {:.3g} steps", exact_number(frame), count), who,
               "ask for shorter frames, longer steps, fewer cells or an implicit scheme");
  return {size_t(count), frame / count};
}

void check_finite(const Values& u, const std::string& who, size_t step, double time, const std::string& hint, const Context& context) {
  if (std::isfinite(fluid::largest(u, context))) return;
  fail_data(fmt::format("the values grew beyond all numbers in step {} (time {:.6g})", step, time), who, hint);
}

void laplacian(const Room& room, const Values& u, const SideValues& sides, Values& out, const Context& context) {
  double* const to = out.values.data();
  const double* const v = u.values.data();
  each_place<1>(room.axes, u, 0, context, [=](size_t i, double around, double diagonal) { to[i] = around - diagonal * v[i]; });
  sides.add_to(out, 1);
}

DatasetPtr room_dataset(const Room& room, double time, std::vector<Field> fields) {
  DatasetParts parts;
  parts.mesh = whole_grid(room);
  parts.time = time;
  for (Field& f : fields) parts.fields.add(std::move(f));
  return make_dataset(std::move(parts));
}

}  // namespace sg::pde
