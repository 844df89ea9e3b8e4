// SPDX-License-Identifier: Apache-2.0
// The library for C++ programs: films of scenes, and of pictures that the program makes itself.
#include "pipeline/film/film.h"

#include <stdexcept>

#include "api/api_errors.h"
#include "api/sightglass.h"
#include "base/file/file.h"
#include "image/codec.h"
#include "pipeline/picture/picture.h"
#include "support/test.h"

using namespace sightglass;
using sg::test::contains;
using sg::test::refused;

namespace {

std::string bytes_of(const std::string& path) { return std::string(sg::MappedFile(path).text()); }

// Three files of a ball that grows.
std::string series_in(const std::string& folder) {
  for (int step = 0; step < 3; ++step) {
    std::vector<float> distance;
    for (int k = -4; k < 5; ++k)
      for (int j = -4; j < 5; ++j)
        for (int i = -4; i < 5; ++i) distance.push_back(std::sqrt(float(i * i + j * j + k * k)) / float(step + 2));
    uniform_grid({9, 9, 9}).with_point_field("distance", std::move(distance)).write(folder + "ball_" + std::to_string(step) + ".vti");
  }
  return folder + "ball_{n}.vti";
}

// What the command line makes of a pipeline file.
sg::FilmWritten by_pipeline(const std::string& yaml, const std::string& output) {
  sg::PipelineFile file = sg::parse_pipeline(yaml, "", sg::picture_vocabulary());
  sg::FilmParams params;
  sg::take_film_words(file, params);
  params.output = output;
  sg::Context context;
  return sg::write_film(file, params, {}, context);
}

}  // namespace

TEST_CASE("library: a film of a series is the command line's, numbered picture by numbered picture, byte for byte") {
  const std::string folder = sg::test::temp_folder(), series = series_in(folder);
  const Data ball = read(series);
  const std::vector<double> times = Scene()
                                        .show(ball.run("contour", {{"values", 1}}))
                                        .show(ball, "outline")
                                        .picture({{"title", "Step {t}"}})
                                        .film(folder + "api_{n}.png", {{"times", {0, 2}}}, 80, 60);
  CHECK(times == std::vector<double>{0, 2});
  by_pipeline("sightglass: 1\nsteps:\n  read: {read: \"" + series +
                  "\"}\n  contour: {contour: {values: [1]}}\n"
                  "show: [{auto: {}}, {outline: {}, of: read}]\npicture: {title: 'Step {t}', size: 80x60, times: [0, 2]}\n",
              folder + "cli_{n}.png");
  for (const char* number : {"000", "001"}) {
    const std::string mine = bytes_of(folder + "api_" + number + ".png");
    CHECK(mine.size() > 1000);
    CHECK(mine == bytes_of(folder + "cli_" + number + ".png"));
  }
  CHECK(bytes_of(folder + "api_000.png") != bytes_of(folder + "api_001.png"));
  // One of them, made again from its recipe.
  const sg::Image found = sg::read_png(folder + "api_001.png");
  std::vector<std::string> changed;
  sg::PipelineFile recipe = sg::recipe_in(found, folder + "api_001.png", changed);
  sg::Context context;
  CHECK(sg::make_picture(recipe, {}, context).image.pixels == found.pixels);
}

TEST_CASE("library: the pictures of a film come to the program in order, with their times and recipes") {
  const Data gyre = source("double_gyre", {{"dims", {21, 11, 1}}});
  Context context;
  std::vector<double> told;
  context.on_progress([&](double f, std::string_view) { told.push_back(f); });
  std::vector<double> seen;
  std::vector<std::string> recipes;
  const auto take = [&](const Frame& f) {
    CHECK(f.number == seen.size());
    CHECK(f.count == 3);
    seen.push_back(f.time), recipes.push_back(f.image.recipe());
  };
  const std::vector<double> times = Scene().show(gyre, "surface").frames(take, {{"times", "0:1:3"}}, 60, 40, context);
  CHECK(times == std::vector<double>{0, 0.5, 1});
  CHECK(seen == times);
  CHECK(contains(recipes[1], "time: 0.5"));
  CHECK(std::is_sorted(told.begin(), told.end()));
  CHECK(told.back() == 1);
  CHECK_THROWS_AS(Scene().show(gyre).frames([](const Frame&) { throw std::out_of_range("enough"); }, {{"times", {0, 1}}}, 20, 20),
                  std::out_of_range);
}

TEST_CASE("library: a camera goes around data that stand still, from memory too, and nothing of them runs again") {
  const std::string folder = sg::test::temp_folder();
  std::vector<float> numbers(125);
  for (size_t i = 0; i < numbers.size(); ++i) numbers[i] = float(i);
  Scene scene;
  {
    const Data grid = uniform_grid({5, 5, 5}).with_point_field("f", std::move(numbers));
    scene.show(grid.run("contour", {{"values", 60}}), "surface");
  }
  scene.camera({{"azimuth", "{t}"}});
  scene.film(folder + "orbit_{n}.png", {{"times", "0:90:3"}}, 64, 48);
  const sg::Image second = sg::read_png(folder + "orbit_001.png");
  const Image still = scene.camera({{"azimuth", 45}}).render(64, 48);
  CHECK(std::equal(second.pixels.begin(), second.pixels.end(), still.pixels().begin(), still.pixels().end()));
  CHECK(bytes_of(folder + "orbit_000.png") != bytes_of(folder + "orbit_001.png"));
  // The program's own loop comes to the same.
  Film film(folder + "loop_{n}.png");
  for (const int azimuth : {0, 45, 90}) film.add(scene.camera({{"azimuth", azimuth}}).render(64, 48));
  film.finish();
  CHECK(sg::read_png(folder + "loop_001.png").pixels == second.pixels);
  CHECK(contains(refused([&] { film.finish(); }), "is finished"));
}

TEST_CASE("library: a .webm is there when it is finished, with the bytes of the same film by the pipeline") {
  const std::string folder = sg::test::temp_folder(), series = series_in(folder);
  try {
    Film probe(folder + "probe.webm");
    probe.add(Scene().show(read(series), "outline").render(32, 32));
    CHECK_FALSE(sg::file_exists(folder + "probe.webm"));
    probe.finish();
  } catch (const Error& e) {
    if (!contains(e.what(), "plug")) throw;
    return;  // without an encoder there are no films
  }
  CHECK(sg::file_exists(folder + "probe.webm"));
  Scene().show(read(series), "outline").film(folder + "api.webm", {{"fps", 5}}, 64, 48);
  by_pipeline("sightglass: 1\nsteps:\n  read: {read: \"" + series + "\"}\nshow: [{outline: {}}]\npicture: {size: 64x48, fps: 5}\n",
              folder + "cli.webm");
  CHECK(bytes_of(folder + "api.webm") == bytes_of(folder + "cli.webm"));
}

TEST_CASE("library: films that cannot be are refused with what would be right") {
  const std::string folder = sg::test::temp_folder();
  const Data ball = source("sphere", {{"size", 8}});
  const Scene scene = Scene().show(ball, "outline");
  CHECK(contains(refused([&] { scene.film("x.webm", {{"tims", {0, 1}}}); }), "did you mean 'times'?"));
  CHECK(contains(refused([&] { scene.film("x.webm", {{"fps", 0}}); }), "from 0.1 to 1000"));
  CHECK(contains(refused([&] { scene.film(folder + "x_{n}.png"); }), "times"));
  CHECK(contains(refused([&] { scene.film(folder + "x.png", {{"times", {0, 1}}}); }), "out_{n}.png"));
  CHECK(contains(refused([&] { scene.film("", {{"times", {0, 1}}}); }), "is not named"));
  CHECK(contains(refused([&] { scene.frames([](const Frame&) {}, {{"fps", 3}}); }), "fps"));
  CHECK(contains(refused([&] { Film("/nowhere/x_{n}.png"); }), "/nowhere"));
  CHECK(contains(refused([&] {
                   Film film(folder + "y_{n}.png");
                   film.finish();
                 }),
                 "has no picture"));
  CHECK(contains(refused([&] { Scene().film("x.webm"); }), "show()"));
  CHECK(contains(refused([&] { Scene().show(ball).camera({{"azimuth", "{t}"}}).render(8, 8); }), "{t}"));
  CHECK(contains(refused([&] { Scene().camera({{"azimut", "{t}"}}); }), "did you mean 'azimuth'?"));
  Context context;
  context.cancel();
  const Data gyre = source("double_gyre", {{"dims", {21, 11, 1}}});
  try {
    Scene().show(gyre).film(folder + "z_{n}.png", {{"times", {0, 1}}}, 20, 20, context);
    CHECK(false);
  } catch (const Error& e) {
    CHECK(e.kind() == Error::Kind::cancelled);
  }
}
