// SPDX-License-Identifier: Apache-2.0
// Where smoke comes from: balls, boxes, the inside of a closed surface, the values of a field.
#pragma once
#include <optional>
#include <vector>

#include "base/context.h"
#include "simulate/fluid/dust/dust_params.h"
#include "simulate/fluid/mac_grid.h"
#include "simulate/fluid/smoke_params.h"
#include "simulate/fluid/walls/cover.h"

namespace sg::fluid {

/// What is given to the air beside its parameters.
struct SmokeInput {
  TriangleSoup surface;  ///< a solid or a source, if any
  SurfaceRole role = SurfaceRole::obstacle;
  /// Factors of density and temperature in each cell, NaN or both 0 where there is no source; empty without such a source.
  std::vector<double> density, temperature;
  std::optional<DustParams> dust;
};

template <class T>
class Emission {
 public:
  /// Without any source, a ball above the ground, which lies away from `up`; in air with dust none.
  Emission(const SmokeParams& p, const MacGrid& g, Vec3 up, const SmokeInput& given, const Context& context);
  /// What comes within dt: a density and temperature of so much per time, or held at the sources', and the velocity of the jet.
  void give_off(double dt, Lattice<T>& density, Lattice<T>& temperature, Faces<T>& velocity) const;
  const std::vector<Ball>& balls() const { return balls_; }
  const std::vector<Box3>& boxes() const { return boxes_; }
  size_t bytes() const { return (shares_.values.capacity() + density_.values.capacity() + temperature_.values.capacity()) * sizeof(T); }

 private:
  struct Air {
    Lattice<T>&density, &temperature;
    Faces<T>& velocity;
  };
  template <class Share, class Values>
  void give_off_within(const Box3& box, double dt, Air air, Share&& share, Values&& values) const;

  SmokeParams params_;
  MacGrid grid_;
  std::vector<Ball> balls_;
  std::vector<Box3> boxes_;
  Lattice<T> shares_;                 // of a surface or of data; the cells
  Lattice<T> density_, temperature_;  // of data
};

}  // namespace sg::fluid
