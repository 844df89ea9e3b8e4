// SPDX-License-Identifier: Apache-2.0
// Carrying fields along: filters return ids or weights and never look at the types of fields they only carry.
#pragma once
#include <cstdint>
#include <span>

#include "data/dataset.h"

namespace sg {

/// out[i] = a[ids[i]]; same type and components, packed. Parallel.
Array gather(const Array& a, std::span<const int64_t> ids);
Array gather(const Array& a, std::span<const uint32_t> ids);

/// A point on the segment between two input points: value = (1-t)*a + t*b. a == b takes the value as it is.
struct EdgePoint {
  uint32_t a, b;  ///< ids below 2^32; lattices beyond that are refused by the caller
  float t;
};
/// Linear interpolation in the array's own type (integers round to nearest; the blend is done in double).
Array interpolate(const Array& a, std::span<const EdgePoint> points);

/// n weights per output tuple: out[i] = sum_k weights[i*n+k] * a[ids[i*n+k]]; integer types become f32 (f64 for 64-bit).
Array combine(const Array& a, std::span<const int64_t> ids, std::span<const double> weights, size_t n);

/// All fields of `association` gathered; names, units and roles kept, appended to `out` under `as`.
void carry_gathered(FieldSet& out, const FieldSet& in, Association association, std::span<const int64_t> ids, Association as);
void carry_gathered(FieldSet& out, const FieldSet& in, Association association, std::span<const uint32_t> ids, Association as);
void carry_interpolated(FieldSet& out, const FieldSet& in, std::span<const EdgePoint> points);
void carry_combined(FieldSet& out, const FieldSet& in, Association association, std::span<const int64_t> ids,
                    std::span<const double> weights, size_t n, Association as);
/// Fields of the whole, unchanged.
void carry_whole(FieldSet& out, const FieldSet& in);

/// One component of a field (or the magnitude for component -1 of several) as packed f32 or f64 numbers.
Array scalar_of(const Field& field, int component, ElementType type = ElementType::f32);

}  // namespace sg
