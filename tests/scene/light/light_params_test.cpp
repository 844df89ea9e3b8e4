// SPDX-License-Identifier: Apache-2.0
#include "scene/light/light_params.h"

#include "scene/light/environment_params.h"
#include "scene/light/light_text.h"
#include "scene/light/lighting.h"
#include "scene/scene.h"
#include "support/test.h"

using namespace sg;
using doctest::Approx;

namespace {

std::string refusal(const std::string& lights) {
  return test::error_of([&] { parse_lights(lights); });
}
std::string no_environment(const std::string& text) {
  return test::error_of([&] { parse_environment(text); });
}
Box3 box() {
  Box3 b;
  b.add(Vec3{-1, -1, -1}), b.add(Vec3{1, 1, 1});
  return b;
}
PlacedLight placed(const std::string& text) { return place_lights({parse_lights(text), {}, {}}, box()).at(0); }

}  // namespace

TEST_CASE("lights: kinds with words, apart by semicolons") {
  const auto lights = parse_lights("sphere from=left-above size=0.3; Sun elevation=20 azimuth=120; ;rectangle size=0.4,0.2 color='#f80'");
  CHECK(lights.size() == 3);
  CHECK(std::get<SphereLightParams>(lights[0]).place.way.from == LightSide::left_above);
  CHECK(std::get<SunLightParams>(lights[1]).azimuth == 120);
  CHECK(std::get<RectangleLightParams>(lights[2]).size == std::vector<double>{0.4, 0.2});
  CHECK(parse_lights("").empty());
}

TEST_CASE("lights: what cannot be right is refused, with what would be") {
  CHECK(test::contains(refusal("spere size=1"), "did you mean 'sphere'?"));
  CHECK(test::contains(refusal("size=1 sphere"), "where the kind of light should"));
  CHECK(test::contains(refusal("sphere siez=1"), "size"));
  CHECK(test::contains(refusal("sphere size=0"), "above 0"));
  CHECK(test::contains(refusal("sphere radius=0"), "above 0"));
  CHECK(test::contains(refusal("disc radius=-1"), "above 0"));
  CHECK(test::contains(refusal("rectangle size=0.5,0"), "above 0"));
  CHECK(test::contains(refusal("rectangle width=1"), "both"));
  CHECK(test::contains(refusal("point power=0"), "above 0"));
  CHECK(test::contains(refusal("point brightness=0"), "above 0"));
  CHECK(test::contains(refusal("point brightness=nan"), "brightness"));
  CHECK(test::contains(refusal("point brightness=inf"), "brightness"));
  CHECK(test::contains(refusal("point position=nan,0,0"), "position"));
  CHECK(test::contains(refusal("point color=-1,0,0"), "not a colour"));
  CHECK(test::contains(refusal("point color=black"), "none"));
  CHECK(test::contains(refusal("point power=1 brightness=1"), "twice"));
  CHECK(test::contains(refusal("sphere size=1 radius=2"), "twice"));
  CHECK(test::contains(refusal("sphere from=left azimuth=20"), "twice"));
  CHECK(test::contains(refusal("sphere from=lefft-above"), "left-above"));
  CHECK(test::contains(refusal("disc position=1,1,1 target=1,1,1"), "same place"));
  CHECK(test::contains(refusal("directional direction=0,0,0"), "0,0,0"));
  CHECK(test::contains(refusal("sun elevation=91"), "90"));
  CHECK(test::contains(refusal("spot angle=181"), "180"));
  CHECK(test::contains(refusal("spot angle=20 inner=30"), "inner is above angle"));
  CHECK(test::contains(refusal("file brightness=2 lux=100"), "stated twice"));
  CHECK(test::contains(refusal("file lux=0"), "above 0"));
  CHECK(test::contains(refusal("sun elevation=-1"), "from 0 to 90"));
  CHECK(test::contains(refusal("point elevation=100"), "90"));
  std::string many;
  for (int i = 0; i < 1001; ++i) many += "point;";
  CHECK(test::contains(refusal(many), "more than 1000"));
}

TEST_CASE("environment: kinds, or the name of a file; what cannot be right is refused") {
  CHECK_FALSE(parse_environment(""));
  CHECK(std::get<SkyEnvironmentParams>(*parse_environment("sky elevation=-2")).elevation == -2);
  CHECK(std::get<EvenEnvironmentParams>(*parse_environment("even brightness=0.5")).brightness == 0.5);
  const auto picture = std::get<PictureEnvironmentParams>(*parse_environment("halls/hall.hdr rotate=90"));
  CHECK(picture.file == "halls/hall.hdr");
  CHECK(picture.rotate == 90);
  CHECK(environment_file("'my hall.hdr' strength=2") == "my hall.hdr");
  CHECK(environment_file("panorama strength=2 file=a.png") == "a.png");
  CHECK(environment_file("panorama 'file =a.png'") == "a.png");
  CHECK(environment_file(with_environment_file("panorama file=a.png", "it's/hall.hdr")) == "it's/hall.hdr");
  CHECK(environment_file("sky") == "");
  CHECK(environment_file("'sky") == "");
  const std::string moved = with_environment_file("'my hall.hdr' strength=2", "../the hall.hdr");
  CHECK(environment_file(moved) == "../the hall.hdr");
  CHECK(std::get<PictureEnvironmentParams>(*parse_environment(moved)).strength == 2);
  CHECK(test::contains(no_environment("skye"), "did you mean 'sky'?"));
  CHECK(test::contains(no_environment("panorama"), "no file"));
  CHECK(test::contains(no_environment("sky elevation=100"), "90"));
  CHECK(test::contains(no_environment("even brightness=0"), "above 0"));
  CHECK(test::contains(no_environment("even color=1,-1,0"), "not a colour"));
  CHECK(test::contains(no_environment("hall.hdr strength=-1"), "above 0"));
}

TEST_CASE("lights: sizes and distances are shares of the data, brightness is that of a white surface which faces the light") {
  const double diagonal = box().diagonal();
  const PlacedLight ball = placed("sphere size=0.5 distance=2");
  CHECK(ball.radius == Approx(0.25 * diagonal));
  CHECK(length(ball.way) == Approx(2 * diagonal));
  // L pi (r / d)^2 = pi.
  CHECK(ball.radiance * std::pow(ball.radius / (2 * diagonal), 2) == Approx(1));
  CHECK(placed("point position=0,0,3 power=100").radiance == Approx(100 / (4 * 3.14159265358979)));
  // 4 pi^2 from a point at a distance of 1 is white.
  CHECK(placed("point position=0,0,1 power=39.478417604357").brightness == Approx(1));
  CHECK(placed("disc position=0,0,5 radius=2 brightness=3").brightness == Approx(3));
  // A spot at full strength in all of a half space gives half of what a point of that strength would.
  CHECK(placed("spot position=0,0,3 power=100 angle=180 inner=180").radiance == Approx(100 / (2 * 3.14159265358979)));
  CHECK(placed("spot position=0,0,5 brightness=3").brightness == Approx(3));
  // A large square seen from near fills a half space: irradiance pi L.
  CHECK(placed("rectangle position=0,0,1 width=1e5 height=1e5").radiance == Approx(1).epsilon(1e-4));
}

TEST_CASE("lights: they stand where the viewer sees them, or by the compass, and renderers without paths get directions") {
  CHECK(placed("point from=right").way.x > 0);
  CHECK(placed("point from=right").follows_camera);
  CHECK(placed("point azimuth=90").way.x == Approx(2.5 * box().diagonal()));
  const PlacedLight north = placed("directional azimuth=0 frame=data"), east = placed("directional azimuth=90 elevation=30 frame=data");
  CHECK(north.way.y == Approx(1));
  CHECK(east.way.x == Approx(std::cos(30 * 3.14159265358979 / 180)));
  CHECK(east.way.z == Approx(0.5));
  CHECK_FALSE(east.follows_camera);
  // Without an azimuth the sun is over the left shoulder, as high as stated however the viewer looks down.
  Lighting sun{parse_lights("sun elevation=30"), {}, {}};
  const Vec3 down = normalize(Vec3{0, 1, -2}), right{1, 0, 0};
  const Vec3 way = world_way(place_lights(sun, box())[0], sun, right, cross(right, down), down);
  CHECK(way.z == Approx(0.5));
  CHECK(way.x < -0.3);
  CHECK(way.y < -0.3);
  Scene scene;
  scene.lighting.lights = parse_lights("sphere from=left brightness=0.5; point position=0,0,9 color=#f00");
  const auto lamps = lights_of(scene);
  REQUIRE(lamps.size() == 2);
  CHECK(lamps[0].follows_camera);
  CHECK(lamps[0].intensity == Approx(0.45));
  CHECK_FALSE(lamps[1].follows_camera);
  CHECK(lamps[1].intensity == Approx(0.9 * 0.2126));
}

TEST_CASE("lights: texts are taken apart and put together to the same") {
  for (const std::string text :
       {"sphere from=left size=0.3; sun", "file 'names=Lamp one,Window'", "rectangle color=#ff8800 position=1,2,3"}) {
    CHECK(text_of_lights(lights_of_text(text)) == text);
    CHECK(lights_of_text(text_of_lights(lights_of_text(text))) == lights_of_text(text));
  }
  CHECK(lights_of_text(" ; ").empty());
  CHECK_FALSE(environment_of_text("  "));
  const auto hall = environment_of_text("my/hall.hdr rotate=90");
  REQUIRE(hall);
  CHECK(hall->kind == "panorama");
  CHECK(hall->words == std::vector<std::string>{"file=my/hall.hdr", "rotate=90"});
  CHECK(environment_of_text(text_of_light(*hall)) == hall);
}
