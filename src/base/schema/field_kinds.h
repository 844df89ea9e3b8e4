// SPDX-License-Identifier: Apache-2.0
// What a parameter of type FieldName takes, asked and told.
#pragma once
#include <string>

#include "base/schema/schema.h"

namespace sg {

/// "auto" as the name of a field: the data decide.
bool is_automatic(const FieldName& field);
/// Whether fields of so many components are among them; a count may be a vector's and a tensor's (3: xx yy xy).
bool takes_components(const FieldKinds& kinds, int components);

/// "a vector field (2 or 3 components) of points or cells", "any field of points or cells".
std::string field_kinds_text(const FieldKinds& kinds);

}  // namespace sg
