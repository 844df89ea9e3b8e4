// SPDX-License-Identifier: Apache-2.0
#include "scene/show/field_color.h"

#include "scene/choose/scale.h"

namespace sg {

std::optional<FieldColor> field_color(const Dataset& d, const ColoringParams& p, Context& context) {
  const Field* f = wanted_field(d, p);
  if (!f) return {};
  FieldColor c;
  c.field = f->name;
  c.association = f->association;
  c.component = p.component;
  c.direct = is_direct_color(*f) && !p.map && p.component < 0;
  if (!c.direct) c.scale = choose_scale(d, *f, p, context);
  return c;
}

std::optional<Legend> legend_of(const std::optional<FieldColor>& c) {
  if (!c || c->direct) return {};
  return Legend(c->scale);
}

}  // namespace sg
