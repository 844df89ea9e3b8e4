// SPDX-License-Identifier: Apache-2.0
// Cameras and lights of glTF files, where the nodes place them.
#include <cmath>

#include "io/gltf_with_nodes.h"
#include "io/scene/file_scene.h"
#include "io_files.h"

using namespace sg;
using doctest::Approx;
using test::lamp_node, test::lamps, test::triangle_with;

namespace {

FileScene scene_of_text(const std::string& text) {
  Context context;
  return scene_in_file(test::temp_file("scene.gltf", text), {}, context);
}

}  // namespace

TEST_CASE("gltf scene: cameras look along -z of their node with y up, wherever its parents move it") {
  // The parent turns by 90 degrees about y (x to -z) and lies at 10; the camera is 5 before it along its own z.
  const FileScene s = scene_of_text(triangle_with(
      R"(,{"translation":[10,0,0],"rotation":[0,0.70710678118654757,0,0.70710678118654757],"scale":[2,2,2],"children":[2]},
         {"camera":0,"name":"Near","translation":[0,0,5]},{"camera":1})",
      ",1,3",
      R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}},
         {"type":"orthographic","name":"flat","orthographic":{"xmag":2,"ymag":1.5,"znear":0,"zfar":1}}])"));
  REQUIRE(s.cameras.size() == 2);
  CHECK(s.cameras[0].name == "Near");
  CHECK(length(s.cameras[0].position - Vec3(20, 0, 0)) < 1e-12);
  CHECK(length(s.cameras[0].forward - Vec3(-1, 0, 0)) < 1e-12);
  CHECK(length(s.cameras[0].up - Vec3(0, 1, 0)) < 1e-12);
  CHECK(s.cameras[0].view_angle == Approx(0.5 * 180 / 3.14159265358979));
  CHECK(s.cameras[1].name == "flat");
  CHECK(s.cameras[1].parallel);
  CHECK(s.cameras[1].height == 3);
  CHECK(s.cameras[1].forward == Vec3(0, 0, -1));
}

TEST_CASE("gltf scene: lights by kind, colour and cone; those of numbers that make none are left out") {
  const FileScene s = scene_of_text(triangle_with(
      lamp_node(0, R"(,"name":"bulb","translation":[0,0,4])") + lamp_node(1, "") + lamp_node(2, "") + lamp_node(3, "") + lamp_node(4, ""),
      ",1,2,3,4,5", lamps));
  REQUIRE(s.lights.size() == 3);
  CHECK(s.lights[0].name == "bulb");
  CHECK(s.lights[0].shape == FileLight::Shape::point);
  CHECK(s.lights[0].position == Vec3(0, 0, 4));
  CHECK(s.lights[0].intensity == 40);
  CHECK(s.lights[0].color == Vec3f(1, 0.5f, 0));
  CHECK(s.lights[1].name == "beam");
  CHECK(s.lights[1].outer == Approx(0.5 * 180 / 3.14159265358979));
  CHECK(s.lights[1].intensity == 1);
  CHECK(s.lights[2].name == "light 3");
  CHECK(s.lights[2].forward == Vec3(0, 0, -1));
}

TEST_CASE("gltf scene: the data names what there is, and numbers of what is not there are refused") {
  const std::string text = triangle_with(R"(,{"camera":0,"name":"A"},{"camera":0,"name":"B"})" + lamp_node(0, ""), ",1,2,3",
                                         std::string(R"(,"cameras":[{"type":"perspective","perspective":{"yfov":1}}])") + lamps);
  const DatasetPtr d = test::read_text("a.gltf", text);
  const auto note = [&](std::string_view key) {
    for (const auto& [k, v] : d->notes())
      if (k == key) return v;
    return std::string();
  };
  CHECK(note(cameras_note) == "A, B");
  CHECK(note(lights_note) == "light 1");
  CHECK(test::contains(test::refusal("a.gltf", triangle_with(R"(,{"camera":0})", ",1", "")), "'camera' is 0"));
  CHECK(test::contains(test::refusal("a.gltf", triangle_with(lamp_node(7, ""), ",1", lamps)), "'light' is 7"));
  const FileScene none =
      scene_of_text(triangle_with(R"(,{"camera":0})", ",1", R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0}}])"));
  CHECK(none.cameras.empty());
}
