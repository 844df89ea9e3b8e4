// SPDX-License-Identifier: Apache-2.0
#include "filter/field/gradient.h"

#include <cmath>

#include "base/parallel.h"
#include "filter/field/gradient_cells.h"
#include "filter/field/gradient_rows.h"
#include "filter/field/lattice_frame.h"

namespace sg {

void describe(Schema& s, GradientParams& p) {
  s("field", p.field, "Point field of any number of components; default: the active scalar.");
  s("as", p.as, "Name of the result; default: gradient(FIELD).");
}

namespace {

const Field& choose_field(const Dataset& input, const FieldName& name) {
  const Field* f = nullptr;
  if (!name.empty()) {
    input.fields().require(name.name);
    f = input.fields().find(name.name, Association::point);
    if (!f) fail_usage(fmt::format("field '{}' does not lie on the points", name.name), "gradient", "name a field of the points");
    return *f;
  }
  f = input.fields().active(1);
  if (f && f->association == Association::point) return *f;
  for (int components : {1, 3})
    for (const Field& p : input.fields())
      if (p.association == Association::point && p.components() == components) return p;
  fail_usage("the mesh has no point field of one or three components", "gradient", f ? "average the cell field to the points first" : "");
}

// One row of a lattice, with one-sided differences beside missing values. T is the number type of both.
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

template <class T>
void amr_gradient(const AmrGrid& grid, const View<T>& f, T* out, Context& context) {
  for (const auto& level : grid.levels)
    for (const auto& patch : level.patches) {
      const auto cells = patch.cells();
      LatticeView v;
      v.dims = {cells[0] + 1, cells[1] + 1, grid.dimension == 3 ? cells[2] + 1 : 1};
      for (int a = 0; a < 3; ++a) v.step[a][a] = level.spacing[a];
      const size_t first = patch.point_offset * size_t(f.components);
      const View<T> part{f.data + first, v.points(), f.components, f.stride, f.component_stride};
      lattice_gradient(LatticeFrame(v), part, out + 3 * first, context);
    }
}

template <class T>
Array grid_gradient(const Dataset& input, const Array& values, Context& context) {
  T* out = nullptr;
  Array result = Array::make<T>(values.count(), values.components() * 3, &out);
  if (values.count() == 0) return result;
  if (const auto* amr = input.as<AmrGrid>()) {
    amr_gradient(*amr, values.view<T>(), out, context);
  } else {
    const Lattice lattice(input.mesh());
    lattice_gradient(LatticeFrame(lattice.view()), values.view<T>(), out, context);
  }
  return result;
}

Array cells_gradient(const Dataset& input, const Array& values, ElementType type, Context& context) {
  if (values.count() > size_t(UINT32_MAX) - 1) fail_usage("the mesh has more than 2^32 points", "gradient", "take a part of it at a time");
  std::vector<uint32_t> all(values.count());
  for (size_t i = 0; i < all.size(); ++i) all[i] = uint32_t(i);
  double* out = nullptr;
  Array result = Array::make<double>(values.count(), values.components() * 3, &out);
  least_squares_gradients(input, all, values.converted(ElementType::f64), out, context);
  return result.converted(type);
}

}  // namespace

DatasetPtr gradient(const DatasetPtr& input, const GradientParams& params, Context& context) {
  if (input->as<PointCloud>())
    fail_usage("a mesh of kind 'points' has no gradient: nothing connects its points", "gradient", "points alone have no gradient");
  const Field& field = choose_field(*input, params.field);
  const ElementType t = field.array.type();
  const ElementType type = t == ElementType::f32 || element_size(t) < 4 ? ElementType::f32 : ElementType::f64;
  Field out;
  out.name = params.as.empty() ? "gradient(" + field.name + ")" : params.as;
  out.unit = field.unit.empty() ? "" : field.unit + "/length";
  out.role = field.components() == 1 ? Role::vectors : field.components() == 3 ? Role::tensors : Role::none;
  const bool grid = is_lattice(input->mesh()) || input->as<AmrGrid>();
  if (!grid) {
    out.array = cells_gradient(*input, field.array, type, context);
  } else {
    const Array values = field.array.converted(type);
    out.array = type == ElementType::f32 ? grid_gradient<float>(*input, values, context) : grid_gradient<double>(*input, values, context);
  }
  DatasetParts parts = input->parts();
  if (parts.fields.find(out.name, Association::point)) context.info(fmt::format("gradient: replaces the point field '{}'", out.name));
  parts.fields.add(std::move(out));
  return make_dataset(std::move(parts));
}

}  // namespace sg
