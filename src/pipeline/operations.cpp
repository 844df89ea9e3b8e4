// SPDX-License-Identifier: Apache-2.0
// The one place that knows all operations: their headers here, one line each in operations.def.
#include "pipeline/operation_table.h"

// Headers of the operations, sorted.

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
