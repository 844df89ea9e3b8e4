// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/measures.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/parallel.h"
#include "data/fields/known_looks.h"
#include "filter/field/derivatives/gradient.h"
#include "filter/flow/eigen_general.h"
#include "filter/flow/flow_field.h"
#include "filter/tensor/sym_tensor.h"

namespace sg {

namespace {

struct Measure {
  VortexMeasure measure;
  std::string_view name;
  int components;
  void (*write)(const VortexMeasures& m, double* to);
};

template <double VortexMeasures::*member>
void number(const VortexMeasures& m, double* to) {
  *to = m.*member;
}

constexpr Measure table[] = {
    {VortexMeasure::vorticity, "vorticity", 3,
     [](const VortexMeasures& m, double* to) { to[0] = m.vorticity.x, to[1] = m.vorticity.y, to[2] = m.vorticity.z; }},
    {VortexMeasure::vorticity_magnitude, "vorticity magnitude", 1, number<&VortexMeasures::vorticity_magnitude>},
    {VortexMeasure::q, "Q", 1, number<&VortexMeasures::q>},
    {VortexMeasure::lambda2, "lambda2", 1, number<&VortexMeasures::lambda2>},
    {VortexMeasure::delta, "delta", 1, number<&VortexMeasures::delta>},
    {VortexMeasure::swirling_strength, "swirling strength", 1, number<&VortexMeasures::swirling_strength>},
    {VortexMeasure::helicity, "helicity", 1, number<&VortexMeasures::helicity>},
    {VortexMeasure::normalized_helicity, "normalized helicity", 1, number<&VortexMeasures::normalized_helicity>},
    {VortexMeasure::strain, "strain rate", 1, number<&VortexMeasures::strain>},
    {VortexMeasure::divergence, "divergence", 1, number<&VortexMeasures::divergence>},
    {VortexMeasure::okubo_weiss, "Okubo-Weiss", 1, number<&VortexMeasures::okubo_weiss>},
    {VortexMeasure::kinematic_vorticity, "kinematic vorticity", 1, number<&VortexMeasures::kinematic_vorticity>},
};

}  // namespace

void describe(Schema& s, VortexMeasuresParams& p) {
  s("field", p.field, "Velocity field; default: the active vectors.").takes(fields::vectors);
  s("measures", p.measures, "Fields to compute.");
}

VortexMeasures vortex_measures_of(const Mat3& j, Vec3 u) {
  VortexMeasures m;
  m.vorticity = {j.m[2][1] - j.m[1][2], j.m[0][2] - j.m[2][0], j.m[1][0] - j.m[0][1]};
  m.vorticity_magnitude = length(m.vorticity);
  double s[3][3], w[3][3], ss = 0, ww = 0;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      s[a][b] = (j.m[a][b] + j.m[b][a]) / 2, w[a][b] = (j.m[a][b] - j.m[b][a]) / 2;
      ss += s[a][b] * s[a][b], ww += w[a][b] * w[a][b];
    }
  m.q = (ww - ss) / 2;
  const double normal = j.m[0][0] - j.m[1][1], shear = j.m[1][0] + j.m[0][1];
  m.okubo_weiss = normal * normal + shear * shear - m.vorticity.z * m.vorticity.z;
  m.strain = std::sqrt(2 * ss);
  m.divergence = j.m[0][0] + j.m[1][1] + j.m[2][2];
  m.kinematic_vorticity = ss > 0 ? std::sqrt(ww / ss) : ww > 0 ? HUGE_VAL : ss;
  m.helicity = dot(u, m.vorticity);
  const double lengths = length(u) * m.vorticity_magnitude;
  m.normalized_helicity = lengths > 0 ? m.helicity / lengths : lengths;
  const auto squares = [&](int a, int b) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += s[a][k] * s[k][b] + w[a][k] * w[k][b];
    return sum;
  };
  m.lambda2 = eigen_of({squares(0, 0), squares(1, 1), squares(2, 2), squares(0, 1), squares(1, 2), squares(0, 2)}).value[1];
  Mat3 d = j;
  for (int a = 0; a < 3; ++a) d.m[a][a] -= m.divergence / 3;
  const auto minor = [&](int a, int b) { return d.m[a][a] * d.m[b][b] - d.m[a][b] * d.m[b][a]; };
  const double third = (minor(0, 1) + minor(0, 2) + minor(1, 2)) / 3, half = determinant(d) / 2;
  m.delta = half * half + third * third * third;
  const GeneralEigenvalues e = general_eigenvalues(j);
  m.swirling_strength = e.complex_pair ? e.im : std::isnan(e.real[0]) ? NAN : 0;
  return m;
}

Array velocity_gradients(const DatasetPtr& in, const Field& velocity, Context& context) {
  constexpr const char* scratch = "velocity gradient of it";
  const DatasetPtr with = gradient(in, {{velocity.name}, scratch}, context);
  const Array d = with->fields().require(scratch, velocity.association).array;
  if (d.components() == 9) return d.converted(ElementType::f64);
  double* to = nullptr;  // two components: no third row
  Array out = Array::make<double>(d.count(), 9, &to);
  dispatch(d, [&](const auto& v) {
    parallel_for(v.count, 1 << 14, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        for (int k = 0; k < 9; ++k) to[9 * i + size_t(k)] = k < 6 ? double(v(i, k)) : 0;
    });
  });
  return out;
}

DatasetPtr vortex_measures(const DatasetPtr& in, const VortexMeasuresParams& p, Context& context) {
  const Field velocity = flow_field_of(*in, p.field.name, "vortex_measures");
  std::vector<const Measure*> asked;
  for (const VortexMeasure measure : p.measures) {
    const auto m = std::find_if(std::begin(table), std::end(table), [&](const Measure& t) { return t.measure == measure; });
    if (std::find(asked.begin(), asked.end(), &*m) == asked.end()) asked.push_back(&*m);
  }
  const Array gradients = velocity_gradients(in, velocity, context);
  const View<double> d = gradients.view<double>();
  const bool wide = element_size(velocity.array.type()) == 8;
  std::vector<std::byte*> to(asked.size());
  std::vector<Array> arrays;
  for (size_t k = 0; k < asked.size(); ++k)
    arrays.push_back(Array::make_raw(wide ? ElementType::f64 : ElementType::f32, d.count, asked[k]->components, &to[k]));
  const Array u = velocity.array.converted(ElementType::f64);
  const View<double> uv = u.view<double>();
  parallel_for(
      d.count, 1 << 12,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          Mat3 j;
          for (int k = 0; k < 9; ++k) j.m[k / 3][k % 3] = d(i, k);
          const VortexMeasures m = vortex_measures_of(j, {uv(i, 0), uv(i, 1), velocity.components() > 2 ? uv(i, 2) : 0.0});
          double r[3];
          for (size_t k = 0; k < asked.size(); ++k) {
            asked[k]->write(m, r);
            const size_t n = size_t(asked[k]->components);
            for (size_t c = 0; c < n; ++c) {
              if (wide) reinterpret_cast<double*>(to[k])[i * n + c] = r[c];
              else reinterpret_cast<float*>(to[k])[i * n + c] = float(r[c]);
            }
          }
        }
      },
      &context);
  // The first measure is what is looked at next; the velocity stays the vector field that others follow.
  DatasetParts parts = in->parts();
  FieldSet fields;
  for (Field f : parts.fields) {
    if (f.role == Role::scalars) f.role = Role::none;
    if (f.name == velocity.name && f.association == velocity.association && f.role == Role::none && f.components() == 3)
      f.role = Role::vectors;
    fields.add(std::move(f));
  }
  bool first = true;
  for (size_t k = 0; k < asked.size(); ++k) {
    const bool scalar = asked[k]->components == 1;
    fields.add({std::string(asked[k]->name), velocity.association, std::move(arrays[k]), "",
                !scalar ? Role::vectors
                : first ? Role::scalars
                        : Role::none,
                known_look(asked[k]->name)});
    first = first && !scalar;
  }
  if (!asked.empty()) mark_result(fields, asked[0]->name, velocity.association);
  parts.fields = std::move(fields);
  return make_dataset(std::move(parts));
}

}  // namespace sg
