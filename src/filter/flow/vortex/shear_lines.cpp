// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/shear_lines.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/parallel.h"
#include "filter/mesh/append.h"
#include "filter/tensor/lines/hyperstreamlines.h"

namespace sg {

void describe(Schema& s, ShearLinesParams& p) {
  s("family", p.family, "Which of the two shear directions.");
  s("count", p.count, "Approximate number of seeds of each family.").range(1, 1e7);
  s("max_length", p.max_length, "Maximum length of a line; default: the diagonal of the data.").unit("length").positive();
}

namespace {

constexpr const char* scratch = "shear direction of it";

const Field& of_ftle(const Dataset& d, const char* name, int components) {
  const Field* f = d.fields().find(name, Association::point);
  if (!f || f->components() != components)
    fail_usage(fmt::format("there is no point field '{}' of {} components", name, components), "shear_lines",
               "use the result of ftle on a flat grid of seeds");
  return *f;
}

DatasetPtr one_family(const DatasetPtr& in, int sign, const ShearLinesParams& p, Context& context) {
  const View<float> stretch = of_ftle(*in, "stretch", 2).array.view<float>();
  const View<float> large = of_ftle(*in, "stretch direction", 3).array.view<float>();
  const View<float> small = of_ftle(*in, "shrink direction", 3).array.view<float>();
  double* to = nullptr;
  Array tensors = Array::make<double>(stretch.count, 6, &to);
  parallel_for(stretch.count, 1 << 13, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const double l1 = std::sqrt(double(stretch(i, 0))), l2 = std::sqrt(double(stretch(i, 1)));
      Vec3 xi1(small(i, 0), small(i, 1), small(i, 2)), xi2(large(i, 0), large(i, 1), large(i, 2));
      // An eigenvector has no sign: plus and minus are distinguished by the turn from xi1 to xi2.
      if (cross(xi1, xi2).z + cross(xi1, xi2).x + cross(xi1, xi2).y < 0) xi2 = -xi2;
      const Vec3 eta = xi1 * std::sqrt(l2 / (l1 + l2)) + xi2 * (sign * std::sqrt(l1 / (l1 + l2)));
      const SymTensor t = outer(eta);
      const double six[] = {t.xx, t.yy, t.zz, t.xy, t.yz, t.xz};
      std::copy(six, six + 6, to + 6 * i);
    }
  });
  DatasetParts parts = in->parts();
  parts.fields.add({scratch, Association::point, std::move(tensors), "", Role::tensors});
  HyperstreamlinesParams h;
  h.tensors.field = {scratch}, h.tensors.order = TensorOrder::vtk;
  h.count = p.count, h.section = TensorSection::line, h.max_length = p.max_length.value_or(in->bounds().diagonal());
  h.min_gap = 0.05;  // where neighbours' directions cancel there is none
  DatasetParts lines = hyperstreamlines(make_dataset(std::move(parts)), h, context)->parts();
  for (const char* name : {"eigenvalue", "eigenvalue 1", "eigenvalue 2", "eigenvalue 3", scratch})
    lines.fields.remove(name, Association::point);
  const size_t count = cell_count(lines.mesh);
  lines.fields.add({"family", Association::cell, Array::from_vector(std::vector<uint8_t>(count, sign < 0)), "", Role::labels});
  return make_dataset(std::move(lines));
}

}  // namespace

DatasetPtr shear_lines(const DatasetPtr& in, const ShearLinesParams& p, Context& context) {
  if (p.family != ShearChoice::both) return one_family(in, p.family == ShearChoice::plus ? 1 : -1, p, context);
  return append({Data(one_family(in, 1, p, context)), Data(one_family(in, -1, p, context))}, {}, context);
}

}  // namespace sg
