// SPDX-License-Identifier: Apache-2.0
// Normals on meshes of solid cells. Inside filter/scalar only.
#pragma once
#include "filter/scalar/contour/contour_parts.h"

namespace sg::contouring {

/// Unit vectors along minus the gradient (f32) at points on edges of an unstructured mesh.
///
/// The gradient at a point of the mesh is the mean over its solid cells, weighted by their volumes: the integral of the gradient over
/// a cell comes from its faces by Gauss's theorem. Exact for linear fields; of second order where the cells around a point are nearly
/// symmetric (a smoothly bent lattice of any cells), of first order elsewhere and at the border. Along the edge it is interpolated
/// linearly. Cells with a NaN are left out, hidden and refined ones too; duplicates count, so that pieces with ghost layers agree.
/// Inside cells the gradients of the eight corners are interpolated; those points come last.
Array cell_normals(const Job& job, const UnstructuredMesh& mesh, std::span<const EdgePoint> edges, std::span<const InnerPoint> inner,
                   std::span<const std::array<uint32_t, 8>> corners);

}  // namespace sg::contouring
