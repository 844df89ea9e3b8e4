// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/questions/line.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "filter/mesh/append.h"
#include "filter/probe/probe.h"
#include "serve/renderer/questions/place_values.h"
#include "serve/renderer/tell.h"

namespace sg::serve {

namespace {

constexpr int64_t most_points = 4096;

// The parts that have the field, in the order in which a place is looked for in them. Every cloud answers everywhere, by its nearest point:
// they come last, and as one.
std::vector<DatasetPtr> parts_with(const std::string& name, const Data& data, Context& context) {
  std::vector<DatasetPtr> parts;
  std::vector<Data> clouds;
  bool any = false;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    any = true;
    const Field* f = d->fields().find(name);
    if (!f || f->association == Association::whole) return;
    if (d->as<PointCloud>()) clouds.emplace_back(d);
    else parts.push_back(d);
  });
  if (!any) fail_usage("there are no values along a line of a table", "line");
  if (clouds.size() == 1) parts.push_back(std::get<DatasetPtr>(clouds[0]));
  else if (!clouds.empty()) parts.push_back(append(clouds, {}, context));
  if (parts.empty()) fail_usage(fmt::format("there is no field '{}'", printable(name)), "line");
  return parts;
}

}  // namespace

Json::Members answer_line(const Json& q, const Data& data, Context& context) {
  const std::string name = bytes_of_text(q["field"].text());
  const std::vector<DatasetPtr> parts = parts_with(name, data, context);
  const Vec3 from = place_of(q["from"], "from"), to = place_of(q["to"], "to");
  const int64_t count = int64_t(std::clamp<double>(q["count"].number(), 2, most_points));
  ProbeAtParams p;
  std::vector<Json> distances;
  for (int64_t i = 0; i < count; ++i) {
    const Vec3 at = from + (to - from) * (double(i) / double(count - 1));
    p.points.insert(p.points.end(), {at.x, at.y, at.z});
    distances.push_back(number(length(at - from)));
  }
  std::vector<Json> values(static_cast<size_t>(count));
  std::vector<char> known(static_cast<size_t>(count));
  std::string unit;
  for (const DatasetPtr& part : parts) {
    context.check();
    const DatasetPtr line = probe_at(part, p, context);
    const Field* field = line->fields().find(name, Association::point);
    const Field* valid = line->fields().find("valid", Association::point);
    if (!field || !valid) continue;
    if (unit.empty()) unit = field->unit;
    for (size_t i = 0; i < values.size(); ++i)
      if (!known[i] && valid->array.get(i) != 0) values[i] = number(size_at(field->array, i)), known[i] = true;
  }
  return {{"unit", text(unit)}, {"distance", Json(std::move(distances))}, {"values", Json(std::move(values))}};
}

}  // namespace sg::serve
