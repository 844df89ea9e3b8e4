// SPDX-License-Identifier: Apache-2.0
// Rays through uniform and rectilinear grids whose samples are joined by another kernel than the linear one, or with other gradients.
#pragma once
#include <memory>

#include "data/field.h"
#include "data/memory/memo.h"
#include "render/volume/medium/stretch.h"
#include "render/volume/sources/lattice/lattice_volume.h"
#include "scene/items/volume_item.h"

namespace sg::volume {

/// Is another source wanted than lattice_source()? Labels are never joined.
bool wants_reconstruction(const VolumeSampling& sampling);

/// The field with sampling.kernel between the samples (on uneven axes over the index) and gradients by sampling.gradient. Throws
/// Error(usage) for names that are none.
///
/// Stretches: nearest is constant per voxel. Others are cubics through four places of a part of a cell, the part halved until the cubic
/// lies within `error` of the field; for splines, which are polynomials of degree 9 along a ray, that bound holds everywhere (ten places
/// tell such a polynomial; 2.4 is the Lebesgue constant of these places), for gaussian and sinc to the error of degree 9 (1e-6 of the
/// range). error = sampling.tolerance / 128 of the range of the values.
///
/// Where there is a value: as with linear, in cells whose corners all have one (cell fields: in the voxels of samples that have one;
/// nearest: likewise, and not in hidden cells). Samples without a value that have a share further out are made up, see fill_holes().
/// Beyond the border samples are reflected (reflect as a point), in the outer half cells of cell fields the border goes on.
///
/// `memo` (that of the volume's dataset) keeps what is made of the samples for the next picture. `reach`: all values that the field
/// takes (stored ones), beyond those of the samples where the kernel has lobes.
std::unique_ptr<RaySource> reconstructed_source(std::shared_ptr<const Volume> volume, const VolumeSampling& sampling, Memo* memo = nullptr,
                                                Range* reach = nullptr);

}  // namespace sg::volume
