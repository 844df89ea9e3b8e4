// SPDX-License-Identifier: Apache-2.0
#include "scene/show/volume_parts.h"

namespace sg {

void join_volumes(std::span<Item> items, const VolumeItem& model, uint32_t group) {
  Box3 all;
  for (const Item& item : items)
    if (const auto* v = std::get_if<VolumeItem>(&item))
      if (const Box3 b = v->data->bounds(); !b.empty()) all.add(b.lo), all.add(b.hi);
  if (all.empty()) return;
  VolumeItem look = model;
  const double part = model.data->bounds().diagonal(), whole = all.diagonal();
  if (!(look.unit_distance > 0)) look.unit_distance = 0.01 * whole;
  if (info_of(look.mode).collects() && part > 0) look.color.hi = look.color.lo + (look.color.hi - look.color.lo) * whole / part;
  for (Item& item : items)
    if (auto* v = std::get_if<VolumeItem>(&item)) {
      v->color = look.color, v->opacity = look.opacity, v->detail = look.detail;
      v->levels = look.levels, v->unit_distance = look.unit_distance, v->group = group;
    }
}

}  // namespace sg
