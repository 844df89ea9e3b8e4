// SPDX-License-Identifier: Apache-2.0
#include "filter/surface/texture_coordinates.h"

#include <cmath>
#include <numbers>

#include "support/test.h"
#include "surface_shapes.h"

using namespace sg;
using namespace sg::test::shapes;
using doctest::Approx;

namespace {

Vec2 uv(const Dataset& d, size_t i) {
  const Field& f = d.fields().require("texture coordinates", Association::point);
  return {f.array.get(i, 0), f.array.get(i, 1)};
}
Vec3 at(const Dataset& d, size_t i) { return d.as<SurfaceMesh>()->points.at(i); }

}  // namespace

TEST_CASE("texture coordinates: around a sphere they are longitude and latitude, and no polygon crosses the seam") {
  Context ctx;
  const DatasetPtr d = texture_coordinates(sphere(3).dataset(), {.map = TextureMap::sphere}, ctx);
  CHECK(d->point_count() > sphere(3).xyz.size() / 3);  // of the seam and the poles
  CHECK(d->fields().require("texture coordinates").role == Role::tcoords);
  for (size_t i = 0; i < d->point_count(); ++i) {
    const Vec3 p = normalize(at(*d, i));
    CHECK(uv(*d, i).y == Approx(0.5 + std::asin(p.z) / std::numbers::pi).epsilon(1e-4));
    if (std::hypot(p.x, p.y) < 1e-6) continue;
    const double turn = uv(*d, i).x - (0.5 + std::atan2(p.y, p.x) / (2 * std::numbers::pi));
    CHECK(turn - std::nearbyint(turn) == Approx(0).epsilon(1e-6));
  }
  const CellsView polygons = cells_view(d->as<SurfaceMesh>()->polygons);
  for (size_t c = 0; c < polygons.count; ++c) {
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for (size_t k = polygons.begin(c); k < polygons.end(c); ++k) {
      const double u = uv(*d, size_t(polygons.connectivity[k])).x;
      lo = std::min(lo, u), hi = std::max(hi, u);
    }
    CHECK(hi - lo < 0.3);
    CHECK(lo >= 0);
  }
}

TEST_CASE("texture coordinates: on a plane the box of the data is the picture, or a length is") {
  Context ctx;
  const DatasetPtr d = texture_coordinates(box().dataset(), {.map = TextureMap::plane, .axis = TextureAxis::z}, ctx);
  const Box3 b = d->bounds();
  CHECK(d->point_count() == box().xyz.size() / 3);
  for (size_t i = 0; i < d->point_count(); ++i) {
    CHECK(uv(*d, i).x == Approx((at(*d, i).x - b.lo.x) / b.size().x));
    CHECK(uv(*d, i).y == Approx((at(*d, i).y - b.lo.y) / b.size().y));
  }
  const DatasetPtr by_size = texture_coordinates(box().dataset(), {.map = TextureMap::plane, .axis = TextureAxis::x, .size = 0.5}, ctx);
  for (size_t i = 0; i < by_size->point_count(); ++i) CHECK(uv(*by_size, i).y == Approx((at(*by_size, i).z - b.lo.z) / 0.5));
}

TEST_CASE("texture coordinates: each side of a box is laid flat, and its edges are doubled") {
  Context ctx;
  const DatasetPtr d = texture_coordinates(box().dataset(), {.map = TextureMap::box, .size = 1}, ctx);
  // A length in the data is a length in the picture on every polygon.
  const CellsView polygons = cells_view(d->as<SurfaceMesh>()->polygons);
  for (size_t c = 0; c < polygons.count; ++c) {
    const auto a = size_t(polygons.point(c, 0)), b = size_t(polygons.point(c, 1));
    const Vec2 across = uv(*d, b) - uv(*d, a);
    CHECK(std::hypot(across.x, across.y) == Approx(length(at(*d, b) - at(*d, a))).epsilon(0.01));
  }
}
