// SPDX-License-Identifier: Apache-2.0
// What a parameter of type FieldName accepts, for checks and help.
#pragma once
#include <string>

#include "base/schema/schema.h"

namespace sg {

/// Whether the field is "auto": the data decide.
bool is_automatic(const FieldName& field);
/// Whether fields of that many components are accepted; a count may be a vector's and a tensor's (3: xx yy xy).
bool takes_components(const FieldKinds& kinds, int components);

/// "a vector field (2 or 3 components) of points or cells", "any field of points or cells".
std::string field_kinds_text(const FieldKinds& kinds);

}  // namespace sg
