// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/questions/place_values.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text/text.h"
#include "data/cells/point_positions.h"
#include "filter/probe/probe.h"
#include "serve/renderer/tell.h"

namespace sg::serve {

Vec3 place_of(const Json& list, std::string_view word) {
  Vec3 v;
  for (int a = 0; a < 3; ++a) {
    v[a] = list[size_t(a)].number();
    if (!list[size_t(a)].is_number() || !std::isfinite(v[a]))
      fail_usage(fmt::format("'{}' is not a place", word), "question", "it has three numbers");
  }
  return v;
}

std::string value_text(const Array& a, size_t i) {
  if (a.components() == 1) return short_number(a.get(i));
  std::string s = "(";
  for (int c = 0; c < std::min(a.components(), 9); ++c) s += (c ? ", " : "") + short_number(a.get(i, c));
  return s + ")";
}

double size_at(const Array& a, size_t i) {
  if (a.components() == 1) return a.get(i);
  double squares = 0;
  for (int c = 0; c < a.components(); ++c) squares += a.get(i, c) * a.get(i, c);
  return std::sqrt(squares);
}

PointNear nearest_point(const Dataset& d, Vec3 at) {
  const Array points = point_positions(d.mesh());
  PointNear best{0, HUGE_VAL};
  for (size_t i = 0; i < points.count(); ++i)
    if (const double l = length(Vec3{points.get(i, 0), points.get(i, 1), points.get(i, 2)} - at); l < best.distance) best = {i, l};
  return best;
}

std::vector<Json> values_at(const DatasetPtr& d, Vec3 at, std::optional<size_t> cell, Context& context) {
  ProbeAtParams p;
  p.points = {at.x, at.y, at.z};
  std::vector<Json> values;
  const auto add = [&](const Field& f, size_t i) {
    values.emplace_back(Json::Members{{"name", text(f.name)}, {"value", text(value_text(f.array, i))}, {"unit", text(f.unit)}});
  };
  const DatasetPtr there = probe_at(d, p, context);
  const Field* valid = there->fields().find("valid", Association::point);
  if (valid && valid->array.get(0) != 0) {
    for (const Field& f : there->fields())
      if (f.name != "valid" && f.association == Association::point) add(f, 0);
  } else {
    const size_t i = d->point_count() > 0 ? nearest_point(*d, at).point : 0;
    for (const Field& f : d->fields()) {
      if (f.association == Association::point) add(f, i);
      else if (f.association == Association::cell && cell) add(f, *cell);
    }
  }
  return values;
}

}  // namespace sg::serve
