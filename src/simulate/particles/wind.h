// SPDX-License-Identifier: Apache-2.0
// A dataset's vector field at many places, on any mesh: wind that takes particles along, or a force.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/context.h"
#include "base/vec.h"
#include "data/dataset.h"
#include "filter/flow/flow_field.h"
#include "simulate/particles/straight_wind.h"

namespace sg::swarm {

/// Shared and immutable; holds the dataset.
class Wind {
 public:
  /// `field` empty: the active vectors. Throws Error(usage) without such a field, Error(data) where values are NaN or infinite.
  Wind(const DatasetPtr& data, const std::string& field, const std::string& who, Context& context);
  /// Interpolated values; 0 outside of the mesh. Of the places' chunk.
  void sample(std::span<const Vec3> x, std::span<Vec3> u) const;
  const DatasetPtr& dataset() const { return flow_->dataset(); }

 private:
  std::unique_ptr<FlowField> flow_;
  // A uniform grid along x, y and z is read without a cursor.
  std::optional<StraightGrid> straight_;
};

}  // namespace sg::swarm
