// SPDX-License-Identifier: Apache-2.0
// Whether the outer surface of a solid mesh tells something of a field.
#pragma once
#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Seven tenths of the outer surface's points (faces, for a field of cells) lie within a twentieth of the field's range: what it tells lies
/// inside. Of numbers of parts: one of the solid ones is not seen at all. Only for solid meshes of up to a million cells; looking at the
/// surface takes about as long as making it.
bool tells_only_inside(const DatasetPtr& data, const Field& field, Context& context);

}  // namespace sg
