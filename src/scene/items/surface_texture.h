// SPDX-License-Identifier: Apache-2.0
// SurfaceTexture: the directions of a vector field as a texture on a surface (line integral convolution, LIC).
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "base/schema/enum_words.h"
#include "data/field.h"

namespace sg {

/// How the samples along a line are weighted.
enum class LicKernel {
  box,   ///< all alike: the longest correlation for the number of steps
  hann,  ///< 1 + cos: soft ends
};
constexpr auto enum_words(LicKernel) { return std::array{Word{"hann", LicKernel::hann}, Word{"box", LicKernel::box}}; }

/// Noise that sticks to the surface, convolved along the lines of the field's tangential part as the picture shows them (Cabral, Leedom
/// 1993; Laramee, Jobard, Hauser 2003; Huang et al. 2012), then multiplied into the lit colour. Lengths are pixels of the final picture.
struct SurfaceTexture {
  std::string field;  ///< 2 or 3 components
  Association association = Association::point;
  int steps = 40;         ///< each way
  double step = 0.5;      ///< pixels, at most 1
  double grain = 1.5;     ///< pixels across a grain of noise
  double contrast = 1;    ///< slope from convolved noise to brightness; 1 spreads it evenly
  double strength = 0.7;  ///< 0: plain colour, 1: from black to one and a half times as bright
  LicKernel kernel = LicKernel::hann;
  std::optional<double> phase;  ///< 0 to 1: place of the ripples in the kernel that make an animation run along the lines
  uint64_t seed = 1;
};

}  // namespace sg
