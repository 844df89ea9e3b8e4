// SPDX-License-Identifier: Apache-2.0
// Rays through uniform and rectilinear grids reconstructed by a kernel other than linear, or with other gradients.
#pragma once
#include <memory>

#include "data/field.h"
#include "data/memory/memo.h"
#include "render/volume/medium/stretch.h"
#include "render/volume/sources/lattice/lattice_volume.h"
#include "scene/items/volume_item.h"

namespace sg::volume {

/// Whether a source other than lattice_source() is needed. Labels are never interpolated.
bool wants_reconstruction(const VolumeSampling& sampling);

/// The field with sampling.kernel between the samples (on uneven axes over the index) and gradients by sampling.gradient. Throws
/// Error(usage) for unknown names.
///
/// Stretches: nearest is constant per voxel. Others are cubics through four places of a part of a cell, the part halved until the cubic
/// lies within `error` of the field; for splines, which are polynomials of degree 9 along a ray, that bound holds everywhere (ten points
/// determine such a polynomial; 2.4 is the Lebesgue constant of these points), for gaussian and sinc to the error of degree 9 (1e-6 of the
/// range). error = sampling.within() / 128 of the range of the values.
///
/// Where there is a value: as with linear, in cells whose corners all have one (cell fields: in the voxels of samples that have one;
/// nearest: likewise, and not in hidden cells). Samples without a value that contribute further out are filled, see fill_holes().
/// Beyond the border samples are reflected (reflect as a point), the outer half cells of cell fields continue the border.
///
/// `memo` (that of the volume's dataset) keeps what is derived from the samples for the next picture. `reach`: all (stored) values that the
/// field takes, which exceed those of the samples if the kernel overshoots.
std::unique_ptr<RaySource> reconstructed_source(std::shared_ptr<const Volume> volume, const VolumeSampling& sampling, Memo* memo = nullptr,
                                                Range* reach = nullptr);

}  // namespace sg::volume
