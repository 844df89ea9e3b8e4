// SPDX-License-Identifier: Apache-2.0
#include "scene/camera_params.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "support/test.h"

using namespace sg;

namespace {

Vec3 random_point(uint64_t seed, uint64_t i, double scale = 1) {
  return Vec3{random_unit(seed, 3 * i) - 0.5, random_unit(seed, 3 * i + 1) - 0.5, random_unit(seed, 3 * i + 2) - 0.5} * scale;
}

Box3 box_of(Vec3 a, Vec3 b) {
  Box3 box;
  box.add(a), box.add(b);
  return box;
}

/// Bounds of the projected corners as fractions of the picture (0..1), and whether all lie between near and far.
struct Seen {
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  bool in_depth = true;
};
Seen corners_seen(const Camera& c, const Box3& b, int w, int h) {
  const Projection p = make_projection(c, w, h);
  Seen s;
  for (int i = 0; i < 8; ++i) {
    const Vec3 q = p.to_pixel({i & 1 ? b.hi.x : b.lo.x, i & 2 ? b.hi.y : b.lo.y, i & 4 ? b.hi.z : b.lo.z});
    s.left = std::min(s.left, q.x / w), s.right = std::max(s.right, q.x / w);
    s.top = std::min(s.top, q.y / h), s.bottom = std::max(s.bottom, q.y / h);
    s.in_depth = s.in_depth && q.z >= p.near_plane && q.z <= p.far_plane;
  }
  return s;
}

}  // namespace

TEST_CASE("camera: points on the axes land where the pinhole formula says") {
  Camera c;
  c.position = {0, 0, 10}, c.view_angle = 90;  // one unit at depth 10 is half the height / 10
  const Projection p = make_projection(c, 400, 200);
  CHECK(length(p.to_pixel({0, 0, 0}) - Vec3{200, 100, 10}) < 1e-12);
  CHECK(length(p.to_pixel({1, 0, 0}) - Vec3{210, 100, 10}) < 1e-12);
  CHECK(length(p.to_pixel({0, 2, 5}) - Vec3{200, 60, 5}) < 1e-12);  // up on the picture is a smaller row
  c.parallel = true, c.parallel_height = 4;
  const Projection q = make_projection(c, 400, 200);
  CHECK(length(q.to_pixel({1, -1, 3}) - Vec3{250, 150, 7}) < 1e-12);
}

TEST_CASE("camera: the ray of a pixel goes through the points that project there") {
  for (const bool parallel : {false, true})
    for (uint64_t i = 0; i < 200; ++i) {
      Camera c;
      c.position = random_point(1, i, 20) + Vec3{0, 0, 30}, c.target = random_point(2, i, 4), c.up = random_point(3, i);
      c.parallel = parallel, c.parallel_height = 7, c.view_angle = 20 + 60 * random_unit(4, i);
      const Projection p = make_projection(c, 640, 480);
      const Vec3 world = random_point(5, i, 6), pixel = p.to_pixel(world);
      const Projection::Ray r = p.ray(pixel.x, pixel.y);
      CHECK(std::abs(length(r.direction) - 1) < 1e-12);
      CHECK(length(r.origin + r.direction * (pixel.z * r.per_depth) - world) < 1e-9);
      CHECK(std::abs(dot(p.right, p.up)) + std::abs(dot(p.right, p.forward)) + std::abs(dot(p.up, p.forward)) < 1e-12);
    }
}

TEST_CASE("fit_camera: a box fills the picture up to the margin from any side") {
  for (const bool parallel : {false, true})
    for (uint64_t i = 0; i < 300; ++i) {
      const Box3 b = box_of(random_point(6, i, 3), random_point(7, i, 3));
      const double aspect = 0.5 + 2 * random_unit(8, i);
      const int h = 1000, w = int(h * aspect);
      const Camera c = fit_camera(b, random_point(9, i), random_point(10, i), double(w) / h, 0.08, 30, parallel);
      const Seen s = corners_seen(c, b, w, h);
      CHECK(s.left > 0.08 - 1e-9);
      CHECK(s.right < 0.92 + 1e-9);
      CHECK(s.top > 0.08 - 1e-9);
      CHECK(s.bottom < 0.92 + 1e-9);
      CHECK(s.in_depth);
      // tight: both sides of one axis touch
      const bool tight_x = std::abs(s.left - 0.08) < 1e-6 && std::abs(s.right - 0.92) < 1e-6,
                 tight_y = std::abs(s.top - 0.08) < 1e-6 && std::abs(s.bottom - 0.92) < 1e-6;
      CHECK((tight_x || tight_y));
    }
}

TEST_CASE("fit_camera: flat, thin, single-point, far and empty boxes are seen") {
  const Box3 boxes[] = {box_of({0, 0, 0}, {1, 2, 0}), box_of({0, 0, 0}, {0, 0, 5}), box_of({3, 3, 3}, {3, 3, 3}),
                        box_of({1e7, 1e7, 0}, {1e7 + 1, 1e7 + 1, 1}), Box3{}};
  const Vec3 directions[] = {{0, 0, 1}, {1, 0, 0}, {1, 1, 1}, {0, 0, -1}};
  for (const Box3& b : boxes)
    for (Vec3 d : directions)
      for (const bool parallel : {false, true}) {
        const Camera c = fit_camera(b, d, {0, 0, 1}, 1.5, 0.1, 30, parallel);
        const Vec3 center = b.empty() ? Vec3{0, 0, 0} : b.center();
        const Vec3 q = make_projection(c, 300, 200).to_pixel(center);
        CHECK(q.x > 29);
        CHECK(q.x < 271);
        CHECK(q.y > 19);
        CHECK(q.y < 181);
        CHECK(q.z >= c.near_plane);
        CHECK(q.z <= c.far_plane);
      }
}

TEST_CASE("fit_planes: near and far enclose the box, near stays in front of the eye") {
  Camera c;
  c.position = {0, 0, 10};
  fit_planes(c, box_of({-1, -1, -1}, {1, 1, 1}));
  CHECK(c.near_plane <= 9);
  CHECK(c.near_plane > 8.9);
  CHECK(c.far_plane >= 11);
  CHECK(c.far_plane < 11.1);
  c.position = {0, 0, 0.5}, c.target = {0, 0, 0};
  fit_planes(c, box_of({-1, -1, -1}, {1, 1, 1}));  // the eye is inside
  CHECK(c.near_plane > 0);
  CHECK(c.near_plane < 1e-3);
  CHECK(c.far_plane >= 1.5);
}

TEST_CASE("camera: mistakes are told") {
  Camera c;
  CHECK(test::error_of([&] { make_projection(c, 0, 10); }).find("0x10") != std::string::npos);
  c.target = c.position;
  CHECK(test::error_of([&] { make_projection(c, 10, 10); }).find("same point") != std::string::npos);
  c.target = {0, 0, NAN};
  CHECK(test::error_of([&] { make_projection(c, 10, 10); }).find("finite") != std::string::npos);
  c.target = {0, 0, 0}, c.view_angle = 180;
  CHECK(test::error_of([&] { make_projection(c, 10, 10); }).find("view angle") != std::string::npos);
  c.view_angle = 30, c.far_plane = c.near_plane;
  CHECK(test::error_of([&] { make_projection(c, 10, 10); }).find("near plane") != std::string::npos);
  c.parallel = true, c.parallel_height = 0;
  CHECK(test::error_of([&] { make_projection(c, 10, 10); }).find("parallel height") != std::string::npos);
  CHECK(test::error_of([&] { fit_camera({}, {0, 0, 0}, {0, 1, 0}, 1); }).find("direction") != std::string::npos);
  CHECK(test::error_of([&] { fit_camera({}, {0, 0, 1}, {0, 1, 0}, 1, 0.5); }).find("margin") != std::string::npos);
  CHECK(test::error_of([&] { fit_camera({}, {0, 0, 1}, {0, 1, 0}, 1, 0.1, 0); }).find("view angle") != std::string::npos);
}

TEST_CASE("make_camera: named views of z up, of graphics and of a patient") {
  const Box3 box = box_of({0, 0, 0}, {1, 1, 1});
  const auto seen = [&](NamedView view, const ViewAxes& axes) {
    CameraParams p;
    p.view = view;
    CameraDefaults defaults;
    defaults.axes = axes;
    const Camera c = make_camera(p, box, 1, defaults, 0.05);
    const Projection q = make_projection(c, 100, 100);
    return std::pair(-q.forward, q.up);
  };
  struct Want {
    NamedView view;
    ViewAxes axes;
    Vec3 from, up;
  };
  const ViewAxes z_up;
  const Want wants[] = {{NamedView::front, z_up, {0, -1, 0}, {0, 0, 1}},
                        {NamedView::left, z_up, {-1, 0, 0}, {0, 0, 1}},
                        {NamedView::top, z_up, {0, 0, 1}, {0, 1, 0}},
                        {NamedView::bottom, z_up, {0, 0, -1}, {0, 1, 0}},
                        {NamedView::front, graphics_axes, {0, 0, 1}, {0, 1, 0}},
                        {NamedView::back, graphics_axes, {0, 0, -1}, {0, 1, 0}},
                        {NamedView::right, graphics_axes, {1, 0, 0}, {0, 1, 0}},
                        {NamedView::top, graphics_axes, {0, 1, 0}, {0, 0, -1}},
                        {NamedView::front, patient_view_axes, {0, -1, 0}, {0, 0, 1}},  // from in front of the face
                        {NamedView::left, patient_view_axes, {1, 0, 0}, {0, 0, 1}},    // the patient's left
                        {NamedView::right, patient_view_axes, {-1, 0, 0}, {0, 0, 1}},
                        {NamedView::bottom, patient_view_axes, {0, 0, -1}, {0, -1, 0}}};  // axial, from the feet, face above
  for (const Want& w : wants) {
    const auto [from, up] = seen(w.view, w.axes);
    CAPTURE(int(w.view));
    CHECK(length(from - w.from) < 1e-12);
    CHECK(length(up - w.up) < 1e-12);
  }
}

TEST_CASE("camera: a stated height of a parallel projection stays while the view turns") {
  const Box3 box = box_of({0, 0, 0}, {1, 2, 5});
  CameraParams p;
  p.projection = ProjectionKind::parallel, p.height = 3;
  for (const Vec3 direction : {Vec3{0, -1, 0}, Vec3{1, 1, 1}, Vec3{1, 0, 0}}) {
    p.direction = direction;
    const Camera c = make_camera(p, box, 1.5, {}, 0.1);
    CHECK(c.parallel_height == 3);
    const Projection q = make_projection(c, 600, 400);  // two points apart by a third of the height, a third of the picture apart
    CHECK(length(q.to_pixel(c.target + q.up) - q.to_pixel(c.target) + Vec3{0, 400.0 / 3, 0}) < 1e-9);
  }
}
