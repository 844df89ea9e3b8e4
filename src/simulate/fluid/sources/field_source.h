// SPDX-License-Identifier: Apache-2.0
// The values of fields as a source of smoke.
#pragma once
#include "base/context.h"
#include "data/dataset.h"
#include "simulate/fluid/sources/emission.h"

namespace sg::fluid {

struct SourceFields {
  const Field *density, *temperature;
};
/// The fields that the parameters name. Throws Error(usage) where they are no scalars of points or cells.
SourceFields source_fields(const Dataset& data, const SmokeFromParams& p);

/// Their values in the middles of the cells: by the shape functions of the cell of the mesh that holds the place (filter/probe), of cell
/// fields that cell's value. Where there is no such cell or a value is NaN, there is no source; negative densities count as 0, with a
/// warning. Throws Error(usage) where no middle lies in the data, Error(data) where a value is infinite.
SmokeInput field_source(const DatasetPtr& data, const SourceFields& fields, const MacGrid& g, Context& context);

}  // namespace sg::fluid
