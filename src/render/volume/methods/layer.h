// SPDX-License-Identifier: Apache-2.0
// The classic algorithms: each draws one volume of a uniform or rectilinear grid into a layer of its own.
#pragma once
#include <vector>

#include "base/context.h"
#include "image/image.h"
#include "scene/scene.h"

namespace sg::volume {

/// Premultiplied linear RGBA per pixel, width * height * 4, row 0 on top.
struct Layer {
  std::vector<float> rgba;
};

/// Input of a classic algorithm. `opaque` holds the depth of the surfaces in front of which (only) it draws.
struct LayerInput {
  const VolumeItem& item;
  const Projection& projection;
  const Frame& opaque;
  const std::vector<Light>& lights;
  Context& context;
};

// splat.cpp
Layer splat(const LayerInput& input);
// slices.cpp
Layer slices(const LayerInput& input);
// shear_warp.cpp
Layer shear_warp(const LayerInput& input);
// fourier.cpp
Layer fourier(const LayerInput& input);
// engines/tets/project.cpp: tetrahedra of any mesh by cell projection
Layer project_cells(const LayerInput& input);

}  // namespace sg::volume
