// SPDX-License-Identifier: Apache-2.0
// What can be said of dust in the air.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "base/schema/schema.h"
#include "simulate/fluid/smoke_params.h"

namespace sg {

enum class DustShow { grid, particles };
constexpr auto enum_words(DustShow) { return std::array{Word{"grid", DustShow::grid}, Word{"particles", DustShow::particles}}; }

struct DustParams {
  int dust = 20000;
  double dust_rate = 0;
  std::vector<double> dust_box;
  std::optional<double> dust_mass, dust_drag;
  double dust_gravity = 1;
  int seed = 1;
  DustShow show = DustShow::grid;
};
void describe(Schema& s, DustParams& p);

struct DustySmokeParams : SmokeParams, DustParams {};
void describe(Schema& s, DustySmokeParams& p);

}  // namespace sg
