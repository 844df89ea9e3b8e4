// SPDX-License-Identifier: Apache-2.0
// The points of a mesh as masses and its edges as springs: cloth and jelly.
#pragma once
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "simulate/particles/particle_params.h"

namespace sg {

struct SpringMeshParams : MotionParams {
  double stiffness = 1000, damping = 1;
  std::vector<double> hold;
};
void describe(Schema& s, SpringMeshParams& p);

namespace swarm {

/// Springs that join points, each once; in the order of their ends.
struct Springs {
  std::vector<uint32_t> begin;  ///< where those of each point begin, one more at the end
  std::vector<uint32_t> other;  ///< the point at the other end
  std::vector<double> rest;
};
/// Along the sides and diagonals of cells of up to 8 points, round larger ones. Throws Error(usage) for a mesh without lines or cells.
Springs springs_of(const DatasetPtr& data);

}  // namespace swarm

/// The mesh with its points moved and the point field velocity: under gravity and drag, pulled by springs of `stiffness` (force per length)
/// and `damping` (force per speed along the spring), bouncing off the further inputs.
DatasetPtr spring_mesh(const std::vector<Data>& inputs, const SpringMeshParams& p, Context& context);
/// Of a mesh that takes so many bytes, reckoned as one of triangles.
RunCost cost_of_spring_mesh(const SpringMeshParams& p, uint64_t bytes);

}  // namespace sg
