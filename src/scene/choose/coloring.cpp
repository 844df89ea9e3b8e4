// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/coloring.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"

namespace sg {

void describe(Schema& s, ColoringParams& p) {
  s("field", p.field, "Field to colour by; default: the active scalar; 'none' for one colour.");
  s("component", p.component, "Component of a field with several; -1 is the magnitude.").range(-1, 1e6);
  s("map", p.map, "Colour map (see: sightglass colormap), or a file: FILE.cpt, FILE.json:NAME; 'auto' chooses by the data.");
  s("range", p.range, "Values at the two ends of the map; default: the range of the data.").unit("@field");
  s("scale", p.scale, "How values are mapped to colours.");
  s("linear_threshold", p.linear_threshold, "symlog: linear between minus and plus this; 0: a thousandth of the range.").at_least(0);
  s("below", p.below, "Colour of values below the range; default: the first colour.");
  s("above", p.above, "Colour of values above the range; default: the last colour.");
  s("nan", p.nan, "Colour where there is no value.");
  s("clamp", p.clamp, "Clamp values outside the range to the end colours; false leaves them out of the picture.");
  s("color", p.color, "One colour instead of a field: #rrggbb, r,g,b or a name.");
}

namespace {

// Ids: 5, 6, 7, ... in the order of the points or cells, or a name that says so; textures, which go with the colours of another field.
bool is_numbering(const Field& f) {
  if (f.components() != 1) return false;
  if (f.look.texture) return true;
  const std::string name = to_lower(f.name);
  for (std::string_view end : {"id", "ids", "nodenums", "elemnums", "number", "valid"})
    if (name.ends_with(end)) return true;
  const size_t n = std::min<size_t>(f.array.count(), 1000);
  if (n < 16) return false;
  for (size_t i = 1; i < n; ++i)
    if (f.array.get(i) != f.array.get(i - 1) + 1) return false;
  return true;
}

}  // namespace

const Field* automatic_field(const Dataset& d) {
  // A field that is the same everywhere (a contour's own field) says nothing in colour.
  auto varies = [&](const Field& f) {
    const Range r = d.range(f);
    return r.empty() || r.lo < r.hi;
  };
  auto plain = [](Role r) { return r != Role::normals && r != Role::tcoords && r != Role::global_ids; };
  if (const Field* f = d.fields().result(); f && f->association != Association::whole && f->role != Role::global_ids && varies(*f))
    return f;
  for (const Field& f : d.fields())
    if (f.look.bands) return &f;
  if (const Field* f = d.fields().with_role(Role::scalars); f && f->components() == 1 && varies(*f)) return f;
  if (const Field* f = d.fields().with_role(Role::colors)) return f;
  for (const bool numberings : {false, true})
    for (int components : {1, 3})
      for (Association a : {Association::point, Association::cell})
        for (const Field& f : d.fields())
          if (f.association == a && f.components() == components && plain(f.role) && is_numbering(f) == numberings && varies(f)) return &f;
  return nullptr;
}

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
