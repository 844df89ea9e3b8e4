// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/tensor_field.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "filter/field/sampling/point_cell.h"

namespace sg {

namespace {

struct Order {
  TensorOrder name;
  int components;
  TensorPlaces place;
};
constexpr Order orders[] = {
    {TensorOrder::rows, 9, {0, 4, 8, 1, 5, 2, 3, 7, 6}},        {TensorOrder::vtk, 6, {0, 1, 2, 3, 4, 5, -1, -1, -1}},
    {TensorOrder::upper, 6, {0, 3, 5, 1, 4, 2, -1, -1, -1}},    {TensorOrder::lower, 6, {0, 2, 5, 1, 4, 3, -1, -1, -1}},
    {TensorOrder::voigt, 6, {0, 1, 2, 5, 3, 4, -1, -1, -1}},    {TensorOrder::abaqus, 6, {0, 1, 2, 3, 5, 4, -1, -1, -1}},
    {TensorOrder::masked, 7, {1, 4, 6, 2, 5, 3, -1, -1, -1}},   {TensorOrder::rows, 4, {0, 3, -1, 1, -1, -1, 2, -1, -1}},
    {TensorOrder::plane, 3, {0, 1, -1, 2, -1, -1, -1, -1, -1}},
};

const Order& order_of(const Field& f, std::optional<TensorOrder> name, std::string_view who) {
  const int n = f.components();
  for (const Order& o : orders)
    if (o.components == n && (!name || name == o.name)) return o;
  if (!name)
    fail_usage(fmt::format("field '{}' has {} component{}, which is not a tensor", f.name, n, n == 1 ? "" : "s"), std::string(who),
               "tensors have 9 components (rows), 6 (symmetric), 7 (with a mask), in 2D 4 or 3");
  fail_usage(fmt::format("field '{}' has {} components, which does not fit the order '{}'", f.name, n, word_of(*name)), std::string(who),
             "rows: 9 or 4; vtk, upper, lower, voigt, abaqus: 6; masked: 7; plane: 3");
}

}  // namespace

void describe_tensors(Schema& s, TensorSource& p) {
  s("field", p.field, "Tensor field of 9, 7, 6, 4 or 3 components; default: the one marked as tensors, else the first of such a size.")
      .takes(fields::tensors);
  s("order", p.order,
    "Order of the components. rows: xx xy xz yx ...; vtk: xx yy zz xy yz xz; upper: xx xy xz yy yz zz; lower: xx xy yy xz yz zz; voigt: "
    "xx yy zz yz xz xy; abaqus: xx yy zz xy xz yz; masked: a confidence, then upper; plane: xx yy xy. auto: rows, or vtk for 6.");
}

TensorPlaces tensor_places(const Field& f, std::optional<TensorOrder> order, std::string_view who) { return order_of(f, order, who).place; }

const Field* find_tensors(const Dataset& d, const FieldName& name) {
  if (!name.empty()) return &d.fields().require(name.name);
  if (const Field* f = d.fields().with_role(Role::tensors))
    if (f->association != Association::whole) return f;
  for (Association a : {Association::point, Association::cell})
    for (int n : {9, 6, 7, 4})
      for (const Field& f : d.fields())
        if (f.association == a && f.components() == n && (f.role == Role::none || f.role == Role::scalars)) return &f;
  return nullptr;
}

TensorField read_tensors(const Dataset& data, const TensorSource& source, std::string_view who, Context& ctx) {
  const Field* f = find_tensors(data, source.field);
  if (!f) {
    std::string has;
    for (const Field& g : data.fields()) has += fmt::format("{}{} ({})", has.empty() ? "" : ", ", g.name, g.components());
    fail_usage("there is no tensor field", std::string(who),
               fmt::format("tensors have 9, 7, 6 or 4 components; fields: {}", has.empty() ? "none" : has));
  }
  if (f->association == Association::whole)
    fail_usage(fmt::format("field '{}' belongs to the whole dataset, not to points or cells", f->name), std::string(who));
  const Order& o = order_of(*f, source.order, who);
  TensorField t{*f, o.components < 6 ? 2 : 3, std::vector<SymTensor>(f->array.count())};
  const bool masked = o.components == 7;
  const size_t asymmetric = dispatch(f->array, [&](auto v) {
    return parallel_reduce(
        v.count, 1 << 14, size_t(0),
        [&](size_t begin, size_t end) {
          size_t n = 0;
          for (size_t i = begin; i < end; ++i) {
            auto get = [&](int place, double other) { return place < 0 ? other : double(v(i, place)); };
            double a[9];
            for (int k = 0; k < 6; ++k) a[k] = get(o.place[size_t(k)], 0);
            for (int k = 0; k < 3; ++k) a[6 + k] = get(o.place[size_t(6 + k)], a[3 + k]);
            const double apart = std::max({std::abs(a[3] - a[6]), std::abs(a[4] - a[7]), std::abs(a[5] - a[8])});
            SymTensor d{a[0], a[1], a[2], (a[3] + a[6]) / 2, (a[4] + a[7]) / 2, (a[5] + a[8]) / 2};
            n += apart > 1e-4 * std::max(d.norm(), apart);
            if (masked && !(double(v(i, 0)) >= 0.5)) d = SymTensor{NAN, NAN, NAN, NAN, NAN, NAN};
            t.d[i] = d;
          }
          return n;
        },
        [](size_t a, size_t b) { return a + b; }, &ctx);
  });
  if (asymmetric > 0)
    ctx.warn(fmt::format("{}: {} of {} tensors of '{}' are not symmetric: each is replaced by the mean with its transpose", who, asymmetric,
                         t.d.size(), f->name));
  return t;
}

TensorField read_point_tensors(const DatasetPtr& d, const TensorSource& source, std::string_view who, Context& ctx) {
  const Field* f = find_tensors(*d, source.field);
  if (!f || f->association != Association::cell) return read_tensors(*d, source, who, ctx);
  ctx.info(fmt::format("{}: '{}' lies on cells and is averaged to the points", who, f->name));
  DatasetParts parts = d->parts();
  parts.fields = {};
  parts.fields.add(*f);
  CellToPointParams to_points;
  to_points.fields = {f->name};
  const DatasetPtr averaged = cell_to_point(make_dataset(std::move(parts)), to_points, ctx);
  DatasetParts only = averaged->parts();
  only.fields = {};
  Field g = averaged->fields().require(f->name, Association::point);
  g.role = f->role;
  only.fields.add(g);
  return read_tensors(*make_dataset(std::move(only)), {FieldName{g.name}, source.order}, who, ctx);
}

}  // namespace sg
