// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "pipeline/offline/pack/flat_surface.h"
#include "pipeline/offline/pack/json_text.h"
#include "pipeline/offline/pack/pack_items.h"
#include "pipeline/offline/pack/quantize.h"
#include "render/prepare/glyph_set.h"

namespace sg::offline {

namespace {

// Corners of triangles with their normals, three numbers each, or the ends of lines.
Json pack_shape(const raster::GlyphShape& s, bool lines, ArrayStore& store) {
  std::vector<float> xyz, normals;
  const auto add_point = [&](uint32_t p) { xyz.push_back(s.x[p]), xyz.push_back(s.y[p]), xyz.push_back(s.z[p]); };
  if (lines) {
    for (const uint32_t p : s.segments.points) add_point(p);
    return Json(Json::Members{{"positions", Json(store.add(xyz, 3))}});
  }
  for (size_t i = 0; i < 3 * s.triangles; ++i) {
    const uint32_t p = s.triangle_list[i];
    const float* f = &s.faces[raster::GlyphShape::row * (i / 3)];
    add_point(p);
    for (int r = 0; r < 3; ++r) normals.push_back(f[3 + r] + f[6 + 3 * r] * s.x[p] + f[7 + 3 * r] * s.y[p] + f[8 + 3 * r] * s.z[p]);
  }
  return Json(Json::Members{{"positions", Json(store.add(xyz, 3))}, {"normals", Json(store.add(normals, 3))}});
}

}  // namespace

Json pack_glyphs(const raster::PreparedItem& item, const Packing& p) {
  const raster::GlyphSet& set = *item.glyphs;
  const GlyphInstances& instances = *set.instances;
  const Quality& q = p.quality(instances.standing * 52);
  const size_t every = std::max<size_t>(1, size_t(std::lround(1 / q.marks)));
  std::vector<uint32_t> chosen;
  size_t nth = 0;
  for (size_t i = 0; i < instances.count(); ++i)
    if (instances.stands(i) && nth++ % every == 0) chosen.push_back(uint32_t(i));
  if (chosen.empty()) return {};
  if (every > 1) p.note(fmt::format("of {} glyphs one of {} is there", instances.standing, every));
  std::vector<float> places, matrix;
  std::vector<uint8_t> shapes;
  float most = 0;
  for (const uint32_t i : chosen) {
    const float* m = instances.data() + 12 * size_t(i);
    for (int r = 0; r < 3; ++r) {
      places.push_back(m[4 * r + 3]);
      for (int c = 0; c < 3; ++c) matrix.push_back(m[4 * r + c]), most = std::max(most, std::abs(m[4 * r + c]));
    }
    if (instances.shape_numbers()) shapes.push_back(instances.shape_numbers()[i]);
  }
  constexpr double full = 32767;
  std::vector<uint16_t> codes(matrix.size());
  for (size_t i = 0; i < matrix.size(); ++i)
    codes[i] = uint16_t(full + std::lround(most > 0 ? double(matrix[i]) / double(most) * full : 0));
  const bool lines = item.kind == raster::PreparedItem::Kind::lines;
  std::vector<Json> packed;
  for (const auto& shape : set.shapes) packed.push_back(pack_shape(*shape, lines, p.arrays));
  Json::Members m{{"kind", text(lines ? "glyph_lines" : "glyphs")},
                  {"id", Json(uint64_t(item.id))},
                  {"places", pack_positions(places, item.origin, q.position_bits, p.arrays)},
                  {"matrices", Json(p.arrays.add(codes, 9))},
                  {"largest", Json(double(most) / full)},
                  {"shapes", Json(std::move(packed))},
                  {"in_pixels", Json(set.in_pixels)},
                  {"color", pack_color(item.color, flat_colors(item.color, chosen), q, p)},
                  {"opacity", Json(double(item.opacity))},
                  {"translucent", Json(item.translucent)},
                  {"width", Json(item.width)},
                  {"material", numbers({item.material.ambient, item.material.diffuse, item.material.specular, item.material.power})},
                  {"lit", Json(item.material.lit)}};
  if (!shapes.empty()) m.emplace_back("choice", Json(p.arrays.add(shapes, 1)));
  return Json(std::move(m));
}

Json pack_item(const raster::PreparedItem& item, const Packing& p) {
  if (item.glyphs) return pack_glyphs(item, p);
  switch (item.kind) {
    case raster::PreparedItem::Kind::surface: return pack_surface(item, p);
    case raster::PreparedItem::Kind::lines: return pack_lines(item, p);
    default: return pack_points(item, p);
  }
}

void Packing::note(const std::string& text) const {
  if (std::find(notes.begin(), notes.end(), text) == notes.end()) notes.push_back(text);
}

}  // namespace sg::offline
