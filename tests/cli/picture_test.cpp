// SPDX-License-Identifier: Apache-2.0
// The whole way: file to picture, recipe and back, on any number of threads.
#include <nlohmann/json.hpp>

#include "base/file/file.h"
#include "cli/program.h"
#include "image/codec.h"
#include "support/test.h"

using namespace sg;
using test::bytes_of;
using test::must;
using test::sightglass;

namespace {

// Pixels that are not background.
size_t ink(const Image& image) {
  size_t n = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) n += image.at(x, y)[0] + image.at(x, y)[1] + image.at(x, y)[2] < 3 * 250;
  return n;
}

}  // namespace

TEST_CASE("pictures: the same bytes for 1 and 8 threads: surface, volume, both together, translucent, labels") {
  const std::vector<std::vector<std::string>> scenes = {
      {"--source", "gyroid size=40", "-f", "contour values=0"},
      {"--source", "hydrogen size=40"},
      {"--source", "tangle size=40", "-f", "contour values=-4,6", "--show", "surface opacity=0.5"},
      {"--source", "torus size=32", "--show", "volume opacity=0:0,1:0.1", "--show", "outline"},
      {"--source", "abc size=24", "-f", "magnitude", "-f", "slice normal=1,1,1", "--show", "surface edges=true"},
  };
  for (const auto& scene : scenes) {
    for (const char* threads : {"1", "8"}) {
      std::vector<std::string> args = {"render", "--size", "320x240", "--threads", threads, "-o", std::string("t") + threads + ".png"};
      args.insert(args.end(), scene.begin(), scene.end());
      must(args);
    }
    INFO(scene[1]);
    CHECK(bytes_of("t1.png") == bytes_of("t8.png"));
    CHECK(ink(read_png(test::temp_folder() + "t1.png")) > 1500);
  }
}

TEST_CASE("recipe: a picture is made again from itself, byte for byte, and says when its input changed") {
  must({"convert", "--source", "tangle size=24", "-o", "data.vti"});
  must({"render", "data.vti", "-f", "contour values=2", "--camera", "azimuth=20 zoom=1.2", "--title", "A title", "--size", "400x300", "-o",
        "a.png"});
  must({"open", "a.png", "-o", "b.png"});
  CHECK(bytes_of("a.png") == bytes_of("b.png"));
  const auto recipe = sightglass({"open", "a.png", "--recipe"});
  CHECK(recipe.out.find("contour") != std::string::npos);
  CHECK(recipe.out.find("data.vti") != std::string::npos);
  CHECK(recipe.out.find(test::temp_folder()) == std::string::npos);  // paths are relative to the picture
  write_file(test::temp_folder() + "recipe.yaml", recipe.out);
  must({"run", "recipe.yaml", "-o", "c.png"});
  CHECK(bytes_of("a.png") == bytes_of("c.png"));

  must({"convert", "--source", "tangle size=24 bounds=-2,2,-2,2,-2,2", "-o", "data.vti"});
  const auto again = sightglass({"open", "a.png", "-o", "b.png"});
  CHECK(again.status == 0);
  CHECK(again.err.find("data.vti") != std::string::npos);
  write_image(test::temp_folder() + "plain.png", Image(4, 4, 3));
  const auto none = sightglass({"open", "plain.png"});
  CHECK(none.status == 3);
  CHECK(none.err.find("no recipe") != std::string::npos);
}

TEST_CASE("info: JSON for programs, with exact numbers") {
  must({"convert", "--source", "torus size=9", "-o", "torus.vti"});
  const auto r = sightglass({"info", "--json", "torus.vti"});
  const auto j = nlohmann::json::parse(r.out);
  CHECK(j["kind"] == "uniform");
  CHECK(j["dims"] == nlohmann::json({9, 9, 9}));
  CHECK(j["points"] == 729);
  CHECK(j["cells"] == 512);
  CHECK(j["cell_types"]["Voxel"] == 512);
  CHECK(j["bounds"].size() == 6);
  REQUIRE(j["fields"].size() == 1);
  CHECK(j["fields"][0]["association"] == "point");
  CHECK(j["fields"][0]["components"] == 1);
  CHECK(j["fields"][0]["range"].size() == 1);
  CHECK(j["fields"][0]["nan"] == 0);
  CHECK(j["times"].empty());
  CHECK(nlohmann::json::parse(sightglass({"info", "--json", "--quick", "torus.vti"}).out)["fields"][0].count("range") == 0);
  CHECK(sightglass({"info", "torus.vti"}).out.find("uniform 9 x 9 x 9") != std::string::npos);
}

TEST_CASE("convert: every writable format reads back with the same points and cells") {
  for (const char* name : {"s.vtp", "s.stl", "s.ply", "s.obj"}) {
    must({"convert", "--source", "sphere size=16", "-f", "contour values=0", "-o", name});
    const auto j = nlohmann::json::parse(sightglass({"info", "--json", name}).out);
    INFO(name);
    CHECK(j["kind"] == "surface");
    CHECK(j["cell_types"]["Triangle"].get<int>() == 2 * (j["points"].get<int>() - 2));  // closed, genus 0: T = 2(V - 2)
  }
  must({"convert", "--source", "sphere size=12", "-f", "threshold max=0", "-o", "t.vtu", "--compression", "zlib"});
  CHECK(nlohmann::json::parse(sightglass({"info", "--json", "t.vtu"}).out)["kind"] == "unstructured");
  must({"convert", "--source", "sphere size=12", "-o", "g.nrrd", "--compression", "gzip"});
  CHECK(nlohmann::json::parse(sightglass({"info", "--json", "g.nrrd"}).out)["points"] == 1728);
}

TEST_CASE("explain: prints the plan and writes nothing") {
  const auto r = sightglass({"render", "--source", "tangle size=500", "-f", "contour", "--explain", "-o", "never.png"});
  CHECK(r.status == 0);
  CHECK(r.out.find("contour") != std::string::npos);
  CHECK_FALSE(file_exists(test::temp_folder() + "never.png"));
}

TEST_CASE("ops, colormap and help: everything is explained, JSON is JSON") {
  const auto ops = nlohmann::json::parse(sightglass({"ops", "--json"}).out);
  CHECK(ops["operations"].size() >= 20);
  for (const auto& o : ops["operations"]) {
    const auto one = sightglass({"ops", o["name"].get<std::string>()});
    INFO(o["name"].get<std::string>());
    CHECK(one.status == 0);
    CHECK(one.out.find(o["sentence"].get<std::string>()) != std::string::npos);
  }
  CHECK(ops["show"].size() == 7);
  CHECK(sightglass({"colormap", "jet"}).out.find("114 of 255") != std::string::npos);
  CHECK(sightglass({"colormap", "sight"}).out.find("falls in 0 of 255") != std::string::npos);
  CHECK(sightglass({"--version"}).out.starts_with("sightglass "));
  CHECK(sightglass({"render", "--help"}).status == 0);
}

TEST_CASE("samples: points as JSON, numbers as text, a picture of both; unknown kinds are answered with the nearest") {
  const auto sobol = nlohmann::json::parse(sightglass({"samples", "--count", "64", "--json"}).out);
  CHECK(sobol["sampler"] == "sobol");
  CHECK(sobol["points"].size() == 64);
  CHECK(sobol["relative_error"].get<double>() < 0.2);
  CHECK(sobol["discrepancy"] <
        nlohmann::json::parse(sightglass({"samples", "--sampler", "independent", "--count", "64", "--json"}).out)["discrepancy"]);
  must({"samples", "--sampler", "blue_noise", "--count", "4", "--seed", "3", "-o", "samples.png"});
  const Image drawn = read_png(test::temp_folder() + "samples.png");
  CHECK(drawn.width > 3 * drawn.height / 2);
  CHECK(sightglass({"samples", "--sampler", "sobel"}).err.find("did you mean 'sobol'") != std::string::npos);
  CHECK(sightglass({"samples", "--count", "0"}).status == 2);
}

TEST_CASE("pictures: jpg, webp and transparent png; odd and tiny sizes") {
  must({"render", "--source", "sphere size=16", "-f", "contour values=0", "--size", "333x17", "-o", "odd.jpg"});
  must({"render", "--source", "sphere size=16", "-f", "contour values=0", "--size", "64x48", "-o", "s.webp"});
  must({"render", "--source", "sphere size=16", "-f", "contour values=0", "--size", "1x1", "-o", "one.png"});
  must({"render", "--source", "sphere size=16", "-f", "contour values=0", "--size", "100x80", "--background", "transparent", "-o",
        "clear.png"});
  const Image clear = read_png(test::temp_folder() + "clear.png");
  CHECK(clear.channels == 4);
  CHECK(clear.at(99, 40)[3] == 0);
  CHECK(clear.at(50, 40)[3] == 255);
}

TEST_CASE("large coordinates: at an offset of 1e7 the picture of a surface is the same to a few grey levels") {
  const std::vector<std::string> common = {"--show", "surface color=white", "--picture", "axes=false triad=false", "--size", "320x240"};
  auto render = [&](const std::string& name, std::vector<std::string> filters) {
    std::vector<std::string> args = {"render", "--source", "torus size=32", "-f", "contour values=0"};
    args.insert(args.end(), filters.begin(), filters.end());
    args.insert(args.end(), common.begin(), common.end());
    args.insert(args.end(), {"-o", name});
    must(args);
    return read_png(test::temp_folder() + name);
  };
  const Image near = render("near.png", {}), far = render("far.png", {"-f", "transform translate=1e7,-1e7,1e7"});
  const ImageDifference d = compare(near, far);
  CHECK(d.rms < 0.5);
}

TEST_CASE("pictures: without a word about fields, what the last steps made is coloured; else the file's values") {
  must({"convert", "--source", "tangle size=16", "-o", "made.vti"});
  auto told = [](std::vector<std::string> words) {
    words.insert(words.begin(), {"render", "made.vti", "--size", "160x120", "-o", "made.png"});
    const auto r = sightglass(words);
    CHECK(r.status == 0);
    return r.out;
  };
  CHECK(told({"-f", "slice axis=z", "-f", "calc expr=x*y name=xy"}).find("coloured by 'xy'") != std::string::npos);
  CHECK(told({"-f", "slice axis=z", "-f", "bands count=4", "-f", "clip axis=x"}).find("coloured by 'band'") != std::string::npos);
  // It travels with the data: through a surface of another field, too.
  CHECK(told({"-f", "calc expr=x name=p", "-f", "contour field=tangle"}).find("coloured by 'p'") != std::string::npos);
  CHECK(told({"-f", "calc expr=vec(-y,x,0) name=u", "-f", "calc expr=z name=p", "-f", "streamlines field=u"}).find("coloured by 'p'") !=
        std::string::npos);
  CHECK(told({"-f", "otsu", "-f", "morphology operation=open"}).find("'otsu'") != std::string::npos);      // in place
  CHECK(told({"-f", "slice axis=z", "-f", "calc expr=3 name=same"}).find("'same'") == std::string::npos);  // shows nothing
}
