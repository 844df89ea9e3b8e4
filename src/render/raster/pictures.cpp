// SPDX-License-Identifier: Apache-2.0
#include "render/raster/pictures.h"

#include <algorithm>
#include <cmath>

#include "render/shade/blinn_phong.h"
#include "render/shade/picture_normal.h"

namespace sg::raster {

namespace {

Vec3 three(const float* a) { return Vec3(a[0], a[1], a[2]); }

/// Where the ray of a pixel meets the plane of its triangle, held inside.
void weigh(const TriangleSet& triangles, const uint32_t* t, Vec3 start, Vec3 ray, double* weights) {
  const Vec3 p0 = three(triangles.xyz() + 3 * size_t(t[0])), p1 = three(triangles.xyz() + 3 * size_t(t[1])),
             p2 = three(triangles.xyz() + 3 * size_t(t[2]));
  const Vec3 normal = cross(p1 - p0, p2 - p0), hit = start + ray * (dot(p0 - start, normal) / dot(ray, normal));
  const double area = dot(normal, normal);
  weights[0] = dot(cross(p1 - hit, p2 - hit), normal) / area, weights[1] = dot(cross(p2 - hit, p0 - hit), normal) / area;
  weights[2] = dot(cross(p0 - hit, p1 - hit), normal) / area;
  double sum = 0;
  for (int k = 0; k < 3; ++k) weights[k] = std::isfinite(weights[k]) ? std::max(weights[k], 0.0) : 1.0 / 3, sum += weights[k];
  for (int k = 0; k < 3; ++k) weights[k] /= sum;
}

/// The smooth normal on the side that the triangle winds about.
Vec3 normal_of(const PreparedItem& item, size_t triangle, const double* weights) {
  const TriangleSet& set = item.triangles;
  const uint32_t* t = set.indices() + 3 * triangle;
  const auto corner = [&](int k) { return three(set.xyz() + 3 * size_t(t[k])); };
  const Vec3 face = normalize(cross(corner(1) - corner(0), corner(2) - corner(0)));
  if (item.normals.normals.empty()) return face;
  const auto* all = reinterpret_cast<const float*>(item.normals.normals.raw());
  const uint32_t* n = item.normals.corners.empty() ? t : reinterpret_cast<const uint32_t*>(item.normals.corners.raw()) + 3 * triangle;
  Vec3 sum;
  for (int k = 0; k < 3; ++k) sum += three(all + 3 * size_t(n[k])) * weights[k];
  const double l2 = dot(sum, sum);
  if (!(l2 > 0) || !std::isfinite(l2)) return face;
  return sum * ((dot(sum, face) < 0 ? -1 : 1) / std::sqrt(l2));
}

/// The light on the bent surface, in the place of that on the smooth one.
void relight(const PreparedItem& item, size_t triangle, const PictureRay& ray, std::span<const Lamp> lamps, float& light, float& gloss) {
  const Vec3 smooth = normal_of(item, triangle, ray.weights), to_viewer = normalize(-ray.direction);
  Vec3 bent = picture_normal(*item.pictures->normal, item.pictures->normal_scale, item.triangles, triangle, ray, smooth);
  if (dot(smooth, to_viewer) < 0) bent = -bent;  // seen from the back
  light_point(item.material, lamps, Vec3f(bent), Vec3f(to_viewer), light, gloss);
}

}  // namespace

void draw_pictures(const PreparedItem& item, const EyeView& v, double pixel_scale, std::span<const Lamp> lamps, ShadeBatch& b) {
  const PictureSet& pictures = *item.pictures;
  const Vec3 eye = three(v.hi) + three(v.lo), forward = three(v.forward), right = three(v.right), up = three(v.up);
  const double pixel = 1 / double(v.scale);  // at depth 1 in perspective
  for (size_t i = 0; i < b.n; ++i) {
    const double x = (double(b.tile_x) + b.pixel[i] % tile_size + 0.5 - double(v.center_x)) * pixel,
                 y = (double(v.center_y) - (double(b.tile_y) + b.pixel[i] / tile_size + 0.5)) * pixel;
    const Vec3 side = right * x + up * y, start = v.parallel ? eye + side : eye;
    PictureRay ray;
    ray.direction = v.parallel ? forward : forward + side;
    const double size = v.parallel ? pixel : pixel * double(b.depth[i]);
    ray.right = right * size, ray.down = up * -size, ray.per_pixel = pixel_scale;
    const size_t triangle = b.triangle[i];
    weigh(item.triangles, item.triangles.indices() + 3 * triangle, start, ray.direction, ray.weights);
    const Vec4f own{b.rgba[0][i], b.rgba[1][i], b.rgba[2][i], b.rgba[3][i]};
    const Vec4f seen = picture_color(pictures, item.triangles, triangle, ray, own);
    for (int k = 0; k < 4; ++k) b.rgba[k][i] = seen[k];
    if (pictures.normal && item.material.lit) relight(item, triangle, ray, lamps, b.light[i], b.gloss[i]);
    if (const auto& map = pictures.occlusion; map && item.material.lit) {
      const float open = map->lookup(*map->texture, place_in(*map, item.triangles, triangle, ray)).x;
      b.light[i] -= item.material.ambient * pictures.occlusion_strength * (1 - std::clamp(open, 0.f, 1.f));
    }
    if (!item.made_of || item.made_of->emission == Vec3()) continue;
    // What shines by itself is added to what the light makes of the colour.
    Vec4f texel{1, 1, 1, 1};
    if (const auto& shining = pictures.emission)
      texel = shining->lookup(*shining->texture, place_in(*shining, item.triangles, triangle, ray));
    for (int k = 0; k < 3; ++k) b.rgba[k][i] += float(item.made_of->emission[k]) * texel[k] / std::max(b.light[i], 1e-3f);
  }
}

}  // namespace sg::raster
