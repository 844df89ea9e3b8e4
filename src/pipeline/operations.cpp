// SPDX-License-Identifier: Apache-2.0
// The one place that knows all operations: their headers here, one line each in operations.def.
#include "pipeline/operation_table.h"

// Headers of the operations, sorted.
#include "filter/field/basics.h"
#include "filter/field/calc.h"
#include "filter/field/derivatives.h"
#include "filter/field/gradient.h"
#include "filter/field/point_cell.h"
#include "filter/mesh/append.h"
#include "filter/mesh/components.h"
#include "filter/mesh/crop.h"
#include "filter/mesh/faces.h"
#include "filter/mesh/merge_points.h"
#include "filter/mesh/piece.h"
#include "filter/mesh/slice.h"
#include "filter/mesh/tessellate_cells.h"
#include "filter/mesh/threshold.h"
#include "filter/mesh/to_unstructured.h"
#include "filter/mesh/transform.h"
#include "filter/probe/probe.h"
#include "filter/probe/resample.h"
#include "filter/scalar/contour.h"
#include "filter/segment/label_surface.h"
#include "filter/stats/integrate.h"
#include "filter/stats/statistics.h"
#include "filter/stats/table_to_points.h"
#include "simulate/flow_fields.h"
#include "simulate/point_load.h"
#include "simulate/scalar_fields.h"

namespace sg {

std::span<const Operation> operations() {
  // The first entry only keeps the array from being empty.
  static constexpr Operation table[] = {
      Operation{},
#include "pipeline/operations.def"
  };
  return std::span<const Operation>(table).subspan(1);
}

}  // namespace sg
