// SPDX-License-Identifier: Apache-2.0
// TensorField: the symmetric tensors of a field in one form, however they were stored.
#pragma once
#include <array>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "filter/tensor/sym_tensor.h"
#include "filter/tensor/tensor_order.h"

namespace sg {

/// Which field holds tensors, and in what order it holds their numbers; part of the parameters of every tensor operation.
struct TensorSource {
  FieldName field;
  std::optional<TensorOrder> order;
};
void describe_tensors(Schema& s, TensorSource& p);

struct TensorField {
  Field field;               ///< as found: its name, association, unit
  int dimension = 3;         ///< 2: fields of 4 or 3 numbers, in the xy-plane
  std::vector<SymTensor> d;  ///< one a tuple
  Eigen3 eigen(size_t i) const { return dimension == 2 ? eigen_in_plane(d[i]) : eigen_of(d[i]); }
  /// f64 for 64-bit fields, else f32: the type of what is computed of it.
  ElementType result_type() const { return element_size(field.array.type()) == 8 ? ElementType::f64 : ElementType::f32; }
};

/// Components and orders (`order`, where auto takes the first that fits):
///   9  rows      xx xy xz yx yy yz zx zy zz
///   6  vtk       xx yy zz xy yz xz
///   6  upper     xx xy xz yy yz zz      (FSL's dtifit, ITK)
///   6  lower     xx xy yy xz yz zz      (NIfTI)
///   6  voigt     xx yy zz yz xz xy
///   6  abaqus    xx yy zz xy xz yz
///   7  masked    confidence xx xy xz yy yz zz (NRRD; a confidence below 0.5 gives NaN)
///   4  rows      xx xy yx yy            (2D)
///   3  plane     xx yy xy               (2D; only when named or marked as tensors)
/// Without a name: the field with role tensors, else the first of 9, 6, 7 or 4 components, of points before cells. Tensors whose matrix
/// differs from its transpose by more than 1e-4 of its norm are counted in one warning; all are replaced by the mean with their transpose.
/// Throws Error(usage) naming `who` when there is no such field, its number of components fits no tensor, or not the order.
TensorField read_tensors(const Dataset& d, const TensorSource& source, std::string_view who, Context& ctx);

/// The same on the points: a cell field is averaged to them first (cell_to_point), with a note.
TensorField read_point_tensors(const DatasetPtr& d, const TensorSource& source, std::string_view who, Context& ctx);

/// Where a tuple of the field holds xx yy zz xy yz xz, then yx zy zx; -1: zero (the first six) or symmetric (the last three).
using TensorPlaces = std::array<int, 9>;
/// By the table above. Throws Error(usage) naming `who` when the number of components fits no tensor or not the order.
TensorPlaces tensor_places(const Field& f, std::optional<TensorOrder> order, std::string_view who);

/// The field that read_tensors takes; null when there is none.
const Field* find_tensors(const Dataset& d, const FieldName& name);

/// A field with `components` numbers per tuple on the same points or cells as the tensors; f(i, double*) fills one. Parallel.
template <class F>
Field field_beside(const TensorField& t, std::string name, int components, std::string unit, Role role, const Context& ctx, F&& f);

}  // namespace sg

#include "base/parallel.h"

namespace sg {

template <class F>
Field field_beside(const TensorField& t, std::string name, int components, std::string unit, Role role, const Context& ctx, F&& f) {
  std::byte* out = nullptr;
  const bool wide = t.result_type() == ElementType::f64;
  Array a = Array::make_raw(t.result_type(), t.d.size(), components, &out);
  parallel_for(
      t.d.size(), 2048,
      [&](size_t begin, size_t end) {
        double v[9];
        for (size_t i = begin; i < end; ++i) {
          f(i, v);
          for (int c = 0; c < components; ++c) {
            const size_t at = i * size_t(components) + size_t(c);
            if (wide) reinterpret_cast<double*>(out)[at] = v[c];
            else reinterpret_cast<float*>(out)[at] = float(v[c]);
          }
        }
      },
      &ctx);
  return {std::move(name), t.field.association, std::move(a), std::move(unit), role};
}

}  // namespace sg
