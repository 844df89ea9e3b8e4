// SPDX-License-Identifier: Apache-2.0
// Parameters whose values name files: their units say so.
#pragma once
#include "base/schema/schema.h"

namespace sg {

/// A file that is read (unit "file").
inline bool names_file(const ParamDecl& d) { return d.unit_ == "file"; }
/// A file that is written (unit "new file").
inline bool names_new_file(const ParamDecl& d) { return d.unit_ == "new file"; }

}  // namespace sg
