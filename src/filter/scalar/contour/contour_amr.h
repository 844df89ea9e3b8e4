// SPDX-License-Identifier: Apache-2.0
// The leaves of an AMR grid, all or those near isosurfaces, as a mesh without hanging nodes.
#pragma once
#include "base/context.h"
#include "data/dataset.h"
#include "filter/scalar/contour/contour.h"

namespace sg::contouring {

/// An unstructured mesh of the leaf cells that one of the values crosses, and those around them; without values, of all. Leaves next to
/// finer ones are polyhedra (2D: polygons) with the finer ones' corners in their faces and edges, at level jumps of any ratio; the others
/// are voxels (pixels). So neighbours share whole faces, and a contour has no cracks.
///
/// A field of the points is taken as it is, at each corner from the finest patch there. A field of the cells becomes a point field:
/// at a corner of equal cells their mean; at level jumps and at the border the mean of the planes through the cells around
/// (least squares), so that linear fields stay linear everywhere. Cells without a value (NaN) are left out. Cell fields are carried.
DatasetPtr amr_cells_near(const DatasetPtr& input, const Field& field, int component, const std::vector<double>& values, Context& context);

/// What is contoured: a field of the points is preferred to one of the cells of the same name; without a name the active scalar.
const Field& field_of_amr(const Dataset& input, const FieldName& name);

/// contour() of an AMR grid. `component_of` reads ContourParams::component.
DatasetPtr contour_amr(const DatasetPtr& input, const ContourParams& params, int (*component_of)(const Field&, const std::string&),
                       Context& context);

}  // namespace sg::contouring
