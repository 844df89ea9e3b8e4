// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/picture_lights.h"

#include <filesystem>
#include <string>

#include "base/file/file.h"
#include "image/codec.h"
#include "pipeline/file/pipeline_file.h"
#include "support/test.h"

using namespace sg;
using doctest::Approx;

namespace {

/// A flat Radiance picture of `pixels` mantissas, exponent 129: values about mantissa / 128.
std::string hdr(int width, int height, const std::string& pixels) {
  return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n" + pixels;
}
std::string grey(int count, int mantissa) {
  std::string s;
  for (int i = 0; i < count; ++i) s += char(mantissa), s += char(mantissa), s += char(mantissa), s += char(129);
  return s;
}

PipelineFile file_with(const std::string& picture, const std::string& origin = "") {
  return parse_pipeline("sightglass: 1\nsteps: {a: {gyroid: {size: 12}}, b: {contour: {values: 0}, from: a}}\npicture: " + picture, origin,
                        picture_vocabulary());
}
std::string refusal(const std::string& picture) {
  PipelineFile file = file_with(picture);
  return test::error_of([&] { stated_in(file); });
}

}  // namespace

TEST_CASE("picture lights: lists and maps of kinds in a pipeline file, or text, mean the same") {
  const std::string words = "\"sphere from=left size=0.3; sun; directional direction=0,1,2 color='1,0.5,0'\"";
  const PipelineFile text = file_with("{lights: " + words + ", environment: sky elevation=12}");
  const PipelineFile lists = file_with(
      "{lights: [{sphere: {from: left, size: 0.3}}, sun, {directional: {direction: [0, 1, 2], color: \"1,0.5,0\"}}], environment: {sky: "
      "{elevation: 12}}}");
  for (const PipelineFile& file : {text, lists, parse_pipeline(emit_pipeline(lists), "", picture_vocabulary())}) {
    const StatedPicture s = stated_in(file);
    REQUIRE(s.lighting.lights.size() == 3);
    CHECK(std::get<SphereLightParams>(s.lighting.lights[0]).size == 0.3);
    CHECK(std::get<DirectionalLightParams>(s.lighting.lights[2]).color == "1,0.5,0");
    CHECK(std::get<SkyEnvironmentParams>(*s.lighting.environment).elevation == 12);
  }
  CHECK(test::contains(refusal("{lights: [{spher: {size: 1}}]}"), "did you mean 'sphere'?"));
  CHECK(test::contains(refusal("{lights: [{sphere: {size: 0}}]}"), "size"));
  CHECK(test::contains(refusal("{environment: {sky: {elevation: 91}}}"), "elevation"));
  CHECK(test::contains(test::error_of([] { file_with("{lights: [[sphere]]}"); }), "lights"));
}

TEST_CASE("picture lights: what the rasterizer leaves out is said, and nothing where all is shown") {
  const auto note = [](const std::string& picture) { return note_of_lost_light(stated_in(file_with(picture)), Scene()); };
  CHECK(note("{size: 32x32}") == "");
  CHECK(note("{lights: directional from=left}") == "");
  CHECK(test::contains(note("{lights: sphere}"), "directions alone"));
  CHECK(test::contains(note("{environment: sky}"), "environment is left out"));
  CHECK(test::contains(note("{camera: {aperture: 0.1}}"), "aperture"));
  CHECK(test::contains(note("{noise: 0.05}"), "noise and paths"));
  CHECK(note("{lights: sphere, environment: sky, integrator: path, noise: 0.05}") == "");
  // Volumes in light cast shadows, and paths are followed where they ask for it.
  Scene matter;
  VolumeItem v;
  v.scattering.light = VolumeLighting::map;
  matter.items.emplace_back(v);
  const StatedPicture lit = stated_in(file_with("{lights: sphere}"));
  CHECK(test::contains(note_of_lost_light(lit, matter), "shadows are those of volumes"));
  CHECK(test::contains(note_of_lit_matter(lit, matter, {Legend()}), "those of the matter"));
  CHECK(note_of_lit_matter(lit, matter, {}) == "");
  CHECK(note_of_lit_matter(lit, Scene(), {Legend()}) == "");
  std::get<VolumeItem>(matter.items[0]).scattering.light = VolumeLighting::path;
  CHECK(note_of_lost_light(lit, matter) == "");
}

TEST_CASE("picture lights: pictures of all directions are read, and refused where they are missing, cut off or no light") {
  const std::string folder = test::fresh_folder("environments");
  Context context;
  write_file(folder + "a.hdr", hdr(4, 2, grey(4, 128) + grey(4, 64)));
  const auto read = read_environment(folder + "a.hdr", context);
  CHECK(read->width == 4);
  CHECK(read->pixels[0].x == Approx(128.5 / 128));
  CHECK(read->pixels[7].x == Approx(64.5 / 128));
  Image image(2, 2, 3);
  image.pixels.assign(12, 0);
  image.at(1, 0)[0] = 255, image.at(0, 1)[1] = 188;
  write_image(folder + "b.png", image);
  const auto png = read_environment(folder + "b.png", context);
  CHECK(png->pixels[1] == Vec3f{1, 0, 0});
  CHECK(png->pixels[2].y == Approx(0.5).epsilon(0.01));
  const auto refused = [&](const std::string& name) { return test::error_of([&] { read_environment(folder + name, context); }); };
  CHECK(test::contains(refused("none.hdr"), "none.hdr"));
  write_file(folder + "cut.hdr", hdr(4, 2, grey(7, 128)));
  CHECK(test::contains(refused("cut.hdr"), "cut off"));
  write_file(folder + "cut.png", MappedFile(folder + "b.png").text().substr(0, 40));
  CHECK(test::contains(refused("cut.png"), "cut.png"));
  write_file(folder + "sky.exr", "v/1\x01");
  CHECK(test::contains(refused("sky.exr"), ".hdr"));
  write_file(folder + "points.csv", "x,y,z\n1,2,3\n");
  CHECK(test::contains(refused("points.csv"), "no picture"));
}

TEST_CASE("picture lights: an environment is seen behind the data, its path is in the recipe, and a recipe may not lead out") {
  const std::string folder = test::fresh_folder("halls");
  std::filesystem::create_directories(folder + "in"), std::filesystem::create_directories(folder + "deep");
  write_file(folder + "in/hall.hdr", hdr(4, 2, grey(8, 64)));
  PipelineFile file = file_with(
      "{size: 48x32, integrator: path, noise: 0.1, paths: 32, legend: false, axes: false, triad: false, environment: ../in/hall.hdr}",
      folder + "deep/a.yaml");
  Context context;
  Picture picture = make_picture(file, {}, context);
  // (64.5 / 128) linear is 188 of 255.
  CHECK(int(picture.image.at(0, 0)[0]) == Approx(188).epsilon(0.01));
  attach_recipe(picture.image, file, folder + "a.png");
  std::vector<std::string> changed;
  const PipelineFile again = recipe_in(picture.image, folder + "a.png", changed);
  CHECK(environment_file(word_value(again.picture, "environment").value_or("")) == "in/hall.hdr");
  CHECK(changed.empty());
  write_file(folder + "in/hall.hdr", hdr(4, 2, grey(8, 32)));
  recipe_in(picture.image, folder + "a.png", changed);
  CHECK(changed.size() == 1);
  PipelineFile outside = file_with("{environment: /etc/hall.hdr}");
  CHECK(test::contains(test::error_of([&] { check_recipe(outside, folder + "a.png"); }), "/etc/hall.hdr"));
}
