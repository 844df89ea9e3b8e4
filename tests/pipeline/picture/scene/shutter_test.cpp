// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/scene/shutter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/picture/scene/picture_scene.h"
#include "support/test.h"

using namespace sg;

namespace {

PipelineFile moving(const std::string& camera) {
  return parse_pipeline(
      "sightglass: 1\nsteps:\n  grid: {sphere: {size: 24, radius: 0.5}}\n  ball: {contour: {values: [0]}, from: grid}\n"
      "scene:\n  - {node: a, keys: [{time: 0}, {time: 1, translate: [4, 0, 0]}], time: 0.5, show: [{surface: {color: black, lit: false}, "
      "of: ball}]}\n"
      "picture: {size: 96x96, axes: false, triad: false, frame: [-1, 5, -3, 3, -1, 1], camera: {view: front, projection: parallel" +
          camera + "}}",
      "m.yaml", picture_vocabulary());
}
Image picture_of(const std::string& camera) {
  PipelineFile file = moving(camera);
  Context context;
  return make_picture(file, {}, context).image;
}

}  // namespace

TEST_CASE("shutter: moments lie evenly in the time that it is open, about that of the picture") {
  CameraParams camera;
  CHECK(moments_of(moving(""), camera).empty());
  camera.shutter = 0.4, camera.moments = 4;
  const auto moments = moments_of(moving(""), camera);
  REQUIRE(moments.size() == 4);
  const double wanted[] = {0.35, 0.45, 0.55, 0.65};
  for (size_t k = 0; k < 4; ++k) CHECK(stated_scene(moments[k])[0].place.shift.x == doctest::Approx(4 * wanted[k]));
  PipelineFile still = moving("");
  still.scene[0].keys.clear(), still.scene[0].words.clear();
  CHECK(moments_of(still, camera).empty());
}

TEST_CASE("shutter: a ball that moves by less than itself is dark in its middle, and as much darkness is seen in all") {
  const Image sharp = picture_of(""), blurred = picture_of(", shutter: 0.2, moments: 32"),
              still = picture_of(", shutter: 1e-9, moments: 2");
  CHECK(still.pixels == sharp.pixels);  // the mean of equal pictures
  const auto darkness = [](const Image& image, int y, int x) { return 1 - double(srgb_decode(float(image.at(x, y)[0]) / 255)); };
  double sums[2] = {0, 0}, widths[2] = {0, 0};
  const Image* images[2] = {&sharp, &blurred};
  for (int i = 0; i < 2; ++i)
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x) {
        const double d = darkness(*images[i], y, x);
        sums[i] += d;
        if (y == 48) widths[i] += d > 0.02;
      }
  CHECK(sums[1] == doctest::Approx(sums[0]).epsilon(0.02));
  CHECK(darkness(blurred, 48, 48) == doctest::Approx(1));  // covered at every moment: it moves by 0.8 of 1
  // A disc of 1 that moves by 0.8 covers 1.8.
  CHECK(widths[1] / widths[0] == doctest::Approx(1.8).epsilon(0.1));
}

TEST_CASE("shutter: steps that state a time move, too, in the colours of the picture's own time") {
  const auto drift = [](const std::string& time, const std::string& camera) {
    PipelineFile file = parse_pipeline("sightglass: 1\nsteps:\n  a: {drift: {size: 17, time: " + time +
                                           "}}\nshow:\n  - {surface: {lit: false}}\npicture: {size: 48x48, axes: false, triad: false, "
                                           "legend: false, camera: {view: front, projection: parallel" +
                                           camera + "}}",
                                       "m.yaml", picture_vocabulary());
    return file;
  };
  CameraParams camera;
  camera.shutter = 2, camera.moments = 2;
  const auto moments = moments_of(drift("3", ""), camera);
  REQUIRE(moments.size() == 2);
  CHECK(word_value(moments[0].steps[0].words, "time") == "2.5");
  CHECK(word_value(moments[1].steps[0].words, "time") == "3.5");
  Context context;
  PipelineFile sharp = drift("3", ""), still = drift("3", ", shutter: 1e-12, moments: 2"), blurred = drift("3", ", shutter: 2, moments: 4");
  const Image image = make_picture(sharp, {}, context).image;
  CHECK(make_picture(still, {}, context).image.pixels == image.pixels);
  CHECK(make_picture(blurred, {}, context).image.pixels != image.pixels);
  // Nothing moves: told.
  std::string said;
  context.on_log = [&](LogLevel, std::string_view text) { said += text; };
  PipelineFile rests = parse_pipeline("sightglass: 1\nsteps:\n  a: {tangle: {size: 9}}\npicture: {size: 8x8, camera: {shutter: 1}}",
                                      "r.yaml", picture_vocabulary());
  make_picture(rests, {}, context);
  CHECK(test::contains(said, "nothing moves"));
}

TEST_CASE("shutter: the mean is that of light, of what is brighter than white, too") {
  Frame bright(1, 1), nothing(1, 1);
  bright.rgba = {4, 1, 0, 1}, nothing.rgba = {0, 0, 0, 0};
  MeanFrame mean;
  mean.add(bright);
  CHECK(std::ranges::equal(bright.rgba, std::array{4.f, 1.f, 0.f, 1.f}));
  mean.add(nothing);
  CHECK(std::ranges::equal(nothing.rgba, std::array{2.f, 0.5f, 0.f, 0.5f}));
  // A ball that shines four times as bright as white and is seen half of the time is white all along its way.
  PipelineFile file = moving(", shutter: 0.5, moments: 2");
  file.show[0].words = {"color=white", "material=matte", "emission=4,4,4"};
  file.picture.push_back("background=black"), file.picture.push_back("integrator=path"), file.picture.push_back("paths=4");
  Context context;
  const Image image = make_picture(file, {}, context).image;
  CHECK(image.at(40, 48)[0] == 255);
  CHECK(image.at(56, 48)[0] == 255);
}
