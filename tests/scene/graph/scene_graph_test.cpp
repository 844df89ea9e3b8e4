// SPDX-License-Identifier: Apache-2.0
#include "scene/graph/scene_graph.h"

#include "support/test.h"

using namespace sg;

namespace {

Affine moved_by(double x, double y, double z) { return {Mat3(), {x, y, z}}; }
Affine turned_by(double degrees) { return {turn_about({0, 0, 1}, degrees), {}}; }
Affine scaled_by(double s) { return {{{{s, 0, 0}, {0, s, 0}, {0, 0, s}}}, {}}; }

}  // namespace

TEST_CASE("scene graph: a child stands in its parent's frame, once for each instance of both") {
  const std::vector<SceneNode> nodes{{"arm", -1, true, moved_by(10, 0, 0) * turned_by(90), {Affine(), scaled_by(2)}},
                                     {"hand", 0, true, moved_by(1, 0, 0), {moved_by(0, 0, 1), moved_by(0, 0, 2)}},
                                     {"alone", -1, true, Affine()}};
  const auto world = world_places(nodes);
  REQUIRE(world.size() == 3);
  REQUIRE(world[0].size() == 2);
  REQUIRE(world[1].size() == 4);
  CHECK(world[0][0](Vec3(1, 0, 0)) == Vec3(10, 1, 0));
  CHECK(world[0][1](Vec3(1, 0, 0)) == Vec3(10, 2, 0));
  CHECK(world[1][0](Vec3()) == Vec3(10, 1, 1));
  CHECK(world[1][1](Vec3()) == Vec3(10, 1, 2));
  CHECK(world[1][2](Vec3()) == Vec3(10, 2, 2));
  CHECK(world[1][3](Vec3()) == Vec3(10, 2, 4));
  CHECK(world[2] == std::vector{Affine()});
}

TEST_CASE("scene graph: what is hidden hides its children") {
  const std::vector<SceneNode> nodes{
      {"a", -1, false, Affine()}, {"b", 0, true, Affine()}, {"c", 1, true, Affine()}, {"d", -1, true, Affine()}};
  const auto world = world_places(nodes);
  CHECK(world[0].empty());
  CHECK(world[2].empty());
  CHECK(world[3].size() == 1);
}

TEST_CASE("scene graph: too many places, and products that flatten, are refused by the node's name") {
  std::vector<SceneNode> many{{"a", -1, true, Affine(), std::vector<Affine>(2000)}, {"b", 0, true, Affine(), std::vector<Affine>(2000)}};
  CHECK(test::contains(test::error_of([&] { world_places(many); }), "node 'b'"));
  std::vector<SceneNode> small;
  for (int i = 0; i < 30; ++i) small.push_back({"n" + std::to_string(i), i - 1, true, scaled_by(1e-20)});
  CHECK(test::contains(test::error_of([&] { world_places(small); }), "flatten"));
}

TEST_CASE("scene graph: between keys a node moves evenly and turns the shorter way; beside them it rests") {
  const std::vector<PlaceKey> keys{
      {1, Affine()}, {3, moved_by(4, 0, 0) * turned_by(120)}, {4, moved_by(4, 0, 0) * turned_by(240) * scaled_by(3)}};
  CHECK(place_at(keys, -5) == keys[0].place);
  CHECK(place_at(keys, 1) == keys[0].place);
  CHECK(place_at(keys, 3) == keys[1].place);
  CHECK(place_at(keys, 99) == keys[2].place);
  const Affine half = place_at(keys, 2);
  CHECK(length(half(Vec3(1, 0, 0)) - (moved_by(2, 0, 0) * turned_by(60))(Vec3(1, 0, 0))) < 1e-14);
  const Affine later = place_at(keys, 3.5);
  CHECK(length(later(Vec3(1, 0, 0)) - (moved_by(4, 0, 0) * turned_by(180) * scaled_by(2))(Vec3(1, 0, 0))) < 1e-14);
  CHECK(place_at({}, 3) == Affine());
}

TEST_CASE("scene graph: instances at points are moved there, turned to vectors and scaled by a field") {
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<double>{1, 0, 0, 2, 0, 0, 3, 0, 0}, 3);
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::vector<double>{0, 1, 0, 1, 0, 0, NAN, 0, 0}, 3), "", Role::none});
  fields.add({"r", Association::point, Array::from_vector(std::vector<double>{2, 0.5, 1}), "", Role::none});
  const DatasetPtr points = make_dataset(std::move(cloud), std::move(fields));
  CHECK(places_at(points, {}).size() == 3);
  PointInstancesParams p;
  p.vectors = {"v"}, p.size = {"r"}, p.scale = 10;
  const auto places = places_at(points, p);
  REQUIRE(places.size() == 2);  // the third has no direction
  CHECK(length(places[0](Vec3(1, 0, 0)) - Vec3(1, 20, 0)) < 1e-5);
  CHECK(length(places[1](Vec3(1, 0, 0)) - Vec3(7, 0, 0)) < 1e-5);
  p.size = {"absent"};
  CHECK(test::contains(test::error_of([&] { places_at(points, p); }), "absent"));
}
