// SPDX-License-Identifier: Apache-2.0
// Pictures on surfaces in pipeline files and recipes: where their paths begin, and where they are drawn.
#include <algorithm>
#include <filesystem>
#include <string>

#include "base/file/file.h"
#include "image/codec.h"
#include "pipeline/file/pipeline_file.h"
#include "pipeline/picture/picture.h"
#include "support/test.h"

using namespace sg;

namespace {

PipelineFile file_showing(const std::string& show, const std::string& origin = "") {
  return parse_pipeline(
      "sightglass: 1\nsteps: {a: {gyroid: {size: 12}}, b: {slice: {axis: z}, from: a}, c: {texture_coordinates: {axis: z}, from: "
      "b}}\nshow: "
      "[{surface: " +
          show + "}]\npicture: {size: 48x48, legend: false, axes: false, triad: false, background: white}",
      origin, picture_vocabulary());
}

void write_colored(const std::string& path, uint8_t red, uint8_t green) {
  Image image(2, 2, 3);
  for (size_t i = 0; i < 4; ++i) image.pixels[3 * i] = red, image.pixels[3 * i + 1] = green;
  write_image(path, image);
}

}  // namespace

TEST_CASE("surface picture: its path begins at the pipeline file, and in a recipe at the picture") {
  const std::string folder = test::fresh_folder("surface_pictures");
  std::filesystem::create_directories(folder + "in"), std::filesystem::create_directories(folder + "deep");
  write_colored(folder + "in/red.png", 255, 0);
  PipelineFile file = file_showing("{picture: ../in/red.png, lit: false}", folder + "deep/a.yaml");
  Context context;
  Picture picture = make_picture(file, {}, context);
  const uint8_t* middle = picture.image.at(24, 24);
  CHECK(int(middle[0]) == 255);
  CHECK(int(middle[1]) == 0);
  CHECK(picture.legends.empty());
  attach_recipe(picture.image, file, folder + "a.png");
  std::vector<std::string> changed;
  const PipelineFile again = recipe_in(picture.image, folder + "a.png", changed);
  REQUIRE(again.show.size() == 1);
  CHECK(std::find(again.show[0].words.begin(), again.show[0].words.end(), "picture=in/red.png") != again.show[0].words.end());
  CHECK(changed.empty());
  write_colored(folder + "in/red.png", 0, 255);
  recipe_in(picture.image, folder + "a.png", changed);
  CHECK(changed.size() == 1);
  const PipelineFile outside = file_showing("{picture: /etc/wood.png}");
  CHECK(test::contains(test::error_of([&] { check_recipe(outside, folder + "a.png"); }), "/etc/wood.png"));
  PipelineFile missing = file_showing("{picture: none.png}", folder + "deep/a.yaml");
  CHECK(test::contains(test::error_of([&] { make_picture(missing, {}, context); }), "none.png"));
}
