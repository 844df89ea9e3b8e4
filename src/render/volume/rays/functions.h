// SPDX-License-Identifier: Apache-2.0
// What a ray collects other than emission and absorption, exactly for the cubics of its stretches.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "render/volume/medium/cubic.h"
#include "render/volume/medium/stretch.h"
#include "scene/items/volume_item.h"

namespace sg::volume {

/// A value, where it was found, and where values start.
struct Found {
  double value = 0, t = 0;
  bool found = false;
  double first = 0;
  uint64_t cell = 0;  ///< Stretch::cell there
};

/// Every function reads a ray that has been started, from near to far. Values are stored ones, lengths world lengths.
Found largest(RayField& ray);   ///< the nearest of equals
Found smallest(RayField& ray);  ///< the nearest of equals
struct Sum {
  double integral = 0, length = 0, first = 0;  ///< of value dt; of the ray with values; where they begin
};
Sum integral(RayField& ray);
/// Where the value is at least `level` for the first time.
Found first_at_least(RayField& ray, double level);
/// Length of the ray on which the value is at least `level`, and where that begins.
Sum length_at_least(RayField& ray, double level);

/// A crossing of a level.
struct Crossing {
  double t;
  uint32_t level;  ///< number in the list
  Vec3f gradient;  ///< world
  float second;    ///< value of the second field (RayField::second)
};
/// All crossings of the levels, from near to far; where the value jumps over a level between two stretches without a gap there is one too.
void all_crossings(RayField& ray, std::span<const double> levels, std::vector<Crossing>& out);
/// The nearest of them with `after` < t; its gradient and second value are left out.
std::optional<Crossing> first_crossing(RayField& ray, std::span<const double> levels, double after);

}  // namespace sg::volume
