// SPDX-License-Identifier: Apache-2.0
// GradientTable: strengths and directions of diffusion gradients, one a volume.
#pragma once
#include <string>
#include <vector>

#include "base/schema/enum_words.h"
#include "base/vec.h"
#include "data/dataset.h"

namespace sg {

/// What directions are relative to, see turn_to_world().
enum class GradientFrame { fsl, voxel, world };
constexpr auto enum_words(GradientFrame) {
  using enum GradientFrame;
  return std::array{Word{"fsl", fsl}, Word{"voxel", voxel}, Word{"world", world}};
}

struct GradientTable {
  std::vector<double> b;  ///< s/mm^2
  std::vector<Vec3> g;    ///< unit; zero where there is no gradient
  size_t size() const { return b.size(); }
};

/// From text files in FSL's form (bvals: one number a volume; bvecs: three rows of them, or three numbers a row), or, where a path is
/// empty, from the fields of the whole "bval" and "bvec" that come with a NIfTI file. Directions are normalised. A direction that is zero
/// or not a number counts as no direction when its b is at most `b0`; otherwise it is an error. Throws Error(usage) when there are none,
/// Error(data) naming the file and what is wrong: words that are not numbers, unequal counts, negative b.
GradientTable read_gradients(const Dataset& d, const std::string& bvals, const std::string& bvecs, double b0);

/// Turns directions into the world of the grid. `frame`: world: they are that already; voxel: along the axes of the image; fsl: along the
/// axes of the image, with x the other way when the axes are right-handed (FSL's rule for images that are stored left to right).
void turn_to_world(GradientTable& t, const Dataset& d, GradientFrame frame);

}  // namespace sg
