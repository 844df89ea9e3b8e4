// SPDX-License-Identifier: Apache-2.0
// Boxes as what six planes have in common, so that meshes are cut exactly along their faces, edges and corners.
#pragma once
#include "base/context.h"
#include "data/dataset.h"
#include "filter/mesh/slice/implicit_function.h"

namespace sg::clipping {

/// The planes of a box that a mesh with these bounds reaches across, negative on the side of the box; at least one, which may lie outside.
std::vector<ImplicitFunction> box_planes(const Box3& box, const Box3& bounds);

/// One side of a plane: a lattice of three axes or an unstructured mesh of linear cells becomes an unstructured mesh (see clip).
using PlaneCut = std::function<DatasetPtr(const DatasetPtr& in, const ImplicitFunction& plane, bool outside)>;

/// The part of a mesh in a box or out of it, cut by one plane after the other. A function sampled at corners, as other shapes are, is zero
/// all over cells that touch a face of the box from within, and round where edges of the box run through cells. Outside: what lies behind
/// the first plane, then of the rest what lies behind the second, ...; the parts share their points.
DatasetPtr clip_box(const DatasetPtr& in, const Box3& box, bool outside, const PlaneCut& cut);

}  // namespace sg::clipping
