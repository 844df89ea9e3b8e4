// SPDX-License-Identifier: Apache-2.0
// The samples of a lattice by their type.
#pragma once
#include <cstdint>

#include "base/error.h"
#include "data/array.h"

namespace sg::volume {

/// Calls f with the samples as a pointer to one of the types that volumes keep (LatticeSamples narrows the others).
template <class F>
decltype(auto) with_samples(const Array& a, F&& f) {
  switch (a.type()) {
    case ElementType::u8: return f(reinterpret_cast<const uint8_t*>(a.raw()));
    case ElementType::i8: return f(reinterpret_cast<const int8_t*>(a.raw()));
    case ElementType::u16: return f(reinterpret_cast<const uint16_t*>(a.raw()));
    case ElementType::i16: return f(reinterpret_cast<const int16_t*>(a.raw()));
    case ElementType::f32: return f(reinterpret_cast<const float*>(a.raw()));
    default: fail_internal("the samples of a volume were not narrowed");
  }
}

}  // namespace sg::volume
