// SPDX-License-Identifier: Apache-2.0
#include "scene/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "base/error.h"

namespace sg {

namespace {

using std::numbers::pi;

bool finite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

struct Axes {
  Vec3 right, up, forward;
};

/// Orthonormal axes; an `up` along the view direction is replaced by the world axis that is most across it.
Axes view_axes(Vec3 forward, Vec3 up) {
  forward = normalize(forward);
  Vec3 right = cross(forward, normalize(up));
  if (!(length(right) > 1e-9)) {
    const Vec3 a{std::abs(forward.x), std::abs(forward.y), std::abs(forward.z)};
    const Vec3 across = a.y <= a.x && a.y <= a.z ? Vec3{0, 1, 0} : a.z <= a.x ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
    right = cross(forward, across);
  }
  right = normalize(right);
  return {right, cross(right, forward), forward};
}

Vec3 corner(const Box3& b, int i) { return {i & 1 ? b.hi.x : b.lo.x, i & 2 ? b.hi.y : b.lo.y, i & 4 ? b.hi.z : b.lo.z}; }

/// A box that has corners: the unit box about zero when there is nothing.
Box3 usable(const Box3& box) {
  if (!box.empty() && finite(box.lo) && finite(box.hi)) return box;
  Box3 b;
  b.add(Vec3{-0.5, -0.5, -0.5}), b.add(Vec3{0.5, 0.5, 0.5});
  return b;
}

/// The length that a flat picture is measured by when the box is a single point.
double size_of(const Box3& b) {
  const double d = b.diagonal();
  if (d > 0) return d;
  const Vec3 c = b.center();
  return std::max(1e-3 * std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)}), 1.0);
}

}  // namespace

Projection make_projection(const Camera& c, int width, int height) {
  if (width < 1 || height < 1)
    fail_usage(fmt::format("picture size {}x{} is empty", width, height), "camera", "width and height must be at least 1");
  if (!finite(c.position) || !finite(c.target) || !finite(c.up)) fail_usage("position, target and up must be finite numbers", "camera");
  if (!(length(c.target - c.position) > 0)) fail_usage("position and target are the same point", "camera", "move one of them");
  if (!c.parallel && !(c.view_angle > 0 && c.view_angle < 180))
    fail_usage(fmt::format("view angle {} is out of range", c.view_angle), "camera", "it must lie between 0 and 180 degrees");
  if (c.parallel && !(c.parallel_height > 0 && std::isfinite(c.parallel_height)))
    fail_usage(fmt::format("parallel height {} is not a valid length", c.parallel_height), "camera", "it must be above 0");
  if (!(c.far_plane > c.near_plane) || !(c.far_plane > 0))
    fail_usage(fmt::format("near plane {} and far plane {} leave nothing between them", c.near_plane, c.far_plane), "camera",
               "far must be above near and above 0");
  if (!(c.lens >= 0 && std::isfinite(c.lens)) || (c.lens > 0 && !(c.focus > 0 && std::isfinite(c.focus))))
    fail_usage(fmt::format("a lens of {} with its focus at {} makes no picture", c.lens, c.focus), "camera",
               "the diameter must not be negative, and the focus above 0");
  Projection p;
  p.lens = c.lens, p.focus = c.focus;
  p.width = width, p.height = height, p.parallel = c.parallel;
  const Axes a = view_axes(c.target - c.position, c.up);
  p.eye = c.position, p.right = a.right, p.up = a.up, p.forward = a.forward;
  p.scale = c.parallel ? height / c.parallel_height : 0.5 * height / std::tan(0.5 * c.view_angle * pi / 180);
  p.far_plane = c.far_plane;
  // Depth is a positive number everywhere; in perspective it is divided by, so it stays away from zero.
  p.near_plane = c.parallel ? std::max(c.near_plane, 0.0) : std::max(c.near_plane, 1e-7 * c.far_plane);
  return p;
}

Projection::Ray Projection::ray(double px, double py) const {
  const double x = (px - middle_x()) / scale, y = (middle_y() - py) / scale;
  if (parallel) return {eye + right * x + up * y, forward, 1.0};
  const Vec3 d = forward + right * x + up * y;
  const double l = length(d);
  return {eye, d / l, l};
}

Projection band_of(const Projection& whole, int first, int rows) { return window_of(whole, 0, first, whole.width, rows); }

Projection window_of(const Projection& whole, int x, int y, int width, int height, int finer) {
  Projection p = whole;
  p.width = finer * width, p.height = finer * height, p.rows = finer * (whole.rows > 0 ? whole.rows : whole.height);
  p.scale = finer * whole.scale;
  p.shift_x = finer * (whole.middle_x() - x - 0.5 * width), p.shift_y = finer * (whole.middle_y() - y - 0.5 * height);
  return p;
}

Camera fit_camera(const Box3& given, Vec3 direction, Vec3 up, double aspect, double margin, double view_angle, bool parallel) {
  if (!finite(direction) || !(length(direction) > 0))
    fail_usage("the viewing direction is zero or not finite", "camera", "give three numbers, not all zero");
  if (!(aspect > 0) || !(margin >= 0 && margin < 0.5))
    fail_usage(fmt::format("aspect {} and margin {} leave no room for the picture", aspect, margin), "camera");
  const Box3 box = usable(given);
  const Vec3 center = box.center();
  const double size = size_of(box);
  const Axes a = view_axes(-direction, up);
  Vec3 p[8];
  for (int i = 0; i < 8; ++i) {
    const Vec3 d = corner(box, i) - center;
    p[i] = {dot(d, a.right), dot(d, a.up), dot(d, a.forward)};
  }
  Camera c;
  c.up = a.up, c.parallel = parallel, c.view_angle = view_angle;
  const double room = 1 - 2 * margin;
  if (parallel) {
    double half_x = 0, half_y = 0;
    for (const Vec3& q : p) half_x = std::max(half_x, std::abs(q.x)), half_y = std::max(half_y, std::abs(q.y));
    const double half = std::max(half_y, half_x / aspect) / room;
    c.parallel_height = half > 1e-9 * size ? 2 * half : size;
    c.target = center, c.position = center - a.forward * (2 * size);
    fit_planes(c, box);
    return c;
  }
  if (!(view_angle > 0 && view_angle < 180))
    fail_usage(fmt::format("view angle {} is out of range", view_angle), "camera", "it must lie between 0 and 180 degrees");
  // |x - shift| <= k (z + distance) for every corner: the smallest distance and its shift from the two extreme corners per axis.
  const double ky = std::tan(0.5 * view_angle * pi / 180) * room, kx = ky * aspect;
  double right = -HUGE_VAL, left = -HUGE_VAL, top = -HUGE_VAL, bottom = -HUGE_VAL, nearest = HUGE_VAL;
  for (const Vec3& q : p) {
    right = std::max(right, q.x - kx * q.z), left = std::max(left, -q.x - kx * q.z);
    top = std::max(top, q.y - ky * q.z), bottom = std::max(bottom, -q.y - ky * q.z);
    nearest = std::min(nearest, q.z);
  }
  double distance = std::max((right + left) / (2 * kx), (top + bottom) / (2 * ky));
  distance = std::max(distance, (box.diagonal() > 0 ? 0.05 : 1.0) * size - nearest);  // lines along the view and single points
  const Vec3 shift = a.right * ((right - left) / 2) + a.up * ((top - bottom) / 2);
  c.target = center + shift, c.position = c.target - a.forward * distance;
  fit_planes(c, box);
  return c;
}

void fit_planes(Camera& camera, const Box3& given) {
  const Box3 box = usable(given);
  const Vec3 forward = camera.forward();
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  for (int i = 0; i < 8; ++i) {
    const double z = dot(corner(box, i) - camera.position, forward);
    lo = std::min(lo, z), hi = std::max(hi, z);
  }
  const double slack = 0.01 * std::max(hi - lo, 1e-3 * std::max(std::abs(hi), std::abs(lo)));
  if (!(hi > 0)) {  // everything is behind the viewer
    camera.near_plane = 1e-3 * size_of(box), camera.far_plane = size_of(box);
    return;
  }
  camera.far_plane = hi + slack;
  camera.near_plane = std::max(lo - slack, (camera.parallel ? 0.0 : 1e-4) * camera.far_plane);
}

}  // namespace sg
