// SPDX-License-Identifier: Apache-2.0
#include "filter/probe/profile.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "data/field_ops.h"

namespace sg {

DatasetPtr profile(const DatasetPtr& in, const ProfileParams& p, Context& context) {
  const auto* mesh = in->as<SurfaceMesh>();
  if (!mesh || mesh->lines.size() == 0)
    fail_usage("the mesh has no lines", "profile",
               "probe_at from=x,y,z to=x,y,z reads values along one; isolines and streamlines make others");
  const Field* f = p.field.empty() ? in->fields().active(1) : &in->fields().require(p.field.name, Association::point);
  if (!f || f->association != Association::point) fail_usage("the lines have no scalar at their points", "profile", "name one: field=NAME");
  if (f->components() != 1)
    fail_usage(fmt::format("field '{}' has {} components", f->name, f->components()), "profile",
               "calc expr='mag(NAME)' makes its magnitude");

  std::vector<double> xyz;
  std::vector<int64_t> points, cells, ids, offsets{0};
  const auto end_curve = [&](int64_t cell) {
    if (int64_t(ids.size()) - offsets.back() >= 2) offsets.push_back(int64_t(ids.size())), cells.push_back(cell);
    else ids.resize(size_t(offsets.back()));
  };
  const CellsView lines = cells_view(mesh->lines);
  const auto first_line = int64_t(mesh->vertices.size());
  for (size_t c = 0; c < lines.count; ++c) {
    const int64_t cell = first_line + int64_t(c);
    context.check();
    double distance = 0;
    for (size_t k = 0; k < lines.size(c); ++k) {
      const auto at = size_t(lines.point(c, k));
      if (k > 0) distance += length(mesh->points.at(at) - mesh->points.at(size_t(lines.point(c, k - 1))));
      const double value = f->array.get(at);
      if (!std::isfinite(value)) {
        end_curve(cell);
        continue;
      }
      ids.push_back(int64_t(points.size())), points.push_back(int64_t(at));
      xyz.insert(xyz.end(), {distance, value, 0});
    }
    end_curve(cell);
  }

  SurfaceMesh curves;
  curves.points.xyz = Array::from_vector(std::move(xyz), 3);
  curves.lines.connectivity = Array::from_vector(std::move(ids));
  curves.lines.offsets = Array::from_vector(std::move(offsets));
  DatasetParts parts;
  for (const Field& field : in->fields()) {
    Field kept = field;
    if (field.association == Association::point) kept.array = gather(field.array, points);
    if (field.association == Association::cell) kept.array = gather(field.array, cells);
    parts.fields.add(std::move(kept));
  }
  parts.mesh = std::move(curves);
  parts.time = in->time();
  return make_dataset(std::move(parts));
}

}  // namespace sg
