// SPDX-License-Identifier: Apache-2.0
// The grid that all analytic sources share, and the loop that fills it.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/parallel.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// Number type of the fields.
enum class FieldType { f32, f64 };
constexpr auto enum_words(FieldType) {
  using enum FieldType;
  return std::array{Word{"f32", f32}, Word{"f64", f64}};
}

/// A uniform grid of points over a box.
struct GridParams {
  int size = 64;               ///< points along the longest side; the others follow, so that the spacing is as equal as whole numbers allow
  std::vector<int64_t> dims;   ///< points per axis; wins over size
  std::vector<double> bounds;  ///< x0,x1,y0,y1,z0,z1; empty: the source's own
  FieldType type = FieldType::f32;
};
void describe_grid(Schema& s, GridParams& p);

/// The grid for `own` bounds of the source; an axis of no extent gets one point. Throws Error(usage) for dims and bounds of the wrong
/// number or order, and for more points than memory could hold.
UniformGrid analytic_grid(const GridParams& p, const Box3& own, const char* source, const Context& context);

/// A point field of `components` numbers in the asked type; f(Vec3, double*) fills one tuple.
template <class F>
Field analytic_field(const UniformGrid& grid, const GridParams& p, std::string name, int components, std::string unit, Role role,
                     const Context& context, F&& f) {
  const size_t nx = grid.dims[0], ny = grid.dims[1], rows = ny * grid.dims[2], n = nx * rows;
  std::byte* out = nullptr;
  const bool wide = p.type == FieldType::f64;
  Array a = Array::make_raw(wide ? ElementType::f64 : ElementType::f32, n, components, &out);
  parallel_for(
      rows, 16,
      [&](size_t begin, size_t end) {
        double v[9];
        for (size_t r = begin; r < end; ++r)
          for (size_t i = 0; i < nx; ++i) {
            f(grid.origin + grid.spacing * Vec3(double(i), double(r % ny), double(r / ny)), v);
            for (int c = 0; c < components; ++c) {
              const size_t at = (r * nx + i) * size_t(components) + size_t(c);
              if (wide) reinterpret_cast<double*>(out)[at] = v[c];
              else reinterpret_cast<float*>(out)[at] = float(v[c]);
            }
          }
      },
      &context);
  return {std::move(name), Association::point, std::move(a), std::move(unit), role};
}

}  // namespace sg
