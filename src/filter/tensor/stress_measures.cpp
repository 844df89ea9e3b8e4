// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/stress_measures.h"

#include <fmt/core.h>

#include "base/error.h"
#include "data/fields/known_looks.h"
#include "filter/surface/normals.h"
#include "filter/tensor/tensor_shape.h"

namespace sg {

namespace {

// Unit normals where the tensors lie.
std::vector<Vec3> normals_for(const DatasetPtr& in, const TensorField& t, const TractionParams& p, Context& ctx) {
  const size_t n = t.d.size();
  const Association a = t.field.association;
  if (p.normal) {
    if (!(length(*p.normal) > 0)) fail_usage("the normal is zero or not finite", "traction", "give any vector of length above 0");
    return std::vector<Vec3>(n, normalize(*p.normal));
  }
  auto taken = [&](const Array& f) {
    std::vector<Vec3> r(n);
    for (size_t i = 0; i < n; ++i) r[i] = normalize(Vec3(f.get(i, 0), f.get(i, 1), f.get(i, 2)));
    return r;
  };
  for (const Field& f : in->fields())
    if (f.role == Role::normals && f.association == a && f.components() == 3) return taken(f.array);
  const auto* surface = in->as<SurfaceMesh>();
  if (!surface || surface->polygons.size() == 0)
    fail_usage(fmt::format("a {} mesh has no normals", in->kind()), "traction",
               "slice it first, or give normal=x,y,z for one direction everywhere");
  NormalsParams smooth;
  smooth.feature_angle = 180;
  smooth.cell_normals = true;
  const DatasetPtr with = normals(make_dataset(*surface), smooth, ctx);
  const Field& f = a == Association::point ? with->fields().require("Normals", a) : with->fields().require("Cell normals", a);
  if (f.array.count() < n) fail_usage("some cells of the surface have no normal", "traction", "apply clean first");
  return taken(f.array);
}

}  // namespace

void describe(Schema& s, StressMeasuresParams& p) {
  describe_tensors(s, p.tensors);
  s("measures", p.measures,
    "von_mises; tresca (largest minus smallest principal stress); mean (negative pressure); max_shear; principal: the three principal "
    "stresses; directions: their unit vectors.");
}

void describe(Schema& s, TractionParams& p) {
  describe_tensors(s, p.tensors);
  s("normal", p.normal, "One normal for all places; default: the field of normals, else those of the surface.");
}

DatasetPtr stress_measures(const DatasetPtr& in, const StressMeasuresParams& p, Context& ctx) {
  const TensorField t = read_tensors(*in, p.tensors, "stress_measures", ctx);
  if (p.measures.empty())
    fail_usage("measures is empty", "stress_measures", "give some of von_mises, tresca, mean, max_shear, principal, directions");
  DatasetParts parts = in->parts();
  const std::string& unit = t.field.unit;
  // Plane stress has a third principal stress of 0 across the plane.
  std::vector<Eigen3> principal(t.d.size());
  parallel_for(
      t.d.size(), 2048,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) principal[i] = eigen_of(t.d[i]);
      },
      &ctx);
  auto scalar = [&](std::string name, auto f) {
    parts.fields.add(field_beside(t, std::move(name), 1, unit, Role::none, ctx, [&](size_t i, double* v) { *v = f(principal[i]); }));
  };
  for (const StressMeasure m : p.measures) {
    if (m == StressMeasure::von_mises) scalar("von Mises stress", [](const Eigen3& e) { return von_mises_of(e.value); });
    if (m == StressMeasure::tresca) scalar("Tresca stress", [](const Eigen3& e) { return e.value[0] - e.value[2]; });
    if (m == StressMeasure::mean) scalar("mean stress", [](const Eigen3& e) { return mean_of(e.value); });
    if (m == StressMeasure::max_shear) scalar("maximum shear stress", [](const Eigen3& e) { return (e.value[0] - e.value[2]) / 2; });
    for (int k = 0; k < 3; ++k) {
      if (m == StressMeasure::principal) scalar(fmt::format("principal stress {}", k + 1), [k](const Eigen3& e) { return e.value[k]; });
      if (m == StressMeasure::directions)
        parts.fields.add(field_beside(t, fmt::format("principal direction {}", k + 1), 3, "", Role::none, ctx, [&](size_t i, double* v) {
          const Vec3 d = principal[i].vector[k];
          v[0] = d.x, v[1] = d.y, v[2] = d.z;
        }));
    }
  }
  mark_result(parts.fields, "von Mises stress", t.field.association);
  return make_dataset(std::move(parts));
}

DatasetPtr traction(const DatasetPtr& in, const TractionParams& p, Context& ctx) {
  const TensorField t = read_tensors(*in, p.tensors, "traction", ctx);
  const std::vector<Vec3> n = normals_for(in, t, p, ctx);
  DatasetParts parts = in->parts();
  const std::string& unit = t.field.unit;
  auto put = [](Vec3 a, double* v) { v[0] = a.x, v[1] = a.y, v[2] = a.z; };
  auto shear = [&](size_t i) {
    const Vec3 s = t.d[i] * n[i];
    return s - n[i] * dot(n[i], s);
  };
  parts.fields.add(field_beside(t, "normal traction", 1, unit, Role::scalars, ctx, [&](size_t i, double* v) { *v = t.d[i].along(n[i]); }));
  parts.fields.add(field_beside(t, "shear stress", 1, unit, Role::none, ctx, [&](size_t i, double* v) { *v = length(shear(i)); }));
  parts.fields.add(field_beside(t, "traction", 3, unit, Role::none, ctx, [&](size_t i, double* v) { put(t.d[i] * n[i], v); }));
  parts.fields.add(field_beside(t, "shear traction", 3, unit, Role::none, ctx, [&](size_t i, double* v) { put(shear(i), v); }));
  mark_result(parts.fields, "normal traction", t.field.association);
  return make_dataset(std::move(parts));
}

}  // namespace sg
