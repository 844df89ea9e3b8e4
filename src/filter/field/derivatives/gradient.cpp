// SPDX-License-Identifier: Apache-2.0
#include "filter/field/derivatives/gradient.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "data/fields/known_looks.h"
#include "filter/field/derivatives/fitted_derivatives.h"
#include "filter/field/derivatives/gradient_rows.h"
#include "filter/field/derivatives/lattice_frame.h"
#include "filter/field/sampling/center_lattice.h"

namespace sg {

void describe(Schema& s, GradientParams& p) {
  s("field", p.field, "Point or cell field of any number of components; default: the active scalar.");
  s("as", p.as, "Name of the result; default: gradient(FIELD).");
}

namespace {

const Field& choose_field(const Dataset& input, const FieldName& name) {
  if (!name.empty()) {
    const Field& f = input.fields().require(name.name);
    if (f.association == Association::whole)
      fail_usage(fmt::format("field '{}' is defined on neither points nor cells", name.name), "gradient");
    return f;
  }
  const Field* f = input.fields().active(1);
  if (!f) f = input.fields().active(3);
  if (!f || f->association == Association::whole) fail_usage("the mesh has no field of one or three components", "gradient");
  return *f;
}

// One row of a lattice, with one-sided differences next to missing values. T is the number type of both.
template <class T>
void row_gradient(const LatticeFrame& frame, const View<T>& f, T* out, size_t r) {
  const size_t nx = frame.dims[0], ny = frame.dims[1], n = size_t(f.components);
  const bool listed = frame.view.mode == LatticeView::Mode::listed;
  for (size_t i = 0; i < nx; ++i) {
    const size_t at[3] = {i, r % ny, r / ny}, p = i + nx * r;
    const Mat3 m = listed ? frame.metric(p, at) : frame.to_world;
    for (size_t c = 0; c < n; ++c) {
      Vec3 d;
      auto value = [&](size_t q) { return double(f.data[q * n + c]); };
      for (int l = 0; l < frame.axes; ++l) {
        const AxisStencil& s = frame.stencil[l][at[l]];
        for (int k = 0; k < 3; ++k) d[l] += s.w[k] == 0 ? 0.0 : s.w[k] * value(size_t(ptrdiff_t(p) + s.o[k]));
      }
      if (!std::isfinite(dot(d, d))) [[unlikely]]
        for (int l = 0; l < frame.axes; ++l) d[l] = careful_derivative(frame.stencil[l][at[l]], p, value);
      const Vec3 g = std::isnan(value(p)) ? Vec3(NAN, NAN, NAN) : m * d;
      for (int a = 0; a < 3; ++a) out[(p * n + c) * 3 + size_t(a)] = T(g[a]);
    }
  }
}

// All rows of a lattice whose points start at `first` in the arrays.
template <class T>
void lattice_gradient(const LatticeFrame& frame, const View<T>& f, T* out, Context& context) {
  const size_t rows = frame.dims[1] * frame.dims[2];
  const bool fast = f.components == 1 && f.packed() && has_fast_rows(frame);
  parallel_for(
      rows, std::max<size_t>(1, (fast ? 16384 : 4096) / frame.dims[0]),
      [&](size_t begin, size_t end) {
        std::vector<T> scratch;
        for (size_t r = begin; r < end; ++r)
          if (!fast || !fast_row_gradient(frame, f.data, out, r, scratch)) row_gradient(frame, f, out, r);
      },
      &context);
}

// Patch by patch; with `of_cells` the values lie in the middles of the cells.
template <class T>
void amr_gradient(const AmrGrid& grid, bool of_cells, const View<T>& f, T* out, Context& context) {
  for (const auto& level : grid.levels)
    for (const auto& patch : level.patches) {
      const auto cells = patch.cells();
      const size_t more = of_cells ? 0 : 1;
      LatticeView v;
      v.dims = {cells[0] + more, cells[1] + more, grid.dimension == 3 ? cells[2] + more : 1};
      for (int a = 0; a < 3; ++a) v.step[a][a] = level.spacing[a];
      const size_t first = (of_cells ? patch.cell_offset : patch.point_offset) * size_t(f.components);
      const View<T> part{f.data + first, v.points(), f.components, f.stride, f.component_stride};
      lattice_gradient(LatticeFrame(v), part, out + 3 * first, context);
    }
}

template <class T>
Array grid_gradient(const Dataset& input, bool of_cells, const Array& values, Context& context) {
  T* out = nullptr;
  Array result = Array::make<T>(values.count(), values.components() * 3, &out);
  if (values.count() == 0) return result;
  if (const auto* amr = input.as<AmrGrid>()) {
    amr_gradient(*amr, of_cells, values.view<T>(), out, context);
  } else {
    const Lattice lattice(of_cells ? center_lattice(input.mesh()) : input.mesh());
    lattice_gradient(LatticeFrame(lattice.view()), values.view<T>(), out, context);
  }
  return result;
}

Array fitted_gradient(const DatasetPtr& input, Association on, const Array& values, ElementType type, Context& context) {
  double* out = nullptr;
  Array result = Array::make<double>(values.count(), values.components() * 3, &out);
  const FittedGaps gaps = fitted_derivatives(input, on, values.converted(ElementType::f64).made_packed(), out, nullptr, context);
  warn_of_gaps(gaps, on, "gradient", context);
  return result.converted(type);
}

}  // namespace

DatasetPtr gradient(const DatasetPtr& input, const GradientParams& params, Context& context) {
  if (input->as<PointCloud>())
    fail_usage("a mesh of kind 'points' has no gradient: its points are not connected", "gradient", "points alone have no gradient");
  const Field& field = choose_field(*input, params.field);
  const ElementType t = field.array.type();
  const ElementType type = t == ElementType::f32 || element_size(t) < 4 ? ElementType::f32 : ElementType::f64;
  Field out;
  out.name = params.as.empty() ? "gradient(" + field.name + ")" : params.as;
  out.unit = field.unit.empty() ? "" : field.unit + "/length";
  out.role = field.components() == 1 ? Role::vectors : field.components() == 3 ? Role::tensors : Role::none;
  const bool grid = is_lattice(input->mesh()) || input->as<AmrGrid>();
  if (!grid) {
    out.array = fitted_gradient(input, field.association, field.array, type, context);
  } else {
    const Array values = field.array.converted(type).made_packed();
    const bool of_cells = field.association == Association::cell;
    out.array = type == ElementType::f32 ? grid_gradient<float>(*input, of_cells, values, context)
                                         : grid_gradient<double>(*input, of_cells, values, context);
  }
  out.association = field.association;
  if (input->fields().find(out.name, out.association))
    context.info(fmt::format("gradient: replaces the {} field '{}'", association_name(out.association), out.name));
  return with_result(input, std::move(out));
}

}  // namespace sg
