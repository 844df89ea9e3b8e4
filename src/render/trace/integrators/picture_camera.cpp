// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/picture_camera.h"

#include <algorithm>
#include <cmath>

namespace sg::trace {

PictureCamera::PictureCamera(const Projection& projection, const Placement& placement) : projection_(projection), placement_(placement) {}

double PictureCamera::start(const Projection::Ray& r) const {
  return std::max(dot(placement_.middle - r.origin, r.direction) - 2 / placement_.scale, projection_.near_plane * r.per_depth);
}

Vec3 PictureCamera::off_middle(Vec2f on_lens) const {
  return (projection_.right * double(on_lens.x) + projection_.up * double(on_lens.y)) * (projection_.lens / 2);
}

// From the lens to where the ray through its middle is sharp.
Projection::Ray PictureCamera::inner_ray(Vec2f pixel, Vec2f on_lens) const {
  Projection::Ray r = projection_.ray(double(pixel.x), double(pixel.y));
  if (!has_lens()) return r;
  const Vec3 sharp = r.origin + r.direction * (projection_.focus * r.per_depth);
  r.origin += off_middle(on_lens);
  r.per_depth = length(sharp - r.origin) / projection_.focus;
  r.direction = normalize(sharp - r.origin);
  return r;
}

Ray PictureCamera::ray(Vec2f pixel, Vec2f on_lens) const {
  const Projection::Ray r = inner_ray(pixel, on_lens);
  return {placement_.traced(r.origin + r.direction * start(r)), normalize(Vec3f(r.direction))};
}

RayFootprint PictureCamera::footprint(Vec2f pixel) const {
  const Projection::Ray r = projection_.ray(double(pixel.x), double(pixel.y));
  const double step = 1 / (projection_.scale * double(RayFootprint::paths_across));  // in parallel a length, else per depth
  const Vec3 right = projection_.right * step, down = projection_.up * -step;
  if (projection_.parallel) return {Vec3f(right * placement_.scale), Vec3f(down * placement_.scale), {}, {}};
  const double begin = start(r) * placement_.scale / r.per_depth;
  return {Vec3f(right * begin), Vec3f(down * begin), Vec3f(right / r.per_depth), Vec3f(down / r.per_depth)};
}

double PictureCamera::depth(Vec2f pixel, float t) const {
  const Projection::Ray r = projection_.ray(double(pixel.x), double(pixel.y));
  return (start(r) + double(t) / placement_.scale) / r.per_depth;
}

PixelBox PictureCamera::pixels_of(const Box3f& box) const {
  const PixelBox all{0, 0, projection_.width, projection_.height};
  if (box.empty()) return {};
  if (has_lens()) return all;
  double lo[2] = {HUGE_VAL, HUGE_VAL}, hi[2] = {-HUGE_VAL, -HUGE_VAL};
  for (int i = 0; i < 8; ++i) {
    const Vec3f corner{(i & 1 ? box.hi : box.lo).x, (i & 2 ? box.hi : box.lo).y, (i & 4 ? box.hi : box.lo).z};
    const Vec3 at = projection_.to_pixel(placement_.world(corner));
    if (!projection_.parallel && !(at.z > projection_.near_plane && at.z > 0)) return all;
    for (int a = 0; a < 2; ++a) lo[a] = std::min(lo[a], at[a]), hi[a] = std::max(hi[a], at[a]);
  }
  const auto within = [](double v, int size) { return int(std::clamp(v, 0.0, double(size))); };
  // One more all around, for what rounding does to a ray.
  const int x = within(lo[0] - 1, all.w), y = within(lo[1] - 1, all.h);
  return {x, y, within(hi[0] + 2, all.w) - x, within(hi[1] + 2, all.h) - y};
}

std::optional<Sight> PictureCamera::sees(Vec3f point, Vec2f on_lens) const {
  const Vec3 world = placement_.world(point);
  const double depth = projection_.to_eye(world).z;
  if (!(depth >= projection_.near_plane) || !(depth > 0 || projection_.parallel)) return {};
  // Through the lens's middle it is a point in focus, on the same ray from the place on the lens, that is seen in that pixel.
  Vec3 sharp = world;
  if (has_lens()) {
    const Vec3 off = off_middle(on_lens);
    if (projection_.parallel) sharp = world + off * (depth / projection_.focus - 1);
    else sharp = projection_.eye + off + (world - projection_.eye - off) * (projection_.focus / depth);
  }
  const Vec3 at = projection_.to_pixel(sharp);
  if (!(at.x >= 0 && at.x < projection_.width && at.y >= 0 && at.y < projection_.height)) return {};
  const Projection::Ray r = inner_ray({float(at.x), float(at.y)}, on_lens);
  const double before = dot(world - r.origin, r.direction) - start(r);
  if (!(before > 0)) return {};
  return Sight{Vec2f{float(at.x), float(at.y)}, -normalize(Vec3f(r.direction)), float(before * placement_.scale),
               float(importance(point, on_lens))};
}

double PictureCamera::importance(Vec3f point, Vec2f on_lens) const {
  const double per_traced = projection_.scale / placement_.scale, pixels = per_traced * per_traced;  // at depth 1, or at any in parallel
  const Vec3 off = off_middle(on_lens);
  if (projection_.parallel) {
    if (!has_lens()) return pixels;
    const double f = projection_.focus;
    return pixels * std::sqrt(f * f + dot(off, off)) / f;  // across a ray that is not square to the picture
  }
  // Pixels are scale^2 / cos^3 to the solid angle, that 1 / distance^2 to the area across.
  const Vec3 way = placement_.world(point) - projection_.eye - off;
  const double d2 = dot(way, way), cosine = dot(way, projection_.forward) / std::sqrt(d2);
  return pixels / (cosine * cosine * cosine * d2);
}

}  // namespace sg::trace
