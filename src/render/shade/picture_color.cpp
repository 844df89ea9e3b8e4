// SPDX-License-Identifier: Apache-2.0
#include "render/shade/picture_color.h"

#include <algorithm>
#include <cmath>

namespace sg::raster {

namespace {

/// The weights of the second and third corner, and how they change from pixel to pixel.
struct Moves {
  Vec2 right, down;
};

Moves moves_on(const TriangleSet& triangles, const uint32_t* t, const PictureRay& ray) {
  const auto corner = [&](int k) {
    const float* p = triangles.xyz() + 3 * size_t(t[k]);
    return Vec3(double(p[0]), double(p[1]), double(p[2]));
  };
  const Vec3 first = corner(0), e1 = corner(1) - first, e2 = corner(2) - first, normal = cross(e1, e2);
  const double n2 = dot(normal, normal), steep = dot(normal, ray.direction);
  // Along the ray into the plane, and from there to weights.
  const auto moved = [&](Vec3 step) {
    const Vec3 in_plane = step - ray.direction * (dot(normal, step) / steep);
    return Vec2{dot(cross(in_plane, e2), normal) / n2, dot(cross(e1, in_plane), normal) / n2};
  };
  return {moved(ray.right), moved(ray.down)};
}

/// Share of the pixel that lines cover. Where they would lie closer than a few pixels they fade: all of them would be a dark surface.
float line_cover(const IsolineSet& lines, const TriangleSet& triangles, size_t triangle, const PictureRay& ray) {
  if (ray.right == Vec3() && ray.down == Vec3()) return 0;
  const uint32_t* t = triangles.indices() + 3 * triangle;
  const auto value = [&](int k) { return double(lines.data()[t[k]]); };
  const double a = value(0), b = value(1) - a, c = value(2) - a, v = a + b * ray.weights[1] + c * ray.weights[2];
  const Moves m = moves_on(triangles, t, ray);
  const double right = b * m.right.x + c * m.right.y, down = b * m.down.x + c * m.down.y, slope = std::hypot(right, down) * ray.per_pixel;
  if (!(slope > 0) || !std::isfinite(v + slope)) return 0;
  const auto above = std::lower_bound(lines.levels.begin(), lines.levels.end(), float(v));
  double off = HUGE_VAL, room = HUGE_VAL;
  if (above != lines.levels.end()) off = double(*above) - v;
  if (above != lines.levels.begin()) off = std::min(off, v - double(above[-1]));
  if (above != lines.levels.end() && above != lines.levels.begin()) room = double(*above) - double(above[-1]);
  constexpr double closest = 2, full = 5;  // pixels from line to line
  const double fade = std::clamp((room / slope - closest) / (full - closest), 0.0, 1.0);
  return float(std::clamp(double(lines.width) / 2 + 0.5 - off / slope, 0.0, std::min(1.0, double(lines.width))) * fade);
}

}  // namespace

TexturePlace place_in(const PlacedPicture& picture, const TriangleSet& triangles, size_t triangle, const PictureRay& ray) {
  const uint32_t* t = triangles.indices() + 3 * triangle;
  const auto uv = [&](int k) {
    const float* p = picture.uv() + 2 * size_t(t[k]);
    return Vec2{double(p[0]), double(p[1])};
  };
  const Vec2 a = uv(0), b = uv(1) - a, c = uv(2) - a;
  TexturePlace place;
  place.at = a + b * ray.weights[1] + c * ray.weights[2];
  if (ray.right == Vec3() && ray.down == Vec3()) return place;
  const Moves m = moves_on(triangles, t, ray);
  place.right = b * m.right.x + c * m.right.y, place.down = b * m.down.x + c * m.down.y;
  return place;
}

Vec4f under_picture(const PictureSet& pictures, const TexturePlace& place, Vec4f rgba) {
  using Alpha = SurfacePictures::Alpha;
  for (int k = 0; k < 3; ++k) rgba[k] *= pictures.tint[k];
  if (!pictures.color) {
    if (pictures.alpha == Alpha::cutout) rgba.w = rgba.w < pictures.cutoff ? 0.f : 1.f;
    return rgba;
  }
  if (!std::isfinite(place.at.x + place.at.y)) return rgba;  // corners without coordinates
  const Vec4f seen = pictures.color->lookup(*pictures.color->texture, place);
  if (seen.w > 0)
    for (int k = 0; k < 3; ++k) rgba[k] *= seen[k] / seen.w;
  switch (pictures.alpha) {
    case Alpha::none: break;
    case Alpha::coverage: rgba.w *= seen.w; break;
    case Alpha::cutout: rgba.w = rgba.w * seen.w < pictures.cutoff ? 0.f : 1.f; break;
  }
  return rgba;
}

Vec4f picture_color(const PictureSet& pictures, const TriangleSet& triangles, size_t triangle, const PictureRay& ray, Vec4f rgba) {
  rgba = under_picture(pictures, pictures.color ? place_in(*pictures.color, triangles, triangle, ray) : TexturePlace(), rgba);
  if (!pictures.isolines) return rgba;
  const float line = line_cover(*pictures.isolines, triangles, triangle, ray);
  for (int k = 0; k < 3; ++k) rgba[k] += line * (pictures.isolines->color[k] - rgba[k]);
  return rgba;
}

}  // namespace sg::raster
