// SPDX-License-Identifier: Apache-2.0
#include "scene/show/outline.h"

#include "base/schema/color_params.h"
#include "color/parse_color.h"

namespace sg {

void describe(Schema& s, OutlineShow& p) {
  s("color", p.color, "Colour of the box.").unit(color_unit);
  s("width", p.width, "Width of the lines.").unit("pixels").positive();
}

// The twelve edges of a uniform grid's own box (turned with it), or of the bounds.
std::optional<Legend> add(Scene& scene, const DatasetPtr& input, const OutlineShow& p, Context&) {
  const Box3 box = input->bounds();
  if (box.empty()) return {};
  Vec3 corner[8];
  const auto* grid = input->as<UniformGrid>();
  for (int c = 0; c < 8; ++c) {
    if (grid) {
      const Vec3 index{c & 1 ? double(grid->dims[0] - 1) : 0.0, c & 2 ? double(grid->dims[1] - 1) : 0.0,
                       c & 4 ? double(grid->dims[2] - 1) : 0.0};
      corner[c] = grid->origin + grid->direction * (grid->spacing * index);
    } else {
      corner[c] = {c & 1 ? box.hi.x : box.lo.x, c & 2 ? box.hi.y : box.lo.y, c & 4 ? box.hi.z : box.lo.z};
    }
  }
  SurfaceMesh mesh;
  std::vector<float> xyz;
  mesh.points.origin = box.center();
  for (const Vec3& v : corner)
    for (int a = 0; a < 3; ++a) xyz.push_back(float(v[a] - mesh.points.origin[a]));
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  std::vector<int32_t> ends;
  for (int c = 0; c < 8; ++c)
    for (int bit : {1, 2, 4})
      if (!(c & bit) && !(corner[c] == corner[c | bit])) ends.insert(ends.end(), {c, c | bit});
  mesh.lines.fixed = 2;
  mesh.lines.connectivity = Array::from_vector(std::move(ends));
  LinesItem item;
  item.data = make_dataset(std::move(mesh));
  item.color = parse_color(p.color, "color");
  item.width = p.width;
  scene.items.emplace_back(std::move(item));
  return {};
}

}  // namespace sg
