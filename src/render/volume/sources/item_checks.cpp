// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/item_checks.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "data/fields/field_component.h"
#include "render/volume/effects/effects.h"

namespace sg::volume {

void check(const VolumeItem& item) {
  if (!item.data) fail_usage("a volume item has no dataset", "volume");
  if (item.data->as<SurfaceMesh>() || item.data->as<PointCloud>())
    fail_usage(fmt::format("a {} has no volume to look through", item.data->kind()), "volume", "show its surface instead: --show surface");
  if (!(item.sampling.step >= 0) || !std::isfinite(item.sampling.step))
    fail_usage(fmt::format("the step {} is not a valid length", item.sampling.step), "volume",
               "give a length above 0, or 0 to sample by the tolerance");
  if (!(item.sampling.within() > 0 && item.sampling.within() <= 1))
    fail_usage(fmt::format("the tolerance {} is not a valid share of full scale", item.sampling.within()), "volume",
               "give a number above 0 and at most 1; 0.002 (1/512) is the default");
  if (!(item.unit_distance >= 0) || !std::isfinite(item.unit_distance))
    fail_usage(fmt::format("the unit distance {} is not a valid length", item.unit_distance), "volume",
               "give a length above 0, or 0 for 1/100 of the diagonal");
  if (info_of(item.mode).needs_level && item.levels.empty())
    fail_usage("this ray function needs a value to find", "volume", "give one with levels=");
  const auto& points = item.opacity.points;
  if (points.empty()) fail_usage("the opacity curve has no points", "volume", "give at least one: {value, opacity}");
  for (size_t i = 0; i < points.size(); ++i) {
    if (!(points[i].y >= 0 && points[i].y <= 1))
      fail_usage(fmt::format("the opacity {} at {} is not between 0 and 1", points[i].y, points[i].x), "volume");
    if (points[i].x != points[i].x || (i > 0 && points[i].x < points[i - 1].x))
      fail_usage(fmt::format("the points of the opacity curve are not in ascending order: {} comes after {}", points[i].x,
                             points[i > 0 ? i - 1 : 0].x),
                 "volume", "sort them by value");
  }
  for (double l : item.levels)
    if (!std::isfinite(l)) fail_usage(fmt::format("the level {} is not a number", l), "volume");
  check_light(item);
}

const Field& field_of(const VolumeItem& item) {
  const FieldSet& fields = item.data->fields();
  const Field* f = item.field.empty() ? fields.active() : nullptr;
  if (!f && item.field.empty()) fail_usage("the dataset has no scalar field to show as a volume", "volume", "name one with field=");
  if (!f) f = &fields.require(item.field, item.association);
  if (f->association == Association::whole)
    fail_usage(fmt::format("field '{}' belongs to the whole dataset", f->name), "volume", "a volume needs a point or cell field");
  check_component(*f, item.component, "volume");
  return *f;
}

}  // namespace sg::volume
