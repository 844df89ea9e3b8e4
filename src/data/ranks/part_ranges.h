// SPDX-License-Identifier: Apache-2.0
// Ranges of a field in the parts of the collection that is worked on.
#pragma once
#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Whether a field of this name has values on both sides of `value`, or that value, in one of Context::parts; false without parts.
inline bool met_in_a_part(const Field& field, int component, double value, const Context& context) {
  if (context.parts)
    for (const DatasetPtr& part : *context.parts)
      if (const Field* f = part->fields().find(field.name); f && f->components() == field.components()) {
        const Range r = part->range(*f, component);
        if (r.lo < r.hi && value >= r.lo && value <= r.hi) return true;
      }
  return false;
}

}  // namespace sg
