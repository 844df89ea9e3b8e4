// SPDX-License-Identifier: Apache-2.0
// Cameras and lights of the file that a picture shows.
#include "pipeline/picture/scene/picture_files.h"

#include <cmath>
#include <variant>

#include "base/file/file.h"
#include "io/gltf_with_nodes.h"
#include "pipeline/picture/prepare.h"
#include "support/test.h"

using namespace sg;
using doctest::Approx;
using test::lamp_node, test::lamps, test::triangle_with;

namespace {

// A camera at (0, 0, 5), a parallel one above; a point of 40 cd at (0, 0, 4), a spot of 1 cd at (0, 0, 2), a distant light of 3 lux.
std::string lit_triangle() {
  return triangle_with(R"(,{"camera":0,"name":"Front","translation":[0,0,5]},{"camera":1,"name":"Flat","translation":[0,1,9]})" +
                           lamp_node(0, R"(,"name":"Bulb","translation":[0,0,4])") +
                           lamp_node(1, R"(,"name":"Beam","translation":[0,0,2])") + lamp_node(2, R"(,"name":"Sun")"),
                       ",1,2,3,4,5",
                       std::string(R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0.5}},
                         {"type":"orthographic","orthographic":{"ymag":1.5}}])") +
                           lamps);
}
PreparedPicture lit_picture(const std::string& picture, const std::string& text = lit_triangle()) {
  const std::string path = test::temp_folder() + "lit.gltf";
  write_file(path, text);
  PipelineFile file = parse_pipeline(
      "sightglass: 1\nsteps: {a: {read: " + path + "}}\nshow: [{surface: {color: white}}]\npicture: " + picture, "", picture_vocabulary());
  Context context;
  return prepare_picture(file, {}, context);
}
std::string lit_refusal(const std::string& picture, const std::string& text = lit_triangle()) {
  return test::error_of([&] { lit_picture(picture, text); });
}
bool notes_have(const PreparedPicture& p, const std::string& text) {
  for (const std::string& n : p.notes)
    if (test::contains(n, text)) return true;
  return false;
}

}  // namespace

TEST_CASE("camera of the file: by name, by number and with words of one's own beside it") {
  const CameraParams front = lit_picture("{camera: {file: Front}}").stated.camera;
  CHECK(*front.position == Vec3(0, 0, 5));
  CHECK(length(*front.target) < 1e-12);  // at the depth of the data
  CHECK(*front.up == Vec3(0, 1, 0));
  CHECK(*front.view_angle == Approx(0.5 * 180 / 3.14159265358979));
  CHECK(*lit_picture("{camera: {file: Front, view_angle: 30}}").stated.camera.view_angle == 30);  // also where it is the usual one
  const CameraParams second = lit_picture("{camera: file=2}").stated.camera;
  CHECK(*second.position == Vec3(0, 1, 9));
  CHECK(second.projection == ProjectionKind::parallel);
  CHECK(*second.height == 3);
  CHECK(*lit_picture("{camera: file}").stated.camera.position == Vec3(0, 0, 5));
  const CameraParams moved = lit_picture("{camera: {file: Front, position: [1, 0, 5], aperture: 0.1}}").stated.camera;
  CHECK(*moved.position == Vec3(1, 0, 5));
  CHECK(moved.aperture == 0.1);
  CHECK(test::contains(lit_refusal("{camera: {file: Frnt}}"), "did you mean 'Front'"));
  CHECK(test::contains(lit_refusal("{camera: {file: 3}}"), "the file has 2"));
  CHECK(test::contains(lit_refusal("{camera: file}", triangle_with("", "", "")), "no cameras"));
}

TEST_CASE("lights of the file: their ratios stay, together they make white, or as many lux as are stated") {
  const auto lights = [](const std::string& picture) { return lit_picture(picture).stated.lighting.lights; };
  // At the origin: 40 / 16, 1 / 4 and 3 lux; the first is of the linear colour 1, 0.5, 0 and of that luminance.
  const double bulb = 40.0 / 16, luminance = 0.2126 + 0.7152 * 0.5, beam = 1.0 / 4, sun = 3;
  const double white = bulb * luminance + beam + sun;
  const auto all = lights("{lights: [file]}");
  REQUIRE(all.size() == 3);
  const auto& p = std::get<PointLightParams>(all[0]);
  CHECK(*p.place.position == Vec3(0, 0, 4));
  CHECK(p.strength.brightness == Approx(bulb / white));
  CHECK(light_color(p.strength.color).y == Approx(0.5).epsilon(1e-4));
  const auto& s = std::get<SpotLightParams>(all[1]);
  CHECK(s.angle == Approx(2 * 0.5 * 180 / 3.14159265358979));
  CHECK(s.strength.brightness == Approx(beam / white));
  CHECK(*s.place.target == Vec3());
  const auto& d = std::get<DirectionalLightParams>(all[2]);
  CHECK(*d.direction == Vec3(0, 0, 1));
  CHECK(d.brightness == Approx(sun / white));
  // Placed, each gives the irradiance that it has in the file.
  Box3 box;
  box.add(Vec3(-1, -1, 0)), box.add(Vec3(1, 1, 0));
  Lighting lighting;
  lighting.lights = lights("{lights: [{file: {lux: 2}}]}");
  const auto placed = place_lights(lighting, box);
  CHECK(placed[0].radiance / 16 * 2 / 3.14159265358979 == Approx(bulb));
  CHECK(placed[1].radiance / 4 * 2 / 3.14159265358979 == Approx(beam));
  CHECK(placed[2].brightness * 2 == Approx(sun));
  const auto one = lights("{lights: [{file: {names: Beam, brightness: 0.5}}, sphere]}");
  REQUIRE(one.size() == 2);
  CHECK(std::get<SpotLightParams>(one[0]).strength.brightness == Approx(0.5));
  CHECK(test::contains(lit_refusal("{lights: [{file: {names: Bem}}]}"), "did you mean 'Beam'"));
  CHECK(test::contains(lit_refusal("{lights: [file]}", triangle_with("", "", "")), "no lights"));
}

TEST_CASE("cameras and lights of a file that are not asked for are told of") {
  CHECK(notes_have(lit_picture("{size: 32x32}"), "cameras (Front, Flat): --camera file, and lights (Bulb, Beam, Sun): --light file"));
  CHECK(notes_have(lit_picture("{camera: top}"), "the file has lights"));
  CHECK_FALSE(notes_have(lit_picture("{camera: top, lights: [sun]}"), "the file has"));
}
