// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "pipeline/offline/pack/baked_colors.h"
#include "pipeline/offline/pack/flat_surface.h"
#include "pipeline/offline/pack/json_text.h"
#include "pipeline/offline/pack/pack_items.h"
#include "pipeline/offline/pack/quantize.h"
#include "render/prepare/picture_set.h"

namespace sg::offline {

Json pack_color(const raster::ColorSource& source, const FlatColors& colors, const Quality& q, const Packing& p) {
  using Kind = raster::ColorSource::Kind;
  if (source.kind == Kind::constant) return Json(Json::Members{{"kind", text("constant")}, {"rgba", numbers(source.constant)}});
  if (source.kind == Kind::direct)
    return Json(
        Json::Members{{"kind", text("direct")}, {"per_cell", Json(colors.per_cell)}, {"colors", pack_colors(colors.rgba, p.arrays)}});
  return Json(Json::Members{{"kind", text("scale")},
                            {"per_cell", Json(colors.per_cell)},
                            {"scale", Json(p.scales.add(*source.scale))},
                            {"nearest", Json(source.nearest)},
                            {"positions", pack_scale_positions(colors.positions, source.nearest ? 16 : q.value_bits, p.arrays)}});
}

Json pack_surface(const raster::PreparedItem& given, const Packing& p) {
  raster::PreparedItem item = given;
  item.color = baked_colors(given);
  FlatSurface s = flat_surface(item);
  if (s.triangles.empty()) return {};
  const size_t bytes = 4 * (s.xyz.size() + s.triangles.size() + s.normals.size() + s.corners.size() + s.colors.positions.size());
  const Quality& q = p.quality(bytes);
  if (q.cluster > 0) {
    const size_t before = s.triangles.size() / 3;
    s = clustered(s, q.cluster, item.color.nearest);
    if (s.triangles.empty()) return {};
    if (const size_t after = s.triangles.size() / 3; after < before) p.note(fmt::format("a surface of {} triangles has {}", before, after));
  }
  if (item.lic) p.note("the texture along a vector field is left out");
  if (item.pictures && item.pictures->color) p.note("a picture on a surface is shown by its colours at the surface's points");
  if (item.pictures && item.pictures->isolines) p.note("lines of equal value on a surface are left out");
  // Faces of one colour each, and faces lit by themselves, show their own small turns.
  const bool faceted = s.normals.empty() && item.material.lit;
  Json::Members m{
      {"kind", text("surface")},
      {"id", Json(uint64_t(item.id))},
      {"positions", pack_positions(s.xyz, item.triangles.origin, faceted ? std::max(16, q.position_bits) : q.position_bits, p.arrays)},
      {"triangles", Json(p.arrays.add(s.triangles, 1))},
      {"color", pack_color(item.color, s.colors, q, p)},
      {"opacity", Json(double(item.opacity))},
      {"translucent", Json(item.translucent)},
      {"material", numbers({item.material.ambient, item.material.diffuse, item.material.specular, item.material.power})},
      {"lit", Json(item.material.lit)}};
  if (!s.normals.empty() && item.material.lit) {
    m.emplace_back("normals", pack_normals(s.normals, q.normal_bits, p.arrays));
    if (!s.corners.empty()) m.emplace_back("corners", Json(p.arrays.add(s.corners, 1)));
  }
  return Json(std::move(m));
}

}  // namespace sg::offline
