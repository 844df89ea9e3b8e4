// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/questions/over_time.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/text/utf8.h"
#include "data/cells/mesh_dimension.h"
#include "filter/probe/probe.h"
#include "serve/renderer/questions/place_values.h"
#include "serve/renderer/questions/probed_cell.h"
#include "serve/renderer/tell.h"

namespace sg::serve {

namespace {

constexpr double hair = 1e-3, near = 0.01;  // shares of the data's size

std::optional<double> value_in(const DatasetPtr& d, const Field& f, Vec3 at, Context& context) {
  // A place that was clicked on the outside of a solid is off by the rounding of the picture's depths.
  const Box3& b = d->bounds();
  for (int a = 0; a < 3 && !b.empty(); ++a) {
    const double inside = std::clamp(at[a], b.lo[a], b.hi[a]);
    if (std::abs(inside - at[a]) <= hair * b.diagonal()) at[a] = inside;
    else return std::nullopt;
  }
  ProbeAtParams p;
  p.points = {at.x, at.y, at.z};
  if (mesh_dimension(*d) == 3) {
    const DatasetPtr there = probe_at(d, p, context);
    const Field* valid = there->fields().find("valid", Association::point);
    const Field* found = there->fields().find(f.name, Association::point);
    if (valid && found && valid->array.get(0) != 0) return size_at(found->array, 0);
  }
  if (f.association == Association::cell) {
    const auto cell = probed_cell(d, at, context);
    return cell ? std::optional(size_at(f.array, *cell)) : std::nullopt;
  }
  if (d->point_count() == 0) return std::nullopt;
  const PointNear nearest = nearest_point(*d, at);
  return nearest.distance <= near * d->bounds().diagonal() ? std::optional(size_at(f.array, nearest.point)) : std::nullopt;
}

}  // namespace

Json::Members answer_at_a_time(const Json& q, const PipelineFile& file, const std::shared_ptr<Cache>& cache, Context& context) {
  const std::string name = bytes_of_text(q["field"].text());
  const Vec3 at = place_of(q["at"], "at");
  const Data data = result_of(file, bytes_of_text(q["step"].text()), cache, context, Request::only({name}));
  if (std::holds_alternative<TablePtr>(data)) fail_usage("a table has no places", "over_time", "choose a step with a mesh");
  bool known = false;
  std::string unit;
  std::optional<double> value;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    const Field* f = d->fields().find(name);
    if (!f || f->association == Association::whole) return;
    known = true, unit = f->unit;
    if (!value) value = value_in(d, *f, at, context);
  });
  if (!known) fail_usage(fmt::format("there is no field '{}'", printable(name)), "over_time");
  return {{"unit", text(unit)}, {"value", value ? number(*value) : Json()}};
}

}  // namespace sg::serve
