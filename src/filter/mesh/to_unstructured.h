// SPDX-License-Identifier: Apache-2.0
// Any mesh as unstructured cells.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct UnstructuredParams {};
inline void describe(Schema&, UnstructuredParams&) {}

/// The same points that cells use, the same cells in the same order, all fields and ghosts: grids as hexahedra (voxels, quads, ...),
/// surfaces as vertices, lines, polygons (triangles, quads) and strips, clouds as one vertex a point. An unstructured mesh comes
/// back as it is.
DatasetPtr to_unstructured(const DatasetPtr& in);
inline DatasetPtr to_unstructured(const DatasetPtr& in, const UnstructuredParams&, Context&) { return to_unstructured(in); }

}  // namespace sg
