// SPDX-License-Identifier: Apache-2.0
#include "scene/show/own_look.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <span>

#include "base/error.h"
#include "data/field_ops.h"
#include "data/memory/memory_budget.h"
#include "image/image.h"
#include "image/texture/texture_file.h"
#include "scene/choose/own_materials.h"
#include "scene/items/surface_pictures.h"

namespace sg {

namespace {

std::shared_ptr<const Texture> texture_of(const PictureFile& file, TexelEncoding encoding, bool alpha) {
  const std::string key = fmt::format("texture/{}/{}", int(encoding), alpha);
  if (auto kept = file.memo->find<Texture>(key)) return kept;
  need_memory(texture_memory(file.bytes), "a picture on a surface", file.name, "make it smaller");
  Texture t = decode_texture(file.bytes, file.name, encoding, alpha);
  const size_t bytes = t.bytes();
  return file.memo->keep<Texture>(key, std::move(t), bytes);
}

TextureWrap wrap_of(MaterialPicture::Beyond beyond) {
  switch (beyond) {
    case MaterialPicture::Beyond::repeat: break;
    case MaterialPicture::Beyond::mirror: return TextureWrap::mirror;
    case MaterialPicture::Beyond::clamp: return TextureWrap::clamp;
  }
  return TextureWrap::repeat;
}

std::optional<SurfacePicture> picture_on(const Dataset& d, const MaterialPicture& p, TexelEncoding encoding, bool alpha, Context& context) {
  if (!p.file) return {};
  const Field* f = nullptr;
  for (const Field& g : d.fields())
    if (!f && g.association == Association::point && g.components() >= 2 &&
        (p.coordinates.empty() ? g.role == Role::tcoords : g.name == p.coordinates))
      f = &g;
  if (!f) {
    context.warn(fmt::format("the picture '{}' is left out: the surface has no texture coordinates{}", p.file->name,
                             p.coordinates.empty() ? "" : fmt::format(" '{}'", p.coordinates)));
    return {};
  }
  try {
    SurfacePicture on{texture_of(*p.file, encoding, alpha), f->name, {}, p.place, {}};
    on.lookup.wrap_u = wrap_of(p.beyond_u), on.lookup.wrap_v = wrap_of(p.beyond_v), on.lookup.sharp = p.nearest;
    return on;
  } catch (const Error& e) {
    context.warn(fmt::format("a picture is left out: {}", e.what()));
    return {};
  }
}

/// Null without any. `tinted`: multiplied with the material's colour, too.
std::shared_ptr<const SurfacePictures> pictures_of(const MaterialLook& l, const Dataset& d, bool tinted, Context& context) {
  using Alpha = SurfacePictures::Alpha;
  auto p = std::make_shared<SurfacePictures>();
  if (tinted) p->tint = l.base_color;
  p->alpha = l.alpha == MaterialLook::Alpha::opaque ? Alpha::none : l.alpha == MaterialLook::Alpha::mask ? Alpha::cutout : Alpha::coverage;
  p->cutoff = l.opacity > 0 ? l.alpha_cutoff / l.opacity : 2;  // the picture's alpha counts times the material's
  p->color = picture_on(d, l.base_picture, TexelEncoding::srgb, p->alpha != Alpha::none, context);
  for (const FactorPicture& f : l.factors)
    if (auto on = picture_on(d, f.picture, TexelEncoding::linear, false, context)) p->factors.push_back({std::move(*on), f.channels});
  p->normal = picture_on(d, l.normal_picture, TexelEncoding::linear, false, context), p->normal_scale = l.normal_scale;
  p->occlusion = picture_on(d, l.occlusion_picture, TexelEncoding::linear, false, context), p->occlusion_strength = l.occlusion_strength;
  p->emission = picture_on(d, l.emission_picture, TexelEncoding::srgb, false, context);
  const bool any = p->color || !p->factors.empty() || p->normal || p->occlusion || p->emission || tinted || !(l.emission == Vec3f());
  return any ? p : nullptr;
}

SurfaceMaterial matter_of(const MaterialLook& l) {
  const auto share = [](float v) { return std::clamp(double(v), 0.0, 1.0); };
  SurfaceMaterial m;
  m.base_color = {1, 1, 1};
  m.base_metalness = share(l.metallic), m.specular_roughness = share(l.roughness);
  m.specular_ior = std::clamp(double(l.ior), 1.0, 4.0);
  m.transmission_weight = share(l.transmission), m.coat_weight = share(l.coat), m.coat_roughness = share(l.coat_roughness);
  m.emission = Vec3(l.emission);
  m.thin_walled = l.transmission > 0 && l.thin;
  if (!m.thin_walled && l.attenuation_distance > 0)
    m.transmission_color = Vec3(l.attenuation_color), m.transmission_depth = double(l.attenuation_distance);
  else if (l.transmission > 0) m.transmission_color = Vec3(l.base_color);
  return m;
}

/// The polygons and strips of each number, in rising order. Kept with the data.
using CellsByNumber = std::map<int64_t, std::vector<int64_t>>;
std::shared_ptr<const CellsByNumber> cells_by_number(const DatasetPtr& data, const Field& numbers) {
  const std::string key = "cells by material";
  if (auto kept = data->memo().find<CellsByNumber>(key)) return kept;
  const SurfaceMesh& mesh = *data->as<SurfaceMesh>();
  const size_t first = mesh.vertices.size() + mesh.lines.size(), last = first + mesh.polygons.size() + mesh.strips.size();
  CellsByNumber cells;
  std::vector<int64_t>* list = nullptr;
  int64_t before = 0;
  for (size_t c = first; c < last; ++c) {
    const int64_t n = material_number(numbers, c);
    if (!list || n != before) list = &cells[n], before = n;
    list->push_back(int64_t(c));
  }
  return data->memo().keep<CellsByNumber>(key, std::move(cells), (last - first) * sizeof(int64_t));
}

/// Those of one number; the points of all.
DatasetPtr polygons_of(const DatasetPtr& data, int64_t number, std::span<const int64_t> cells) {
  const std::string key = fmt::format("polygons of material {}", number);
  struct Kept {
    DatasetPtr data;
  };
  if (const auto kept = data->memo().find<Kept>(key)) return kept->data;
  const SurfaceMesh& from = *data->as<SurfaceMesh>();
  const int64_t first = int64_t(from.vertices.size() + from.lines.size()), strips = first + int64_t(from.polygons.size());
  const auto chosen = [&](const CellArray& list, int64_t begin, int64_t end) {
    const CellsView v = cells_view(list);
    std::vector<int32_t> ids, offsets{0};
    for (const int64_t cell : cells) {
      if (cell < begin || cell >= end) continue;
      const auto c = size_t(cell - begin);
      for (size_t k = 0; k < v.size(c); ++k) ids.push_back(int32_t(v.point(c, k)));
      offsets.push_back(int32_t(ids.size()));
    }
    CellArray out;
    if (offsets.size() == 1) return out;
    out.connectivity = Array::from_vector(std::move(ids)), out.offsets = Array::from_vector(std::move(offsets));
    return out;
  };
  SurfaceMesh mesh;
  mesh.points = from.points, mesh.polygons = chosen(from.polygons, first, strips),
  mesh.strips = chosen(from.strips, strips, strips + int64_t(from.strips.size()));
  DatasetParts parts;
  parts.point_ghost = data->point_ghost();
  if (!data->cell_ghost().empty()) parts.cell_ghost = gather(data->cell_ghost(), cells);
  for (const Field& f : data->fields())
    if (f.association != Association::cell) parts.fields.add(f);
  carry_gathered(parts.fields, data->fields(), Association::cell, cells, Association::cell);
  const size_t bytes = mesh.polygons.connectivity.bytes() + mesh.strips.connectivity.bytes();
  parts.mesh = std::move(mesh);
  return data->memo().keep<Kept>(key, {make_dataset(std::move(parts))}, bytes)->data;
}

}  // namespace

std::vector<SurfaceItem> items_of_materials(const SurfaceItem& like, Context& context) {
  const Field* numbers = material_numbers(*like.data);
  if (!numbers || !like.data->as<SurfaceMesh>()) return {like};
  const auto& looks = numbers->materials->looks;
  const auto all = cells_by_number(like.data, *numbers);
  if (constexpr size_t most = 256; all->size() > most) {
    context.warn(
        fmt::format("its {} materials are more than are drawn by themselves ({} at most): their pictures are left out", all->size(), most));
    return {like};
  }
  std::vector<SurfaceItem> items;
  for (const auto& [number, cells] : *all) {
    SurfaceItem item = like;
    if (all->size() > 1) item.data = polygons_of(like.data, number, cells), item.part_of = like.data, item.edge_lines = nullptr;
    if (const auto at = looks.find(number); at != looks.end()) {
      const MaterialLook& look = at->second;
      item.pictures = pictures_of(look, *item.data, item.color_by.has_value(), context), item.made_of = matter_of(look);
      if (item.color_by) {
        item.color = {1, 1, 1};
      } else {
        const Vec3f c = look.base_color;
        item.color = {srgb_encode(c.x), srgb_encode(c.y), srgb_encode(c.z)};
      }
      if (look.alpha == MaterialLook::Alpha::blend) item.opacity *= std::clamp(double(look.opacity), 0.0, 1.0);
    }
    items.push_back(std::move(item));
  }
  return items;
}

}  // namespace sg
