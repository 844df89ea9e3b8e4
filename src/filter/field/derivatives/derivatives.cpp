// SPDX-License-Identifier: Apache-2.0
#include "filter/field/derivatives/derivatives.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "data/fields/known_looks.h"
#include "data/lattice.h"
#include "filter/field/derivatives/border_layers.h"
#include "filter/field/derivatives/fitted_derivatives.h"
#include "filter/field/derivatives/lattice_frame.h"
#include "filter/field/sampling/center_lattice.h"

namespace sg {

namespace {

constexpr const char* scratch = "derivatives of it";  // a field that lives between two steps
constexpr size_t values_per_chunk = 1 << 14;

const Field& choose(const DatasetPtr& in, const FieldName& name, int components, const char* who) {
  const Field* f = name.empty() ? nullptr : &in->fields().require(name.name);
  if (!f && components == 3) {
    f = in->fields().with_role(Role::vectors);
    if (!f) f = in->fields().active(3);
  }
  if (!f && components == 1) f = in->fields().active(1);
  if (!f)
    fail_usage(fmt::format("there is no field of {} component{}", components, components == 1 ? "" : "s"), who, "name one: field=...");
  if (f->association == Association::whole)
    fail_usage(fmt::format("field '{}' is defined on neither points nor cells", f->name), who, "name another: field=...");
  if (f->components() != components)
    fail_usage(fmt::format("field '{}' has {} components, not {}", f->name, f->components(), components), who);
  return *f;
}

// Makes a field of `components` from the 9 derivatives of a vector field.
template <class F>
DatasetPtr from_derivatives(const DatasetPtr& in, const Field& field, std::string name, int components, Role role, FieldLook look,
                            F&& combine, Context& ctx) {
  const DatasetPtr with = gradient(in, {{field.name}, scratch}, ctx);
  const Field& g = with->fields().require(scratch, field.association);
  std::byte* bytes = nullptr;
  Array out = Array::make_raw(g.array.type(), g.array.count(), components, &bytes);
  dispatch(g.array, [&](const auto& v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    T* to = reinterpret_cast<T*>(bytes);
    parallel_for(v.count, values_per_chunk, [&](size_t begin, size_t end) {
      double d[9], r[9] = {};
      for (size_t i = begin; i < end; ++i) {
        for (int k = 0; k < v.components; ++k) d[k] = double(v(i, k));
        combine(d, r);
        for (int k = 0; k < components; ++k) to[i * size_t(components) + size_t(k)] = T(r[k]);
      }
    });
  });
  return with_result(in, {std::move(name), field.association, std::move(out), g.unit, role, look});
}

// Curvilinear sheets and lines: what second derivatives have across them comes from the turning of the tangent, not from the field.
Array tangential_parts(const Mesh& mesh, bool of_cells, const Array& tensors) {
  if (!std::holds_alternative<CurvilinearGrid>(mesh)) return tensors;
  const Lattice lattice(of_cells ? center_lattice(mesh) : mesh);
  const LatticeFrame frame(lattice.view());
  if (frame.axes == 0 || frame.axes == 3) return tensors;
  std::byte* bytes = nullptr;
  Array out = Array::make_raw(tensors.type(), tensors.count(), 9, &bytes);
  dispatch(tensors, [&](const auto& v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    T* to = reinterpret_cast<T*>(bytes);
    parallel_for(v.count, values_per_chunk, [&](size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p) {
        const size_t at[3] = {p % frame.dims[0], p / frame.dims[0] % frame.dims[1], p / frame.dims[0] / frame.dims[1]};
        const Mat3 m = frame.metric(p, at);  // its first columns span the tangents
        Vec3 e[2] = {normalize(Vec3(m.m[0][0], m.m[1][0], m.m[2][0])), {}};
        if (frame.axes == 2) {
          const Vec3 b(m.m[0][1], m.m[1][1], m.m[2][1]);
          e[1] = normalize(b - e[0] * dot(b, e[0]));
        }
        Mat3 tangential, full;
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) tangential.m[i][j] = e[0][i] * e[0][j] + e[1][i] * e[1][j], full.m[i][j] = double(v(p, 3 * i + j));
        full = tangential * full * tangential;
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) to[9 * p + size_t(3 * i + j)] = T(full.m[i][j]);
      }
    });
  });
  return out;
}

std::string name_of(const std::string& as, const char* what, const Field& f) {
  return as.empty() ? fmt::format("{}({})", what, f.name) : as;
}

}  // namespace

DatasetPtr divergence(const DatasetPtr& in, const DivergenceParams& p, Context& ctx) {
  const Field f = choose(in, p.field, 3, "divergence");
  return from_derivatives(
      in, f, name_of(p.as, "divergence", f), 1, Role::scalars, known_look("divergence"),
      [](const double* d, double* r) { r[0] = d[0] + d[4] + d[8]; }, ctx);
}

DatasetPtr curl(const DatasetPtr& in, const CurlParams& p, Context& ctx) {
  const Field f = choose(in, p.field, 3, "curl");
  return from_derivatives(
      in, f, name_of(p.as, "curl", f), 3, Role::vectors, FieldLook{},
      [](const double* d, double* r) { r[0] = d[7] - d[5], r[1] = d[2] - d[6], r[2] = d[3] - d[1]; }, ctx);
}

DatasetPtr hessian(const DatasetPtr& in, const HessianParams& p, Context& ctx) {
  const Field f = choose(in, p.field, 1, "hessian");
  const std::string name = name_of(p.as, "hessian", f);
  if (is_lattice(in->mesh()) || in->as<AmrGrid>()) {
    const DatasetPtr first = gradient(in, {{f.name}, "first " + std::string(scratch)}, ctx);
    const Field g = first->fields().require("first " + std::string(scratch), f.association);
    const DatasetPtr r = from_derivatives(
        first, g, name, 9, Role::tensors, FieldLook{},
        [](const double* d, double* h) {
          for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) h[3 * a + b] = 0.5 * (d[3 * a + b] + d[3 * b + a]);  // equal but for the borders
        },
        ctx);
    DatasetParts parts = r->parts();
    parts.fields.remove(g.name, g.association);
    Field h = *parts.fields.find(name, f.association);
    h.unit = f.unit.empty() ? "" : f.unit + "/length^2";
    const bool of_cells = f.association == Association::cell;
    h.array = with_border_derivatives(*in, of_cells, f.array, tangential_parts(in->mesh(), of_cells, h.array), ctx);
    if (in->as<CurvilinearGrid>()) h.array = with_fitted_borders(in, f, h.array, ctx);
    parts.fields.add(std::move(h));
    return make_dataset(std::move(parts));
  }
  if (in->as<PointCloud>()) fail_usage("the points of a cloud are not connected by cells", "hessian");
  const Array values = f.array.converted(ElementType::f64).made_packed();
  std::vector<double> g(values.count() * 3), h(values.count() * 6), full(values.count() * 9);
  warn_of_gaps(fitted_derivatives(in, f.association, values, g.data(), h.data(), ctx), f.association, "hessian", ctx);
  constexpr int place[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
  for (size_t i = 0; i < values.count(); ++i)
    for (size_t k = 0; k < 9; ++k) full[9 * i + k] = h[6 * i + size_t(place[k])];
  const Array out = Array::from_vector(std::move(full), 9);
  return with_result(in, {name, f.association, f.array.type() == ElementType::f64 ? out : out.converted(ElementType::f32),
                          f.unit.empty() ? "" : f.unit + "/length^2", Role::tensors});
}

}  // namespace sg
