// SPDX-License-Identifier: Apache-2.0
// The library for C++ programs: operations with typed values, scenes, pictures and their recipes.

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

Data ball(int n) { return source("sphere", {{"size", n}}); }

}  // namespace

TEST_CASE("library: the area of a contour that was asked for by typed values is that of the sphere") {
  const Data surface = ball(48).run("contour", {{"values", 0.0}, {"normals", false}});
  CHECK(surface.kind() == "surface");
  const Data measured = surface.run("mass_properties");
  const Box b = surface.bounds();
  const double r = (b.hi[0] - b.lo[0]) / 2;
  CHECK(measured.kind() == "table");
  CHECK(measured.field("area").values.get(0) == doctest::Approx(4 * 3.14159265358979 * r * r).epsilon(0.01));
}

TEST_CASE("library: the schema's errors: unknown names, ranges, choices and types, all of one call together") {
  const Data grid = ball(8);
  CHECK(contains(refused([&] { grid.run("contuor"); }), "did you mean 'contour'?"));
  CHECK(contains(refused([&] { grid.run("contour", {{"valeus", 1}}); }), "did you mean 'values'?"));
  const std::string several = refused([&] { grid.run("contour", {{"normals", "perhaps"}, {"tolerance", -1}}); });
  CHECK(contains(several, "contour normals"));
  CHECK(contains(several, "contour tolerance"));
  CHECK(contains(refused([&] { grid.run("contour", {{"field", "nosuch"}}); }), "'nosuch' not found"));
  CHECK(contains(refused([&] { grid.run("probe"); }), "probe"));
  CHECK(contains(refused([] { source("sphere", {{"size", 1e99}}); }), "size"));
  CHECK(contains(refused([&] { Scene().show(grid, "surfaec"); }), "did you mean 'surface'?"));
  CHECK(contains(refused([&] { Scene().show(grid, "surface", {{"opacity", 7}}); }), "opacity"));
  CHECK(contains(refused([&] { Scene().camera({{"view", "frnt"}}); }), "did you mean 'front'?"));
  CHECK(contains(refused([&] { Scene().picture({{"tilte", "x"}}); }), "did you mean 'title'?"));
  CHECK(contains(refused([] { Scene().render(10, 10); }), "show()"));
  CHECK(contains(refused([&] { grid.write("/nowhere/x.vti"); }), "/nowhere"));
  CHECK(contains(refused([&] { grid.write("x.vti", {{"encoding", "asci"}}); }), "did you mean 'ascii'?"));
}

TEST_CASE("library: data say what was chosen when they were made, which the context hears as well, and not what was chosen before") {
  std::vector<std::string> heard;
  Context context;
  context.on_message([&](bool, std::string_view text) { heard.emplace_back(text); });
  const Data surface = ball(16).run("contour", {}, context);
  REQUIRE(surface.notes().size() == 1);
  CHECK(contains(surface.notes()[0], "contour: "));
  CHECK(heard == surface.notes());
  CHECK(surface.run("normals", {}, context).notes().empty());
  CHECK(ball(16).run("contour", {{"values", 0.1}}).notes().empty());
  CHECK(surface.with_cell_field("n", Array(std::vector<float>(surface.cell_count(), 1))).notes().empty());
  CHECK(Data().notes().empty());
}

TEST_CASE("library: text and typed values come to the same bytes") {
  const Data grid = ball(16);
  const auto typed = grid.run("contour", {{"values", {-0.1, 0.2}}, {"normals", false}});
  const auto text = grid.run("contour", {{"values", std::vector<double>{-0.1, 0.2}}, {"normals", false}});
  CHECK(typed.points().numbers() == text.points().numbers());
}

TEST_CASE("library: a picture is the one that its recipe makes, byte for byte") {
  const std::string folder = sg::test::temp_folder(), file = folder + "ball.vti", picture = folder + "ball.png";
  ball(24).write(file);
  const Data surface = read(file).run("contour", {{"values", 0}}).run("smooth");
  const Image image = Scene().show(surface).camera({{"azimuth", 30}}).picture({{"title", "Ball"}}).render(200, 150);
  CHECK(image.width() == 200);
  CHECK(image.pixels().size() == size_t(200 * 150 * image.channels()));
  CHECK(!image.notes().empty());
  image.write(picture);
  const sg::Image found = sg::read_png(picture);
  std::vector<std::string> changed;
  sg::PipelineFile recipe = sg::recipe_in(found, picture, changed);
  CHECK(changed.empty());
  sg::Context context;
  CHECK(sg::make_picture(recipe, {}, context).image.pixels == found.pixels);
  CHECK(std::equal(found.pixels.begin(), found.pixels.end(), image.pixels().begin(), image.pixels().end()));
}

TEST_CASE("library: a picture of parts of a collection that was read, and of what runs on them, is made again from its recipe") {
  const std::string folder = sg::test::temp_folder(), file = folder + "two.vtm", picture = folder + "two.png";
  ball(12).write(folder + "a.vti"), source("gyroid", {{"size", 10}}).write(folder + "b.vti");
  sg::write_file(file,
                 "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\">\n<vtkMultiBlockDataSet>\n"
                 "<DataSet index=\"0\" name=\"ball\" file=\"a.vti\"/>\n<DataSet index=\"1\" name=\"ball\" file=\"b.vti\"/>\n"
                 "</vtkMultiBlockDataSet>\n</VTKFile>\n");
  const auto parts = read(file).parts();
  REQUIRE(parts.size() == 2);
  const Image image = Scene().show(parts[0].second, "outline").show(parts[1].second.run("contour", {{"values", 0}})).render(64, 48);
  CHECK(!contains(image.recipe(), "memory"));
  CHECK(contains(image.recipe(), "part: ball"));
  CHECK(contains(image.recipe(), "part: \"#1\""));  // two of one name
  image.write(picture);
  const sg::Image found = sg::read_png(picture);
  std::vector<std::string> changed;
  sg::PipelineFile recipe = sg::recipe_in(found, picture, changed);
  sg::Context context;
  CHECK(sg::make_picture(recipe, {}, context).image.pixels == found.pixels);
}

TEST_CASE("library: numbers from memory are named in the recipe, and making the picture again is refused with a reason") {
  const Data grid = uniform_grid({4, 4, 4}).with_point_field("f", std::vector<float>(64, 1.0f));
  const Image image = Scene().show(grid, "outline").render(64, 48);
  CHECK(contains(image.recipe(), "memory:"));
  CHECK(contains(image.recipe(), "uniform 4x4x4"));
  sg::PipelineFile recipe = sg::parse_pipeline(image.recipe(), "recipe", sg::picture_vocabulary());
  sg::Context context;
  try {
    sg::make_picture(recipe, {}, context);
    CHECK(false);
  } catch (const sg::Error& e) {
    CHECK(contains(e.what(), "memory of the program"));
    CHECK(!contains(e.what(), " errors:"));  // one, not what follows from it
  }
}

TEST_CASE("library: several data in one scene, chosen and stated, keep what each was told") {
  const Data grid = ball(16), surface = grid.run("contour", {{"values", 0}});
  const Image image =
      Scene().show(surface).show(grid, "outline").show(grid.run("slice", {{"axis", "z"}}), "auto", {{"map", "ember"}}).render(64, 48);
  const std::string recipe = image.recipe();
  CHECK(contains(recipe, "contour"));
  CHECK(contains(recipe, "outline"));
  CHECK(contains(recipe, "map: ember"));
  CHECK(!contains(recipe, "auto"));
}

TEST_CASE("library: a scene that is changed leaves its copies alone") {
  const Data grid = ball(8);
  Scene one;
  one.show(grid, "outline");
  Scene two = one;
  two.picture({{"title", "two"}});
  CHECK(!contains(one.render(32, 32).recipe(), "two"));
  CHECK(contains(two.render(32, 32).recipe(), "two"));
}

TEST_CASE("library: operations that follow time read the steps of the file; of numbers at hand they have one") {
  const std::string folder = sg::test::temp_folder();
  // A uniform wind along x whose speed is the number of the step: by time t a particle has moved t*t/2.
  for (int step = 0; step < 3; ++step) {
    std::vector<float> wind;
    for (int i = 0; i < 9 * 3 * 3; ++i) wind.insert(wind.end(), {float(step), 0, 0});
    uniform_grid({9, 3, 3}).with_point_field("wind", Array(std::move(wind), 3)).write(folder + "wind_" + std::to_string(step) + ".vti");
  }
  const std::string series = folder + "wind_{n}.vti";
  CHECK(times(series) == std::vector<double>{0, 1, 2});
  const Data flow = read(series), seed = point_cloud(std::vector<double>{1, 1, 1});
  const Data path = flow.run("pathlines", {{"field", "wind"}}, {seed});
  CHECK(path.bounds().hi[0] == doctest::Approx(3).epsilon(1e-3));
}

TEST_CASE("library: work tells of its progress and ends when it is cancelled") {
  Context context;
  double last = -1;
  context.on_progress([&](double f, std::string_view) { last = f; });
  ball(16).run("contour", {{"values", 0}}, context);
  CHECK(last == 1);
  context.cancel();
  try {
    ball(16).run("contour", {{"values", 0}}, context);
    CHECK(false);
  } catch (const Error& e) {
    CHECK(e.kind() == Error::Kind::cancelled);
  }
}

TEST_CASE("library: help of an operation is that of the program") {
  CHECK(contains(help("contour"), "values"));
  CHECK(contains(help(), "streamlines"));
  CHECK(contains(refused([] { help("nosuch"); }), "unknown operation"));
}

TEST_CASE("library: legends of a picture are told as numbers") {
  const Data grid = ball(12);
  const std::vector<Legend> volume =
      Scene().show(grid, "volume", {{"range", {-1.0, 2.0}}, {"map", "gray"}, {"opacity", "0:0,1:0.5"}}).render(64, 48).legends();
  REQUIRE(volume.size() == 1);
  CHECK(volume[0].low == -1);
  CHECK(volume[0].high == 2);
  CHECK(volume[0].scale == "linear");
  REQUIRE(volume[0].colors.size() == 256);
  CHECK(volume[0].colors.front() == std::array<uint8_t, 3>{0, 0, 0});
  CHECK(volume[0].colors.back() == std::array<uint8_t, 3>{255, 255, 255});
  CHECK(volume[0].entries.empty());
  CHECK(volume[0].opacity == std::vector<std::pair<double, double>>{{-1, 0}, {2, 0.5}});
  CHECK(Scene().show(grid, "volume", {{"legend", false}}).render(64, 48).legends().empty());
}
