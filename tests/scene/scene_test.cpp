// SPDX-License-Identifier: Apache-2.0
#include "scene/scene.h"

#include "support/test.h"

using namespace sg;

TEST_CASE("scene_bounds: the union of all items; empty without any") {
  CHECK(scene_bounds({}).empty());
  auto cloud = [](std::vector<float> xyz) {
    PointCloud c;
    c.points.xyz = Array::from_vector(std::move(xyz), 3);
    return make_dataset(c);
  };
  Scene s;
  PointsItem p;
  p.data = cloud({0, 0, 0, 1, 2, 3});
  s.items.push_back(p);
  p.data = cloud({-5, 1, 1});
  s.items.push_back(p);
  s.items.push_back(SurfaceItem{});  // no data, no bounds
  const Box3 b = scene_bounds(s);
  CHECK(b.lo == Vec3{-5, 0, 0});
  CHECK(b.hi == Vec3{1, 2, 3});
}

TEST_CASE("lights_of: the scene's own lights, else a strong one from the left and a weak one from the right") {
  Scene s;
  const auto two = lights_of(s);
  REQUIRE(two.size() == 2);
  CHECK(two[0].direction.x < 0);
  CHECK(two[1].direction.x > 0);
  CHECK(two[0].intensity > 2 * two[1].intensity);
  s.lights.push_back({{0, 0, 1}, true, 0.5f});
  CHECK(lights_of(s).size() == 1);
}
