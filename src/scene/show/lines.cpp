// SPDX-License-Identifier: Apache-2.0
#include "scene/show/lines.h"

#include "base/schema/color_params.h"
#include "color/parse_color.h"
#include "filter/mesh/surface.h"
#include "scene/show/field_color.h"

namespace sg {

void describe(Schema& s, LinesShow& p) {
  describe(s, p.coloring);
  s("opacity", p.opacity, "Opacity: 1 is opaque, 0 invisible.").range(0, 1);
  s("width", p.width, "Width of the lines.").unit("pixels").positive();
  s("lit", p.lit, "Light the lines by their direction: bright across the light, dark along it.");
  s("halo", p.halo, "Halo around each line that hides lines behind it, so that crossings show which is in front.")
      .unit("pixels")
      .range(0, 100);
  s("halo_color", p.halo_color, "Colour of the halos.").unit(color_unit);
  describe(s, p.material);
  s("specular_anisotropy", p.specular_anisotropy, "How much highlights are stretched along the line.").range(0, 1);
}

const Field* automatic_field(const LinesShow& p, const Dataset& d) { return p.material.has_color() ? nullptr : automatic_field(d); }

std::optional<Legend> add(Scene& scene, const DatasetPtr& input, const LinesShow& p, Context& context) {
  LinesItem item;
  item.data = surface_of(input, context);
  if (const auto& m = *item.data->as<SurfaceMesh>(); m.lines.size() == 0 && m.polygons.size() + m.strips.size() > 0)
    context.warn(
        "lines: the data has cells but no lines, so nothing is drawn; -f streamlines, isolines, feature_edges or contour of a flat mesh "
        "make lines; --show 'surface edges=true' draws the edges of cells");
  if (take(p.material, *input, item); !p.material.has_color() || !p.coloring.field.empty())
    item.color_by = field_color(*input, p.coloring, context);
  if (p.specular_anisotropy) {
    if (!item.made_of) item.made_of = p.material.made(input->bounds().diagonal());
    item.made_of->specular_anisotropy = *p.specular_anisotropy;
  }
  if (!p.coloring.color.empty()) item.color = parse_color(p.coloring.color, "color");
  item.opacity = p.opacity;
  item.width = p.width;
  item.lit = p.lit;
  item.halo = p.halo;
  item.halo_color = parse_color(p.halo_color, "halo_color");
  auto legend = legend_of(item.color_by);
  scene.items.emplace_back(std::move(item));
  return legend;
}

}  // namespace sg
