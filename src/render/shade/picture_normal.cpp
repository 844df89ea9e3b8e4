// SPDX-License-Identifier: Apache-2.0
#include "render/shade/picture_normal.h"

#include <cmath>

namespace sg::raster {

namespace {

/// How the place changes with the picture's coordinates, times the square of their area on the triangle: directions are all that is wanted.
struct Rise {
  Vec3 along_x, along_y;
};

Rise rise_on(const PlacedPicture& picture, const uint32_t* t, Vec3 e1, Vec3 e2) {
  const auto uv = [&](int k) {
    const float* p = picture.uv() + 2 * size_t(t[k]);
    return Vec2{double(p[0]), double(p[1])};
  };
  const Vec2 a = uv(0), b = uv(1) - a, c = uv(2) - a;
  const double area = b.x * c.y - b.y * c.x;
  return {(e1 * c.y - e2 * b.y) * area, (e2 * b.x - e1 * c.x) * area};
}

}  // namespace

Vec3 picture_normal(const PlacedPicture& picture, float scale, const TriangleSet& triangles, size_t triangle, const PictureRay& ray,
                    Vec3 normal) {
  const uint32_t* t = triangles.indices() + 3 * triangle;
  const auto corner = [&](int k) {
    const float* p = triangles.xyz() + 3 * size_t(t[k]);
    return Vec3(double(p[0]), double(p[1]), double(p[2]));
  };
  const Vec3 first = corner(0), e1 = corner(1) - first, e2 = corner(2) - first;
  const Rise rise = rise_on(picture, t, e1, e2);
  Vec3 x = rise.along_x - normal * dot(normal, rise.along_x);
  const TexturePlace place = place_in(picture, triangles, triangle, ray);
  if (!(dot(x, x) > 0) || !std::isfinite(dot(x, x) + place.at.x + place.at.y)) return normal;
  const Vec4f texel = picture.lookup(*picture.texture, place);
  if (!(texel.w > 0)) return normal;
  x = normalize(x);
  Vec3 y = cross(normal, x);
  if (dot(y, rise.along_y) < 0) y = -y;
  const auto signed_of = [&](int k) { return 2 * double(texel[k]) / double(texel.w) - 1; };
  Vec3 bent = x * (double(scale) * signed_of(0)) + y * (double(scale) * signed_of(1)) + normal * signed_of(2);
  if (!(dot(bent, bent) > 1e-12)) return normal;
  bent = normalize(bent);
  // Light from below the triangle does not come through it, whatever the picture says.
  constexpr double least = 0.02;
  Vec3 face = normalize(cross(e1, e2));
  if (dot(face, normal) < 0) face = -face;
  const double above = dot(bent, face);
  return above >= least ? bent : normalize(bent + face * (least - above));
}

}  // namespace sg::raster
