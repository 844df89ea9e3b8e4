// SPDX-License-Identifier: Apache-2.0
// vortex_cores: lines about which a flow turns.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

enum class CoreMethod { sujudi_haimes, levy };
constexpr auto enum_words(CoreMethod) {
  using enum CoreMethod;
  return std::array{Word{"sujudi_haimes", sujudi_haimes}, Word{"levy", levy}};
}

struct VortexCoresParams {
  FieldName field;
  CoreMethod method = CoreMethod::sujudi_haimes;
  double min_swirl = 0.05;
  double max_angle = 45;
  double min_length = 0.02;
};
void describe(Schema& s, VortexCoresParams& p);

/// sujudi_haimes: where the velocity is an eigenvector of its gradient whose other eigenvalues are complex (Sujudi, Haimes 1995), that
/// is u parallel to J u (Peikert, Roth 1999). levy: u parallel to curl u (Levy, Degani, Seginer 1990), in the same places. Derivatives
/// are those of the operation gradient. Straight cores of linear flows come out exactly; bent ones are off by a part that grows with their
/// curvature (that is the definition's, not the grid's).
///
/// Poly-lines with the fields of the input and "swirling strength" (1/time), "core angle" (degrees between core and velocity); pieces that
/// turn too weakly, run across the flow or are short are left out. Throws Error(usage) for flat meshes.
Data vortex_cores(const Data& in, const VortexCoresParams& p, Context& context);

}  // namespace sg
