// SPDX-License-Identifier: Apache-2.0
#include "filter/field/basics.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "data/field_ops.h"
#include "data/fields/known_looks.h"

namespace sg {

namespace {

constexpr size_t values_per_chunk = 1 << 15;

// The named field, or the active one of any of the component counts in order of preference.
const Field& chosen(const Dataset& in, const FieldName& name, std::initializer_list<int> components, const char* who, const char* kind) {
  if (!name.empty()) return *with_context(who, [&] { return &in.fields().require(name.name); });
  for (int n : components)
    if (const Field* f = in.fields().active(n)) return *f;
  fail_usage(fmt::format("the mesh has no {} field", kind), who, "name one: field=NAME");
}

ElementType float_type(ElementType t) { return element_size(t) == 8 ? ElementType::f64 : ElementType::f32; }

template <class T>
Array scaled(const Array& a, double factor, double offset) {
  T* to = nullptr;
  Array r = Array::make<T>(a.count(), a.components(), &to);
  dispatch(a, [&](auto v) {
    const auto n = size_t(v.components);
    parallel_for(v.count, values_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        for (size_t c = 0; c < n; ++c) to[i * n + c] = T(double(v(i, int(c))) * factor + offset);
    });
  });
  return r;
}

}  // namespace

DatasetPtr select(const DatasetPtr& in, const SelectParams& p, Context&) {
  if (p.keep.empty() && p.drop.empty()) fail_usage("no fields are selected", "select", "give keep=NAMES or drop=NAMES");
  const auto names = in->fields().names();
  for (const auto* list : {&p.keep, &p.drop})
    for (const std::string& n : *list)
      if (!in->fields().find(n)) fail_usage(fmt::format("field '{}' not found", n), "select", unknown_name_hint(n, names));
  auto listed = [](const std::vector<std::string>& list, const std::string& n) {
    return std::find(list.begin(), list.end(), n) != list.end();
  };
  DatasetParts out = in->parts();
  out.fields = {};
  for (const Field& f : in->fields())
    if ((p.keep.empty() || listed(p.keep, f.name)) && !listed(p.drop, f.name)) out.fields.add(f);
  return make_dataset(std::move(out));
}

DatasetPtr magnitude(const DatasetPtr& in, const MagnitudeParams& p, Context&) {
  const Field& f = chosen(*in, p.field, {3, 2}, "magnitude", "vector");
  if (f.components() == 1)
    fail_usage(fmt::format("field '{}' has only one component, so it has no magnitude", f.name), "magnitude", "use the field as it is");
  return with_result(in, {p.name.empty() ? f.name + "_magnitude" : p.name, f.association, scalar_of(f, -1, float_type(f.array.type())),
                          f.unit, Role::none});
}

DatasetPtr scale_field(const DatasetPtr& in, const ScaleFieldParams& p, Context& ctx) {
  const Field& f = chosen(*in, p.field, {1, 0}, "scale", "scalar");
  if (!std::isfinite(p.factor) || !std::isfinite(p.offset)) fail_usage("factor and offset must be finite", "scale");
  const bool unchanged = p.factor == 1 && p.offset == 0;
  if (!unchanged && p.unit.empty() && !f.unit.empty())
    ctx.info(fmt::format("scale: '{}' loses its unit {}; unit=... names the new one", f.name, f.unit));
  const bool wide = float_type(f.array.type()) == ElementType::f64;
  Array a = wide ? scaled<double>(f.array, p.factor, p.offset) : scaled<float>(f.array, p.factor, p.offset);
  // Scaled normals, ids or labels lose that role; scalars and vectors are (an offset moves a vector's tip, not its kind).
  const Role role = f.role == Role::scalars || f.role == Role::vectors ? f.role : Role::none;
  return with_result(in, {p.name.empty() ? f.name : p.name, f.association, std::move(a),
                          !p.unit.empty() ? p.unit
                          : unchanged     ? f.unit
                                          : "",
                          role});
}

DatasetPtr component(const DatasetPtr& in, const ComponentParams& p, Context&) {
  const Field& f = chosen(*in, p.field, {3, 2}, "component", "vector");
  if (p.component < 0 || p.component >= f.components())
    fail_usage(fmt::format("field '{}' has {} components; there is no component {}", f.name, f.components(), p.component), "component",
               fmt::format("0 to {}", f.components() - 1));
  const std::string suffix = f.components() <= 3 ? std::string(1, "xyz"[p.component]) : std::to_string(p.component);
  return with_result(in,
                     {p.name.empty() ? f.name + "_" + suffix : p.name, f.association, f.array.component(p.component), f.unit, Role::none});
}

}  // namespace sg
