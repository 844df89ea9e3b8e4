// SPDX-License-Identifier: Apache-2.0
#include "scene/show/points.h"

#include "color/parse_color.h"
#include "scene/show/field_color.h"

namespace sg {

void describe(Schema& s, PointsShow& p) {
  describe(s, p.coloring);
  s("opacity", p.opacity, "Opacity: 1 is opaque, 0 invisible.").range(0, 1);
  s("size", p.size, "Diameter of the dots.").unit("pixels").positive();
  s("discs", p.discs, "Draw points that have normals and a field 'radius' as discs in space (see surfels) that hide what is behind.");
  describe(s, p.material);
}

const Field* automatic_field(const PointsShow& p, const Dataset& d) { return p.material.has_color() ? nullptr : automatic_field(d); }

std::optional<Legend> add(Scene& scene, const DatasetPtr& input, const PointsShow& p, Context& context) {
  PointsItem item;
  item.data = input, item.color = lone_color;
  if (take(p.material, *input, item); !p.material.has_color() || !p.coloring.field.empty())
    item.color_by = field_color(*input, p.coloring, context);
  if (item.color_by && item.color_by->association == Association::cell) {
    context.info("points are coloured by point fields; cell field '" + item.color_by->field + "' is not shown on them");
    item.color_by.reset();
  }
  if (const Field* normals = input->fields().with_role(Role::normals), *radius = input->fields().find("radius", Association::point);
      p.discs && p.opacity >= 1 && normals && normals->association == Association::point && normals->components() == 3 && radius &&
      radius->components() == 1) {
    item.disc_normals = normals->name, item.disc_radius = radius->name;
    if (!p.material.has_color()) item.color = SurfaceItem().color;
  }
  if (!p.coloring.color.empty()) item.color = parse_color(p.coloring.color, "color");
  item.opacity = p.opacity;
  item.size = p.size;
  auto legend = legend_of(item.color_by);
  scene.items.emplace_back(std::move(item));
  return legend;
}

}  // namespace sg
