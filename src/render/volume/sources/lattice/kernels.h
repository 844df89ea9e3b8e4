// SPDX-License-Identifier: Apache-2.0
// The inner loops of the ray caster, on runs of samples: a scalar reference (kernels.cpp) and vector code (kernels_simd.cpp) that gives the
// same bits on any machine.
#pragma once
#include <array>
#include <vector>

#include "base/vec.h"
#include "data/array.h"
#include "scene/scene.h"

namespace sg::volume {

/// Samples of a run are evaluated together; arrays have room for all of them and start at multiples of 64 bytes.
constexpr int run_length = 16;

/// Packed samples in their own type (u8, i8, u16, i16 or f32; others are converted), at least two per axis.
struct Voxels {
  Array array;
  std::array<size_t, 3> dims{};
};

struct Run {
  alignas(64) float ux[run_length], uy[run_length], uz[run_length];
  alignas(64) float value[run_length];
  alignas(64) int entry[run_length];  ///< of the transfer table
};

struct Gradients {
  alignas(64) float x[run_length], y[run_length], z[run_length];  ///< in q
  alignas(64) float per_cell[run_length];                         ///< change of the value over the length of a cell
};

/// What shading needs of a volume.
struct ShadePlan {
  float to_world[3][3];  ///< gradient in q -> in the world
  float per_scale;       ///< 1 / change per cell from which on there is a surface
};

struct Kernels {
  /// Trilinear values at places in u (clamped to the lattice); NaN where a corner is NaN.
  void (*sample)(const Voxels& voxels, const float* ux, const float* uy, const float* uz, float* values);
  /// Central differences over one cell to each side, q = u: one-sided next to NaN; in the outermost cells linear between the inner sample's
  /// and border_slope().
  void (*gradients)(const Voxels& voxels, const float* const u[3], const float* centre, Gradients& out);
};
/// The scalar reference, and the fastest for this machine.
Kernels scalar_kernels(const Voxels& voxels);
Kernels best_kernels(const Voxels& voxels);

inline float clamped(float u, float top) { return std::max(0.0f, std::min(u, top)); }

}  // namespace sg::volume
