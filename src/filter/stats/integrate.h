// SPDX-License-Identifier: Apache-2.0
// Integrals of fields over a mesh.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct IntegrateParams {
  std::vector<std::string> fields;
};
inline void describe(Schema& s, IntegrateParams& p) { s("fields", p.fields, "Fields to integrate; default: all on points and cells."); }

/// One row per component of each field: field, association, component, integral, mean (integral by measure), and the measure of the
/// mesh: length, area or volume of the cells of its highest dimension (others are left out, as are hidden, refined and duplicate
/// cells). Point fields are integrated by the cells' own shape functions: exact for what a cell can represent (affine cells), else by
/// quadrature of twice its degree; cell fields are constant on a cell. NaN makes the integral NaN. A collection is one integral over
/// all of its parts, row by field name. Throws Error(usage) when there is no cell to integrate over.
TablePtr integrate(const Data& in, const IntegrateParams& p, Context& ctx);

}  // namespace sg
