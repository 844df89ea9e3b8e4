// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/surface_color.h"

#include <algorithm>
#include <array>

#include "render/prepare/glyph_set.h"
#include "render/shade/picture_normal.h"

namespace sg::trace {

namespace {

using raster::ColorSource;
using raster::PreparedItem;

/// Points whose values are mixed, or the cell.
struct Places {
  std::array<size_t, 3> points{};
  std::array<float, 3> weights{};
  int count = 0;
  size_t cell = 0;
};

Places places_of(const PreparedItem& item, const Hit& hit) {
  const size_t p = hit.primitive;
  Places at;
  if (item.glyphs) return {{p >> item.glyphs->shift}, {1}, 1, p >> item.glyphs->shift};
  switch (item.kind) {
    case PreparedItem::Kind::surface: {
      const uint32_t* t = item.triangles.indices() + 3 * p;
      return {{t[0], t[1], t[2]}, {1 - hit.u - hit.v, hit.u, hit.v}, 3, item.triangles.cell(p)};
    }
    case PreparedItem::Kind::lines: {
      const auto& s = *item.segments;
      return {{s.points[2 * p], s.points[2 * p + 1]}, {1 - hit.u, hit.u}, 2, s.cells.empty() ? p : s.cells[p]};
    }
    case PreparedItem::Kind::points: {
      const size_t point = item.points ? (*item.points)[p] : p;
      return {{point}, {1}, 1, point};
    }
  }
  return at;
}

float value_at(const ColorSource& color, const Places& at, size_t stride, size_t k) {
  const auto value = [&](size_t i) { return color.data()[i * stride + k]; };
  if (color.per_cell) return value(at.cell);
  const auto nearest = size_t(std::max_element(at.weights.begin(), at.weights.begin() + at.count) - at.weights.begin());
  if (color.nearest || at.count == 1) return value(at.points[nearest]);
  float sum = 0, lo = value(at.points[0]), hi = lo;
  for (size_t i = 0; i < size_t(at.count); ++i) {
    const float v = value(at.points[i]);
    sum += v * at.weights[i], lo = std::min(lo, v), hi = std::max(hi, v);
  }
  // Rounding must not push it across an end of the scale that the corners lie on.
  return sum != sum ? sum : std::clamp(sum, lo, hi);
}

raster::PictureRay picture_ray(const Ray& ray, const Hit& hit, const RayFootprint& footprint, double scale) {
  raster::PictureRay at;
  at.per_pixel = double(RayFootprint::paths_across);
  at.direction = Vec3(ray.direction);
  at.right = Vec3(footprint.right_at(hit.t)) / scale, at.down = Vec3(footprint.down_at(hit.t)) / scale;
  at.weights[0] = 1 - double(hit.u) - double(hit.v), at.weights[1] = double(hit.u), at.weights[2] = double(hit.v);
  return at;
}

}  // namespace

Vec4f surface_color(const PreparedItem& item, const Ray& ray, const Hit& hit, const RayFootprint& footprint, double scale) {
  const ColorSource& color = item.color;
  Vec4f rgba = color.constant;
  if (color.kind != ColorSource::Kind::constant) {
    const Places at = places_of(item, hit);
    if (color.kind == ColorSource::Kind::scalar) rgba = color.of(value_at(color, at, 1, 0));
    else
      for (size_t k = 0; k < 4; ++k) rgba[int(k)] = value_at(color, at, 4, k);
  }
  if (item.pictures) rgba = picture_color(*item.pictures, item.triangles, hit.primitive, picture_ray(ray, hit, footprint, scale), rgba);
  rgba.w *= item.opacity;
  return rgba;
}

Vec4f surface_picture(const raster::PlacedPicture& picture, const PreparedItem& item, const Ray& ray, const Hit& hit,
                      const RayFootprint& footprint, double scale) {
  return picture.lookup(*picture.texture, place_in(picture, item.triangles, hit.primitive, picture_ray(ray, hit, footprint, scale)));
}

Vec3f surface_direction(const raster::PictureSet& pictures, const PreparedItem& item, const Hit& hit) {
  const auto* all = reinterpret_cast<const float*>(pictures.stretched_along.raw());
  const Places at = places_of(item, hit);
  Vec3f sum;
  for (size_t i = 0; i < size_t(at.count); ++i) {
    const float* d = all + 3 * at.points[i];
    sum += Vec3f(d[0], d[1], d[2]) * at.weights[i];
  }
  return sum;
}

Vec3f surface_normal(const PreparedItem& item, const Ray& ray, const Hit& hit, const RayFootprint& footprint, double scale, Vec3f normal) {
  const raster::PictureSet& pictures = *item.pictures;
  return Vec3f(picture_normal(*pictures.normal, pictures.normal_scale, item.triangles, hit.primitive,
                              picture_ray(ray, hit, footprint, scale), Vec3(normal)));
}

}  // namespace sg::trace
