// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/scene/picture_scene.h"

#include <cmath>

#include "pipeline/film/film_times.h"
#include "pipeline/picture/prepare.h"
#include "support/test.h"

using namespace sg;

namespace {

PipelineFile file_of(const std::string& text) {
  return parse_pipeline("sightglass: 1\nsteps:\n  grid: {gyroid: {size: 9}}\n  skin: {contour: {values: [0]}, from: grid}\n" + text,
                        "p.yaml", picture_vocabulary());
}
PreparedPicture prepared_of(const std::string& text) {
  PipelineFile file = file_of(text);
  Context context;
  return prepare_picture(file, {}, context);
}
std::string node_error(const std::string& text) {
  return test::error_of([&] { prepared_of(text); });
}

}  // namespace

TEST_CASE("scene: what a node shows lies in the world, with its box, its axes and one legend for all copies") {
  const PreparedPicture plain = prepared_of("show: [{surface: {field: gyroid}, of: skin}, {outline: {}, of: grid}]");
  const PreparedPicture moved = prepared_of(
      "scene:\n  - {node: a, translate: [10, 0, 0], scale: 2, show: [{surface: {field: gyroid}, of: skin}, {outline: {}, of: grid}],\n"
      "     instances: [{}, {translate: [0, 20, 0]}]}");
  const Box3 box = plain.shown[0].box, there = moved.shown[0].box;
  CHECK(there.lo.x == doctest::Approx(10 + 2 * box.lo.x));
  CHECK(there.hi.x == doctest::Approx(10 + 2 * box.hi.x));
  CHECK(there.lo.y == doctest::Approx(2 * box.lo.y));
  CHECK(there.hi.y == doctest::Approx(40 + 2 * box.hi.y));
  CHECK(moved.shown[0].legends.size() == 1);
  CHECK(moved.shown[0].legends[0].lo == plain.shown[0].legends[0].lo);
  CHECK(moved.shown[0].scene.items.size() == 2 * plain.shown[0].scene.items.size());
  for (const uint32_t show : moved.shown[0].scene.shows) CHECK((show == 1 || show == 2));
  const auto& copy = std::get<SurfaceItem>(moved.shown[0].scene.items.at(0));
  REQUIRE(copy.copy_of);  // so that its tree of rays serves all
  CHECK(copy.copy_of->place(Vec3(1, 0, 0)) == Vec3(12, 0, 0));
  CHECK(copy.copy_of->original->point_count() == copy.data->point_count());
  const Box3 items = scene_bounds(moved.shown[0].scene);
  CHECK(items.hi.y == doctest::Approx(there.hi.y).epsilon(1e-5));
}

TEST_CASE("scene: a node that leaves all in place changes nothing, and a hidden one shows nothing") {
  const PreparedPicture plain = prepared_of("show: [{surface: {}, of: skin}]");
  const PreparedPicture same = prepared_of("scene: [{node: a, show: [{surface: {}, of: skin}]}]");
  CHECK(same.shown[0].box == plain.shown[0].box);
  const auto data = [](const PreparedPicture& p) { return std::get<SurfaceItem>(p.shown[0].scene.items.at(0)).data; };
  CHECK(data(same)->point_count() == data(plain)->point_count());
  const PreparedPicture hidden = prepared_of(
      "show: [{outline: {}, of: grid}]\nscene: [{node: a, visible: false, children: [{node: b, show: [{surface: {}, of: skin}]}]}]");
  CHECK(hidden.shown[0].scene.items.size() == 1);
}

TEST_CASE("scene: volumes turn with their node") {
  const PreparedPicture p = prepared_of("scene: [{node: a, axis: [0, 0, 1], angle: 45, show: [{volume: {}, of: grid}]}]");
  const auto& item = std::get<VolumeItem>(p.shown[0].scene.items.at(0));
  const PreparedPicture flat = prepared_of("show: [{volume: {}, of: grid}]");
  const Vec3 size = flat.shown[0].box.size();
  CHECK(item.data->bounds().size().x == doctest::Approx(std::sqrt(0.5) * (size.x + size.y)));
  CHECK(item.data->bounds().size().z == doctest::Approx(size.z));
}

TEST_CASE("scene: copies stand at the points of a step") {
  const PreparedPicture p =
      prepared_of("scene: [{node: a, show: [{surface: {}, of: skin}], instances: {of: grid, scale: 0.01}, scale: 3}]");
  CHECK(p.shown[0].scene.items.size() == 729);
}

TEST_CASE("scene: all mistakes of its words are told together, before anything runs") {
  const std::string e = node_error(
      "scene:\n  - {node: a, scale: 0, show: [{surface: {}, of: skin}]}\n  - {node: b, keys: [{time: 1}, {time: 1}]}\n"
      "  - {node: c, time: 3}\n  - {node: d, instances: {of: grid, vector: x}}");
  CHECK(test::contains(e, "p.yaml:6: node 'a'"));
  CHECK(test::contains(e, "does not come after"));
  CHECK(test::contains(e, "there are no keys"));
  CHECK(test::contains(e, "did you mean 'vectors'"));
}

TEST_CASE("scene: keys and {t} make films move: each picture's pipeline states its own moment") {
  const PipelineFile file = file_of(
      "scene:\n  - {node: a, keys: [{time: 0}, {time: 2, translate: [4, 0, 0]}], show: [{surface: {}, of: skin}],\n"
      "     children: [{node: b, angle: \"{t}\", show: [{surface: {}, of: skin}]}]}");
  Context context;
  const FilmTimes times = film_times(file, "0:2:5", context);
  REQUIRE(times.times.size() == 5);
  const PipelineFile second = at_time(file, times, 1);
  const std::vector<SceneNode> nodes = stated_scene(second);
  CHECK(nodes[0].place.shift == Vec3(1, 0, 0));
  CHECK(length(nodes[1].place(Vec3(1, 0, 0)) - turn_about({0, 0, 1}, 0.5) * Vec3(1, 0, 0)) < 1e-15);
  CHECK(parse_pipeline(emit_pipeline(second), "p.yaml", picture_vocabulary()) == second);
}
