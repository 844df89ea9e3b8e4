// SPDX-License-Identifier: Apache-2.0
// The passes of advection: what lies where the flow comes from, or where it goes, side by side in vectors.
#pragma once
#include <span>

#include "simulate/fluid/advection/advect.h"

namespace sg::fluid {

/// Values found by linear interpolation where the flow was dt ago, or will be, and what becomes of them.
enum class Pass {
  back,          ///< out = f there
  back_marked,   ///< scratch = f there; marks = the cell in which that is
  correct,       ///< out = scratch + (f - scratch, where the flow goes) / 2; with `limit` between the values of f about the mark
  compensate,    ///< scratch = f + (f - out, where the flow goes) / 2
  back_limited,  ///< out = scratch there; with `limit` between the values of f about there
};

/// Rows [begin, end) of fields on the lattice of `axis`. The marks, one a place, hold indices.
template <class T>
void carry_rows(const Carrier<T>& step, int axis, Pass pass, std::span<const Carried<T>> fields, Lattice<T>& marks, size_t begin,
                size_t end);

}  // namespace sg::fluid
