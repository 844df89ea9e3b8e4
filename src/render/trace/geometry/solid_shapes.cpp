// SPDX-License-Identifier: Apache-2.0
#include "render/trace/geometry/solid_shapes.h"

#include <algorithm>
#include <cmath>

namespace sg::trace {

namespace {

struct Interval {
  double first = HUGE_VAL, last = -HUGE_VAL;  // empty
  void add(Interval o) {
    if (o.first <= o.last) first = std::min(first, o.first), last = std::max(last, o.last);
  }
};

/// Where q(t) = a t^2 - 2 b t + c <= 0; a > 0. `rest` is the least value of q, which the caller knows better than b^2 / a - c tells it. The
/// root that is near zero comes from the product of both, so that its sign is that of c.
Interval below_zero(double a, double b, double c, double rest) {
  if (!(rest <= 0)) return {};
  const double middle = b / a, half = std::sqrt(-rest / a);
  if (middle >= 0) {
    const double last = middle + half;
    return {last > 0 ? c / (a * last) : 0, last};
  }
  const double first = middle - half;
  return {first, c / (a * first)};
}

Interval inside_ball(Vec3 from, Vec3 d, Vec3 center, double radius) {
  const Vec3 f = from - center;
  const double a = dot(d, d), b = -dot(f, d);
  const Vec3 nearest = f + d * (b / a);
  return below_zero(a, b, dot(f, f) - radius * radius, dot(nearest, nearest) - radius * radius);
}

/// The part of an infinitely long cylinder between two planes across it at its ends.
Interval inside_cylinder(Vec3 from, Vec3 d, Vec3 a, Vec3 b, double radius) {
  const Vec3 axis = b - a, f = from - a;
  const double long2 = dot(axis, axis);
  if (!(long2 > 0)) return {};
  const double along_d = dot(d, axis) / long2, along_f = dot(f, axis) / long2;
  const Vec3 across_d = d - axis * along_d, across_f = f - axis * along_f;
  const double a2 = dot(across_d, across_d), c = dot(across_f, across_f) - radius * radius;
  Interval body;
  if (a2 > 1e-24 * dot(d, d)) {
    const double b1 = -dot(across_f, across_d);
    const Vec3 nearest = across_f + across_d * (b1 / a2);
    body = below_zero(a2, b1, c, dot(nearest, nearest) - radius * radius);
  } else if (c <= 0) {  // along the axis
    body = {-HUGE_VAL, HUGE_VAL};
  }
  if (along_d == 0) return along_f >= 0 && along_f <= 1 ? body : Interval{};
  double enter = -along_f / along_d, exit = (1 - along_f) / along_d;
  if (enter > exit) std::swap(enter, exit);
  return {std::max(body.first, enter), std::min(body.last, exit)};
}

bool choose(Interval inside, float t_max, float& t) {
  if (!(inside.first <= inside.last)) return false;
  t = float(inside.first > 0 ? inside.first : inside.last);
  return t > 0 && t <= t_max;
}

Vec3 at(const Ray& ray, const Hit& hit) { return Vec3(ray.origin) + Vec3(ray.direction) * double(hit.t); }

Box3f around(Vec3f a, Vec3f b, Vec3f reach) {
  Box3f box;
  for (int i = 0; i < 3; ++i) {
    const double lo = double(std::min(a[i], b[i])) - reach[i], hi = double(std::max(a[i], b[i])) + reach[i];
    box.lo[i] = std::nextafter(float(lo), -HUGE_VALF), box.hi[i] = std::nextafter(float(hi), HUGE_VALF);
    if (std::isnan(a[i]) || std::isnan(b[i])) box.lo[i] = NAN;
  }
  return box;
}

}  // namespace

Box3f Ball::bounds() const { return around(center, center, {radius, radius, radius}); }
bool Ball::meet(const Ray& ray, float t_max, float& t, float&) const {
  return choose(inside_ball(Vec3(ray.origin), Vec3(ray.direction), Vec3(center), radius), t_max, t);
}
ShapePoint Ball::point(const Ray& ray, const Hit& hit) const {
  const Vec3 n = normalize(at(ray, hit) - Vec3(center));
  return {Vec3(center) + n * double(radius), n, {}};
}

Box3f Disc::bounds() const {
  Vec3f reach;
  for (int i = 0; i < 3; ++i) reach[i] = float(double(radius) * std::sqrt(std::max(0.0, 1 - double(normal[i]) * normal[i]) + 1e-7));
  return around(center, center, reach);
}
bool Disc::meet(const Ray& ray, float t_max, float& t, float&) const {
  const Vec3 n(normal), d(ray.direction), f = Vec3(center) - Vec3(ray.origin);
  const double where = dot(n, f) / dot(n, d);
  t = float(where);
  if (!(t > 0 && t <= t_max)) return false;
  const Vec3 from_middle = d * where - f;
  return dot(from_middle, from_middle) <= double(radius) * radius;
}
ShapePoint Disc::point(const Ray& ray, const Hit& hit) const {
  const Vec3 n = normalize(Vec3(normal)), p = at(ray, hit), c(center);
  return {p - n * dot(p - c, n), n, {}};
}

Box3f Capsule::bounds() const { return around(a, b, {radius, radius, radius}); }
bool Capsule::meet(const Ray& ray, float t_max, float& t, float& u) const {
  // It is convex: what a ray has of it is one piece, from the first entry into its parts to the last exit.
  const Vec3 o(ray.origin), d(ray.direction), p(a), q(b);
  Interval inside = inside_ball(o, d, p, radius);
  inside.add(inside_ball(o, d, q, radius));
  inside.add(inside_cylinder(o, d, p, q, radius));
  if (!choose(inside, t_max, t)) return false;
  const Vec3 axis = q - p;
  const double long2 = dot(axis, axis);
  u = long2 > 0 ? float(std::clamp(dot(o + d * double(t) - p, axis) / long2, 0.0, 1.0)) : 0;
  return true;
}
ShapePoint Capsule::point(const Ray& ray, const Hit& hit) const {
  const Vec3 p(a), axis = Vec3(b) - p, x = at(ray, hit);
  const double long2 = dot(axis, axis), along = long2 > 0 ? std::clamp(dot(x - p, axis) / long2, 0.0, 1.0) : 0;
  const Vec3 foot = p + axis * along, n = normalize(x - foot);
  return {foot + n * double(radius), n, axis};
}

}  // namespace sg::trace
