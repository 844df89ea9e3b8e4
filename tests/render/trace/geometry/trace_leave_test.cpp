// SPDX-License-Identifier: Apache-2.0
// A ray that leaves a surface never meets the place it starts from, and never misses what is on the other side.
#include <cmath>

#include "trace_scene.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using sg::test::line;

namespace {

const double offsets[] = {0, 1e7}, sizes[] = {1e-6, 1, 1e6};

DatasetPtr moved(const DatasetPtr& d, Vec3 origin, double size) {
  auto scaled = [&](const Points& from) {
    Points p = from;
    const auto v = from.xyz.view<float>();
    std::vector<float> xyz(3 * from.count());
    for (size_t i = 0; i < from.count(); ++i)
      for (int c = 0; c < 3; ++c) xyz[3 * i + size_t(c)] = float(double(v(i, c)) * size);
    p.xyz = Array::from_vector(std::move(xyz), 3), p.origin = origin;
    return p;
  };
  if (const auto* s = d->as<SurfaceMesh>()) {
    SurfaceMesh m = *s;
    m.points = scaled(s->points);
    return make_dataset(Mesh(std::move(m)), FieldSet(d->fields()));
  }
  PointCloud c = *d->as<PointCloud>();
  c.points = scaled(c.points);
  return make_dataset(Mesh(std::move(c)), FieldSet(d->fields()));
}

DatasetPtr cloud(size_t n) {
  std::vector<float> xyz, normals, radius;
  for (size_t i = 0; i < n; ++i) {
    const Vec3f p = any_place(1, i, 1), d = any_direction(2, i);
    xyz.insert(xyz.end(), {p.x, p.y, p.z}), normals.insert(normals.end(), {d.x, d.y, d.z}), radius.push_back(0.3f);
  }
  FieldSet f;
  f.add({"n", Association::point, Array::from_vector(std::move(normals), 3), "", Role::none});
  f.add({"r", Association::point, Array::from_vector(std::move(radius)), "", Role::none});
  return make_dataset(Mesh(PointCloud{{Array::from_vector(std::move(xyz), 3), {}}}), std::move(f));
}

struct Count {
  size_t starts = 0, met_again = 0, missed = 0;
};

/// From random places of the surface outward, within `near` of which nothing may be met, and inward, where something must be.
/// convex: outward nothing at all may be met.
Count leave_everywhere(const Geometry& g, size_t rays, double near, bool convex, bool closed) {
  Count c;
  for (size_t i = 0; c.starts < rays && i < 20 * rays; ++i) {
    const Ray ray = any_line(5, i, 1.8);
    Hit h;
    if (!g.nearest(ray, h)) continue;
    ++c.starts;
    const SurfacePoint p = g.at(ray, h);
    // Any direction, a third of them nearly along the surface.
    const Vec3f any = any_direction(7, i), flat = normalize(any - p.face_normal * dot(any, p.face_normal) * (i % 3 ? 0.0f : 0.9999f));
    for (const Vec3f d : {flat, -flat}) {
      const bool out = dot(d, p.face_normal) > 0;
      const Ray r{leave(p, d), d};
      Hit again;
      const bool met = g.nearest(r, again);
      if (out && met) c.met_again += convex || (again.primitive == p.primitive && double(again.t) < near);
      if (!out && closed) c.missed += !met;
      if (!out && met) c.met_again += double(again.t) < near && again.primitive == p.primitive && std::abs(dot(d, p.face_normal)) > 1e-2;
    }
  }
  return c;
}

}  // namespace

TEST_CASE("trace: rays leave triangles, balls, discs and tubes of any size and place and miss nothing") {
  size_t starts = 0;
  for (const double offset : offsets)
    for (const double size : sizes) {
      const Vec3 origin(offset, -0.5 * offset, offset / 3);
      const auto check = [&](const Geometry& g, bool convex, bool closed) {
        const Count c = leave_everywhere(g, 5000, 1e-3, convex, closed);
        CAPTURE(offset);
        CAPTURE(size);
        CHECK(c.starts > 500);
        CHECK(c.met_again == 0);
        CHECK(c.missed == 0);
        starts += c.starts;
      };
      SurfaceItem ball;
      ball.data = moved(sg::test::sphere(40, 1), origin, size);
      check(geometry_of(ball, {}), true, true);
      SurfaceItem ring;
      ring.data = moved(sg::test::torus(60, 40, true), origin, size);
      check(geometry_of(ring, {}), false, true);
      PointsItem points;
      points.data = moved(cloud(30), origin, size);
      check(geometry_of(points, {.point_radius = 0.2 * size}), false, true);
      PointsItem one = points;
      one.data = moved(cloud(1), origin, size);
      check(geometry_of(one, {.point_radius = 0.2 * size}), true, true);
      LinesItem lines = line({-1, 0, 0, 0, 0.5f, 0, 1, 0, 0.5f, 1, 0.5f, 1}, 1);
      lines.data = moved(lines.data, origin, size);
      check(geometry_of(lines, {.line_radius = 0.1 * size}), false, true);
      LinesItem straight = line({-1, 0.1f, 0, 1, 0, 0.5f}, 1);
      straight.data = moved(straight.data, origin, size);
      check(geometry_of(straight, {.line_radius = 0.1 * size}), true, true);
    }
  CHECK(starts > 100000);
}

TEST_CASE("trace: rays leave discs on either side") {
  for (const double offset : offsets) {
    PointsItem discs;
    discs.data = moved(cloud(1), {offset, offset, 0}, 1), discs.disc_normals = "n", discs.disc_radius = "r";
    const Count c = leave_everywhere(geometry_of(discs, {}), 10000, 1e-3, true, false);
    CHECK(c.starts > 2000);
    CHECK(c.met_again == 0);
  }
}

TEST_CASE("trace: in a scene of several datasets, each in its own coordinates, rays leave them just so") {
  Scene scene;
  for (int i = 0; i < 4; ++i) {
    SurfaceItem s;
    s.data = moved(sg::test::sphere(30, 1), {1e7 + 2.5 * i, 3.0 * i, -1.3 * i}, 1);
    scene.items.emplace_back(s);
  }
  Context context;
  const Geometry g = Geometry::make(*prepare_scene(scene, context), {}, context);
  size_t starts = 0, met = 0, missed = 0;
  for (size_t i = 0; i < 40000; ++i) {
    const Ray ray = any_line(5, i, 1);
    Hit h;
    if (!g.nearest(ray, h)) continue;
    ++starts;
    const SurfacePoint p = g.at(ray, h);
    const Vec3f d = any_direction(9, i);
    Hit again;
    const bool out = dot(d, p.face_normal) > 0, found = g.nearest({leave(p, d), d}, again);
    if (out) met += found && again.object == p.object;
    else missed += !found || again.object != p.object;
  }
  CHECK(starts > 2000);
  CHECK(met == 0);
  CHECK(missed == 0);
}
