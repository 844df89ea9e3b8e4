// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/coloring.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/schema/color_params.h"
#include "scene/choose/own_materials.h"
#include "scene/choose/telling_field.h"

namespace sg {

void describe(Schema& s, ColoringParams& p) {
  s("field", p.field, "Field to colour by; default: the active scalar; 'none' for one colour.");
  s("component", p.component, "Component of a field with several; -1 is the magnitude.").range(-1, 1e6);
  s("map", p.map, "Colour map (see: sightglass colormap), or a file: FILE.cpt, FILE.json:NAME; 'auto' chooses by the data.");
  s("range", p.range, "Values at the two ends of the map; default: the range of the data.").unit("@field");
  s("scale", p.scale, "How values are mapped to colours.");
  s("linear_threshold", p.linear_threshold, "symlog: linear between minus and plus this; 0: a thousandth of the range.").at_least(0);
  s("below", p.below, "Colour of values below the range; default: the first colour.").unit(color_unit);
  s("above", p.above, "Colour of values above the range; default: the last colour.").unit(color_unit);
  s("nan", p.nan, "Colour where there is no value.").unit(color_unit);
  s("clamp", p.clamp, "Clamp values outside the range to the end colours; false leaves them out of the picture.");
  s("color", p.color, "One colour instead of a field: #rrggbb, r,g,b or a name.").unit(color_unit);
  s("legend", p.legend, "Draw a legend of the colours.");
  s("legend_title", p.legend_title, "Title of the legend; default: the field's name.");
  s("legend_unit", p.legend_unit, "Unit in the legend's title; default: the one that the data states.");
  s("legend_ticks", p.legend_ticks, "The numbers beside the legend's bar, such as 0,50,100; default: round ones.").unit("@field");
  s("legend_count", p.legend_count,
    "How many numbers stand beside the legend's bar: round ones where a step gives so many, else evenly from end to end; 0: as many as "
    "suit.")
      .range(0, 50);
  s("legend_format", p.legend_format,
    "Numbers of the legend as printf formats them: .2f, .3g, .1e; default: as short as they can be told apart.");
  s("legend_place", p.legend_place, "Side of the picture where the legend stands; at the top and the bottom its bar lies.");
  s("legend_bar", p.legend_bar,
    "Length of the legend's bar as a share of the picture's height, or of its width where the bar lies; of names, the room for their list. "
    "Default: what suits the other side of the picture.")
      .range(0.05, 1);
}

namespace {

const Field* automatic_field(const Dataset& d, bool by_materials) {
  // A field that is the same everywhere (a contour's own field) says nothing in colour.
  const auto varies = [&](const Field& f) {
    const Range r = d.range(f);
    return r.empty() || r.lo < r.hi;
  };
  const auto plain = [](Role r) { return r != Role::normals && r != Role::tcoords && r != Role::global_ids; };
  if (const Field* f = d.fields().result(); f && f->association != Association::whole && f->role != Role::global_ids && varies(*f))
    return f;
  for (const Field& f : d.fields())
    if (f.look.bands) return &f;
  const Field* scalars = d.fields().with_role(Role::scalars);
  if (scalars && scalars->components() == 1 && telling(d, *scalars) == Telling::values) return scalars;
  if (by_materials && has_own_materials(d)) return nullptr;
  if (const Field* f = d.fields().with_role(Role::colors)) return f;
  for (const Telling wanted : {Telling::values, Telling::divisions, Telling::numbering}) {
    if (scalars && scalars->components() == 1 && telling(d, *scalars) == wanted) return scalars;
    for (const int components : {1, 3})
      for (const Association a : {Association::point, Association::cell})
        for (const Field& f : d.fields())
          if (f.association == a && f.components() == components && plain(f.role) && telling(d, f) == wanted) return &f;
  }
  return nullptr;
}

}  // namespace

const Field* automatic_field(const Dataset& d) { return automatic_field(d, true); }
const Field* automatic_field_without_materials(const Dataset& d) { return automatic_field(d, false); }

const Field* wanted_field(const Dataset& d, const ColoringParams& p) {
  if (!p.color.empty() || p.field.none()) return nullptr;
  if (!p.field.empty()) {
    const Field& f = d.fields().require(p.field.name);
    if (f.association == Association::whole)
      fail_usage(fmt::format("field '{}' belongs to the whole dataset, not to points or cells", f.name), "field");
    return &f;
  }
  return automatic_field(d);
}

bool is_direct_color(const Field& f) {
  const int n = f.components();
  return f.role == Role::colors && (n == 3 || n == 4) && (f.array.type() == ElementType::u8 || is_float(f.array.type()));
}

}  // namespace sg
